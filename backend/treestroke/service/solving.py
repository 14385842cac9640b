"""Find the cameras of one queued capture in an attempt, and publish what was found."""

from collections.abc import Mapping, Sequence
from functools import partial

from treestroke.codec.structure import encode_structure
from treestroke.core.capture import Structure
from treestroke.core.progress import Report
from treestroke.engines.solving import SolveEnded, solve_in_process
from treestroke.service.attempts import (
    AttemptLost,
    Canceled,
    Heartbeat,
    TimeLimit,
    carry_out,
    persist,
    publish,
)
from treestroke.service.capture_photos import fingerprint
from treestroke.service.loading import load_stored_capture
from treestroke.service.model import SOLVE_BOUNDS
from treestroke.service.progress_estimate import ProgressEstimate
from treestroke.store import queries
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.leases import complete
from treestroke.store.scope import Scope
from treestroke.store.tables import CapturePhoto, SolveRow

_PHASES = [("decode", 0.1), ("solve", 0.9)]
"""Share of the time of each phase, measured on photos of 12 megapixels."""

_MEANT: Mapping[str, type[Exception]] = {"slow": TimeLimit, "memory": MemoryError, "crash": AttemptLost}
"""What the end of the process that finds the cameras means for the attempt."""


def solve_capture(database: Database, blobs: Blobs, job: SolveRow, seconds: float) -> None:
    """Find a capture's cameras, by a job that was claimed, within some seconds."""

    def solve(job: SolveRow) -> None:
        with database.reading() as session:
            photos = queries.capture_photos(session, [job.capture])[job.capture]
        if fingerprint(photos) != job.fingerprint:
            raise Canceled  # the capture has other photos by now
        own = blobs.of(Scope(job.team, job.maker))
        with Heartbeat(database, job, ProgressEstimate(_PHASES), seconds) as heartbeat:
            structure = _find(own, photos, seconds, heartbeat.report)
            # The lease is held while storage is away.
            blob = persist(partial(own.put, encode_structure(structure)))
        publish(database, job, lambda session: complete(session, job, structure=blob))

    carry_out(database, job, solve)


def _find(blobs: Blobs, photos: Sequence[CapturePhoto], seconds: float, report: Report) -> Structure:
    """Find the cameras of stored photos."""
    captured = []
    for index, photo in enumerate(photos):
        report("decode", index / len(photos))
        captured.append(load_stored_capture(photo.name, blobs.get(photo.blob), photo.focal_length_px))
    try:
        return solve_in_process(captured, SOLVE_BOUNDS._replace(seconds=seconds), report)
    except SolveEnded as ended:
        raise _MEANT[ended.why] from ended
