"""Find the cameras of one queued capture in an attempt, and publish what was found."""

from collections.abc import Sequence

from treestroke.codec.image import decode_stored
from treestroke.codec.structure import encode_structure
from treestroke.core.capture import Structure
from treestroke.core.imaging.opacity import over_white
from treestroke.core.pipeline.captured_photos import captured_photo
from treestroke.core.progress import Report
from treestroke.service.attempts import Assignment, Canceled, Heartbeat, carry_out, publish
from treestroke.service.captures import fingerprint
from treestroke.service.execution import one_thread
from treestroke.service.progress_estimate import ProgressEstimate
from treestroke.store import queries
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.leases import complete
from treestroke.store.tables import CapturePhoto, SolveRow

_PHASES = [("decode", 0.1), ("solve", 0.9)]
"""Share of the time of each phase, measured on photos of 12 megapixels."""


def solve_capture(database: Database, blobs: Blobs, assignment: Assignment) -> None:
    """Find a capture's cameras, unless another worker does or did."""

    def solve(job: SolveRow) -> None:
        with database.reading() as session:
            photos = queries.capture_photos(session, [job.capture])[job.capture]
        if fingerprint(photos) != job.fingerprint:
            raise Canceled  # the capture has other photos by now
        with Heartbeat(database, job, ProgressEstimate(_PHASES), assignment.seconds) as heartbeat:
            structure = _find(blobs, photos, heartbeat.report)
        blob = blobs.put(encode_structure(structure))
        publish(database, job, lambda session: complete(session, job, structure=blob))

    carry_out(database, SolveRow, assignment, solve)


def _find(blobs: Blobs, photos: Sequence[CapturePhoto], report: Report) -> Structure:
    """Find the cameras of stored photos."""
    from treestroke.engines.structure import solve  # slow to import, and only a worker's child needs it

    captured = []
    for index, photo in enumerate(photos):
        report("decode", index / len(photos))
        picture = over_white(decode_stored(blobs.get(photo.blob)))
        captured.append(captured_photo(photo.name, picture, photo.focal_length_px))
    with one_thread():
        return solve(captured, report)
