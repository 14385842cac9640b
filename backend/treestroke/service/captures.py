"""Stored captures: made, filled with photos, found, solved, stopped and deleted."""

import hashlib
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import structlog
from sqlalchemy import delete as delete_from
from sqlalchemy import select, update
from sqlalchemy.orm import Session

from treestroke.codec.refusals import checked
from treestroke.codec.structure import decode_structure
from treestroke.core.capture import Structure
from treestroke.core.errors import CaptureError, TreestrokeError
from treestroke.limits import MAX_PHOTOS, MIN_PHOTOS
from treestroke.service import tracer
from treestroke.service.capture_photos import fingerprint
from treestroke.service.engine_version import engine_version
from treestroke.service.file_names import file_name, free_name
from treestroke.service.makers import Maker, makers_of
from treestroke.service.model_request import read_body
from treestroke.service.photos import NotFound, Resources, kept_columns
from treestroke.service.quotas import admit_job, admit_upload
from treestroke.store import leases, queries
from treestroke.store.audit import record
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.objects import Damaged
from treestroke.store.tables import TERMINAL, UNFINISHED, CapturePhoto, CaptureRow, SolveRow
from treestroke.wire_requests import CaptureRequest

_STATUS = {"succeeded": "solved", "canceled": "unsolved"}
"""Statuses of captures by those of their solves, where they are called otherwise."""
SETTLED = ("unsolved", "solved", "failed")
"""Statuses in which nothing is under way."""
log = structlog.get_logger()


class CaptureVersion(NamedTuple):
    """The values that change whenever a capture's viewers are to be shown something new."""

    seq: int
    solve: str | None
    solve_seq: int
    queue_position: int | None
    eta_s: float | None


@dataclass(frozen=True)
class StoredCapture:
    """A capture as it is stored and shown.

    Attributes
    ----------
    row, photos
        Its row, and its photos by name.
    solve
        The last time that the cameras of just these photos were asked for; None where they never were.
    queue_position, eta_s
        The solve's place in the queue and its remaining seconds; None where it is over.
    maker
        Who made it; None where nobody signs in.
    """

    row: CaptureRow
    photos: list[CapturePhoto]
    solve: SolveRow | None
    queue_position: int | None = None
    eta_s: float | None = None
    maker: Maker | None = None

    @property
    def id(self) -> str:
        """The capture's id."""
        return self.row.id

    @property
    def status(self) -> str:
        """What is known of the cameras: unsolved, queued, running, solved or failed."""
        return "unsolved" if self.solve is None else _STATUS.get(self.solve.status, self.solve.status)

    @property
    def version(self) -> CaptureVersion:
        """The version of what viewers are shown."""
        id, seq = (None, 0) if self.solve is None else (self.solve.id, self.solve.seq)
        return CaptureVersion(self.row.seq, id, seq, self.queue_position, self.eta_s)


def make_capture(database: Database, body: bytes) -> StoredCapture:
    """Make a capture without photos by the body of a request, which may be empty.

    Raises
    ------
    TreestrokeError
        It is not such a request, or the name cannot be used.
    """
    name = checked(CaptureRequest, read_body(body or b"{}"), TreestrokeError).name
    row = CaptureRow(id=queries.new_id("cap"), name=name, seq=1, created=time.time())
    with database.writing() as session:
        session.add(row)
    return find_capture(database, row.id)


def find_capture(database: Database, id: str, deleted: bool = False) -> StoredCapture:
    """Find a capture; a deleted one only where ``deleted``.

    Raises
    ------
    NotFound
        There is no such capture.
    """
    with database.reading() as session:
        (found,) = _stored(session, [_row(session, id, deleted)])
        return found


def list_captures(database: Database, cursor: str | None, limit: int) -> tuple[Sequence[StoredCapture], str | None]:
    """Return a page of captures, newest first, and the cursor of the next page: decimal digits."""
    with database.reading() as session:
        rows, next_cursor = queries.page(session, CaptureRow, cursor, limit)
        return _stored(session, rows), next_cursor


def find_changed(database: Database, versions: Mapping[str, object]) -> dict[str, StoredCapture | None]:
    """Return the captures whose version has changed; None for one that was removed for good."""
    with database.reading() as session:
        rows = session.scalars(select(CaptureRow).where(CaptureRow.id.in_(versions))).all() if versions else ()
        found = {capture.id: capture for capture in _stored(session, rows)}
    removed = dict.fromkeys(versions.keys() - found.keys())
    return {**removed, **{id: capture for id, capture in found.items() if capture.version != versions[id]}}


def delete(database: Database, id: str) -> None:
    """Delete a capture, and stop looking for its cameras; models that were made of it keep their own copy.

    Raises
    ------
    NotFound, NotYours
        There is no such capture, or it may not be deleted by whom the session is for.
    """
    with database.writing() as session:
        if not queries.mark_deleted(session, CaptureRow, id):
            raise NotFound("capture")
        leases.cancel(session, SolveRow, SolveRow.capture == id)


def rename(database: Database, id: str, name: str) -> StoredCapture:
    """Name a capture.

    Raises
    ------
    NotFound
        There is no such capture.
    """
    with database.writing() as session:
        _row(session, id)
        session.execute(update(CaptureRow).where(CaptureRow.id == id).values(name=name, seq=CaptureRow.seq + 1))
    return find_capture(database, id)


def restore(database: Database, id: str) -> StoredCapture:
    """Undo a capture's deletion.

    Raises
    ------
    NotFound, NotYours
        There is no such capture, or it was removed for good; or it may not be restored by whom the session is for.
    """
    with database.writing() as session:
        if not queries.mark_restored(session, CaptureRow, id):
            raise NotFound("capture")
    return find_capture(database, id)


def add_photo(resources: Resources, id: str, name: str, content: bytes) -> tuple[CapturePhoto, bool]:
    """Add a photo that was sent by a ``name`` to a capture; return it, and whether it is new there.

    The same bytes by the same name are one photo, however often they are sent. Another photo of the same name gets a
    number.

    Raises
    ------
    NotFound
        There is no such capture.
    CaptureError
        The capture has as many photos as it may have.
    PhotoError, NoRoom, QuotaExceeded, OSError
        As `photos.kept_columns` and `quotas.admit_upload`.
    """
    sha256 = hashlib.sha256(content).hexdigest()
    sent_name = file_name(name) or sha256[:12]
    with resources.database.reading() as session:
        present = _present(session, id, sent_name, sha256)
    if present is not None:
        return present, False
    columns = kept_columns(resources, content, tracer.read_capture_photo)
    with resources.database.writing() as session:
        queries.lock(session, CaptureRow, id)
        present = _present(session, id, sent_name, sha256)
        if present is not None:
            return present, False
        taken = session.scalars(select(CapturePhoto.name).where(CapturePhoto.capture == id)).all()
        free = free_name(sent_name, taken)
        admit_upload(session, resources.quotas, columns["bytes"])
        added = CapturePhoto(id=queries.new_id("cph"), capture=id, name=free, sent_name=sent_name, **columns)
        session.add(added)
        _note_change(session, id)
    return added, True


def find_photo(database: Database, id: str, photo: str) -> CapturePhoto:
    """Find a photo of a capture.

    Raises
    ------
    NotFound
        There is no such capture, or it has no such photo.
    """
    with database.reading() as session:
        _row(session, id)
        return _photo(session, id, photo)


def remove_photo(database: Database, id: str, photo: str) -> None:
    """Remove a photo from a capture.

    Raises
    ------
    NotFound, NotYours
        There is no such capture, or it has no such photo; or that may not be deleted by whom the session is for.
    """
    with database.writing() as session:
        queries.lock(session, CaptureRow, id)
        _row(session, id)
        queries.check_removable(session, _photo(session, id, photo))
        session.execute(delete_from(CapturePhoto).where(CapturePhoto.id == photo))
        record(session, "capture_photo.removed", photo, capture=id)
        _note_change(session, id)


def solve(resources: Resources, id: str) -> StoredCapture:
    """Queue the search for a capture's cameras, unless it is under way or was done before for the same photos.

    Raises
    ------
    NotFound
        There is no such capture.
    CaptureError, QuotaExceeded
        It has too few photos; or as `quotas.admit_job`.
    """
    asked = find_capture(resources.database, id)
    ready = _ready(resources, fingerprint(asked.photos))
    with resources.database.writing() as session:
        queries.lock(session, CaptureRow, id)
        (now,) = _stored(session, [_row(session, id)])
        if len(now.photos) < MIN_PHOTOS:
            need = f"there are {len(now.photos)}, at least {MIN_PHOTOS} are needed; take more around the tree"
            raise CaptureError(f"photos: {need}", code="too_few_photos")
        made = _new_solve(now, ready)
        if made is not None:
            if made.status not in TERMINAL:
                admit_job(session, resources.quotas)
            leases.cancel(session, SolveRow, SolveRow.capture == id)
            session.add(made)
    return find_capture(resources.database, id, deleted=True)


def cancel(database: Database, id: str) -> StoredCapture:
    """Stop looking for a capture's cameras; what was found stays as it is.

    Raises
    ------
    NotFound
        There is no such capture.
    """
    with database.writing() as session:
        _row(session, id)
        leases.cancel(session, SolveRow, SolveRow.capture == id)
    return find_capture(database, id, deleted=True)


def structure_of(blobs: Blobs, capture: StoredCapture) -> Structure | None:
    """Return what was found of a capture's photos; None where nothing was, or where other photos were asked about.

    Raises
    ------
    Damaged
        Its file is damaged.
    """
    if capture.solve is None or capture.solve.structure is None:
        return None
    return decode_structure(blobs.get(capture.solve.structure))


def solved_structure(capture: StoredCapture) -> str:
    """Return the blob of what was found of a capture's photos.

    Raises
    ------
    CaptureError
        The capture is not solved.
    """
    structure = None if capture.solve is None else capture.solve.structure
    if structure is None:
        fault = f"its cameras are not known, it is {capture.status}; solve it first"
        raise CaptureError.at(("capture",), fault, "capture_unsolved")
    return structure


def _row(session: Session, id: str, deleted: bool = False) -> CaptureRow:
    row = queries.capture(session, id, deleted)
    if row is None:
        raise NotFound("capture")
    return row


def _photo(session: Session, id: str, photo: str) -> CapturePhoto:
    row = session.scalars(select(CapturePhoto).where(CapturePhoto.id == photo, CapturePhoto.capture == id)).first()
    if row is None:
        raise NotFound("photo")
    return row


def _stored(session: Session, rows: Sequence[CaptureRow]) -> list[StoredCapture]:
    """Read what belongs to rows."""
    photos = queries.capture_photos(session, [row.id for row in rows])
    solves = {row.id: queries.last_solve(session, row.id, fingerprint(photos[row.id])) for row in rows}
    waits = queries.waits(session, SolveRow, [solve for solve in solves.values() if solve is not None])
    makers, stored = makers_of(session, rows), []
    for row in rows:
        solve = solves[row.id]
        place, eta_s = (None, None) if solve is None else waits[solve.number]
        stored.append(StoredCapture(row, photos[row.id], solve, place, eta_s, makers.get(row.maker)))
    return stored


def _present(session: Session, id: str, sent_name: str, sha256: str) -> CapturePhoto | None:
    """Find the photo of a capture that these bytes already are; None where they may be added."""
    _row(session, id)
    photos = session.scalars(select(CapturePhoto).where(CapturePhoto.capture == id)).all()
    same = next((one for one in photos if (one.sent_name, one.sha256) == (sent_name, sha256)), None)
    if same is None and len(photos) >= MAX_PHOTOS:
        fault = f"there are {len(photos)}, at most {MAX_PHOTOS} are allowed; remove some"
        raise CaptureError(f"photos: {fault}", code="capture_full")
    return same


def _note_change(session: Session, id: str) -> None:
    """Note that a capture has other photos now: what is under way is about the ones that it had."""
    session.execute(update(CaptureRow).where(CaptureRow.id == id).values(seq=CaptureRow.seq + 1))
    leases.cancel(session, SolveRow, SolveRow.capture == id)


def _ready(resources: Resources, fingerprint: str) -> SolveRow | None:
    """Find an equal solve that this engine has finished; None also where its file is damaged."""
    with resources.database.reading() as session:
        equal = queries.finished(session, SolveRow, fingerprint, engine_version())
    try:
        if equal is not None:
            resources.blobs.check(equal.structure or "")
    except Damaged as error:
        log.error("file_damaged", file=str(error))
        return None
    return equal


def _new_solve(capture: StoredCapture, ready: SolveRow | None) -> SolveRow | None:
    """Return the row of a new solve, finished where an equal one is ready; None where the last one will do."""
    wanted, last = fingerprint(capture.photos), capture.solve
    if ready is not None and ready.fingerprint != wanted:
        ready = None  # the photos have changed since
    if last is not None:
        waits = last.status in UNFINISHED and not last.cancel
        if waits or (ready is not None and last.structure == ready.structure):
            return None
    over = ready is not None
    return SolveRow(
        id=queries.new_id("slv"),
        capture=capture.id,
        engine=engine_version(),
        fingerprint=wanted,
        structure=ready.structure if ready is not None else None,
        status="succeeded" if over else "queued",
        phase_fraction=0.0,
        progress=1.0 if over else 0.0,
        seq=1,
        attempt=0,
        beat=0,
        cancel=False,
        created=time.time(),
        finished=time.time() if over else None,
    )
