"""Queries that more than one use case needs."""

import secrets
import time
from collections.abc import Collection, Iterable, Sequence
from contextlib import suppress
from typing import Any, TypeVar

from sqlalchemy import ColumnElement, Select, exists, func, or_, select, union
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import InstrumentedAttribute, Session

from treestroke.store.account_tables import MemberRow
from treestroke.store.audit import record
from treestroke.store.scope import Authored, scope_of
from treestroke.store.tables import (
    REFERENCES,
    TERMINAL,
    UPLOADED,
    AnyJob,
    BlobRow,
    CapturePhoto,
    CaptureRow,
    ClipRow,
    File,
    JobRow,
    ModelPart,
    ModelRow,
    PhotoRow,
    Replay,
    SolveRow,
    Turn,
)

FileRow = TypeVar("FileRow", File, ModelPart)
Kept = TypeVar("Kept", ModelRow, PhotoRow, CaptureRow, ClipRow)
_RECENT = 20
"""Finished jobs by whose times the next one's is estimated."""
_FIRST_GUESS_S = {ModelRow: 5.0, SolveRow: 120.0}


class NotYours(Exception):
    """What somebody else made was about to be deleted or restored."""


def new_id(kind: str) -> str:
    """Return a new id that cannot be guessed."""
    return f"{kind}_{secrets.token_hex(12)}"


def photo(session: Session, id: str, deleted: bool = False) -> PhotoRow | None:
    """Find a photo; a deleted one only where ``deleted``."""
    return _kept(session, PhotoRow, id, deleted)


def model(session: Session, id: str, deleted: bool = False) -> ModelRow | None:
    """Find a model; a deleted one only where ``deleted``."""
    return _kept(session, ModelRow, id, deleted)


def capture(session: Session, id: str, deleted: bool = False) -> CaptureRow | None:
    """Find a capture; a deleted one only where ``deleted``."""
    return _kept(session, CaptureRow, id, deleted)


def clip(session: Session, id: str, deleted: bool = False) -> ClipRow | None:
    """Find a clip; a deleted one only where ``deleted``."""
    return _kept(session, ClipRow, id, deleted)


def lock(session: Session, table: type[Kept], id: str) -> None:
    """Let no other change a row, or what belongs to it, until this transaction ends; where there is none, do nothing.

    On SQLite nobody else writes anyway.
    """
    session.execute(select(table.number).where(table.id == id).with_for_update())


def check_removable(session: Session, row: Authored) -> None:
    """Check that a row may be deleted or restored by whom the session is for.

    Raises
    ------
    NotYours
        It may not: a member removes what they made, a viewer nothing.
    """
    scope = scope_of(session)
    if scope.removes == "none" or (scope.removes == "own" and row.maker != scope.maker):
        raise NotYours


def mark_deleted(session: Session, table: type[Kept], id: str) -> bool:
    """Delete a row that is there, until it is restored or removed; tell whether there was one.

    Raises
    ------
    NotYours
        It may not be deleted by whom the session is for.
    """
    return _mark(session, table, table.id == id, table.deleted.is_(None), deleted=time.time())


def mark_restored(session: Session, table: type[Kept], id: str) -> bool:
    """Undo the deletion of a row; one that is not deleted stays as it is. Tell whether there was a row.

    Raises
    ------
    NotYours
        It may not be restored by whom the session is for.
    """
    return _mark(session, table, table.id == id, deleted=None)


def maker_names(session: Session, makers: Iterable[str]) -> dict[str, str]:
    """Return the names of people by their ids, of those who were removed too."""
    return dict(session.execute(select(MemberRow.id, MemberRow.name).where(MemberRow.id.in_(makers))).all())


def replay(session: Session, key: str) -> Replay | None:
    """Find what an Idempotency-Key of the person whose session this is was used for."""
    return session.scalars(_replays(session, key)).first()


def locked_replay(session: Session, new: Replay) -> Replay:
    """Return the row of an Idempotency-Key: the new one, unless the person has used the key before.

    Others who come with the same key wait here until this transaction ends, and then get what it has kept.
    """
    while True:
        found = session.scalars(_replays(session, new.key).with_for_update()).first()
        if found is not None:
            return found
        with suppress(IntegrityError), session.begin_nested():
            session.add(new)
            session.flush()
            return new


def files(session: Session, models: Iterable[str]) -> dict[str, dict[str, File]]:
    """Return the files of models, by model and name."""
    return _by_model_and_name(session, File, models)


def parts(session: Session, models: Iterable[str]) -> dict[str, dict[str, ModelPart]]:
    """Return the parts that models are made of, by model and name."""
    return _by_model_and_name(session, ModelPart, models)


def page(session: Session, table: type[Kept], cursor: str | None, limit: int) -> tuple[Sequence[Kept], str | None]:
    """Return a page of rows, newest first, and the cursor of the next page: decimal digits."""
    query = select(table).where(table.deleted.is_(None)).order_by(table.number.desc()).limit(limit + 1)
    rows = session.scalars(query if cursor is None else query.where(table.number < int(cursor))).all()
    return rows[:limit], str(rows[limit - 1].number) if len(rows) > limit else None


def finished(session: Session, table: type[JobRow], fingerprint: str, engine: str) -> JobRow | None:
    """Find a job that this engine has finished with the same fingerprint."""
    same = table.fingerprint == fingerprint, table.engine == engine, table.status == "succeeded"
    return session.scalars(select(table).where(*same).limit(1)).first()


def capture_photos(session: Session, captures: Iterable[str]) -> dict[str, list[CapturePhoto]]:
    """Return the photos of captures by their names, by capture."""
    found: dict[str, list[CapturePhoto]] = {capture: [] for capture in captures}
    photos = select(CapturePhoto).where(CapturePhoto.capture.in_(found)).order_by(CapturePhoto.name)
    for row in session.scalars(photos):
        found[row.capture].append(row)
    return found


def last_solve(session: Session, capture: str, fingerprint: str) -> SolveRow | None:
    """Find the last time that the cameras of a capture's photos were asked for."""
    asked = select(SolveRow).where(SolveRow.capture == capture, SolveRow.fingerprint == fingerprint)
    return session.scalars(asked.order_by(SolveRow.number.desc()).limit(1)).first()


def referenced(session: Session, beginning: str = "") -> set[str]:
    """Return the names of the blobs that rows refer to, of those whose names begin with some hexadecimal digits.

    Two digits select a folder of blobs, all 64 one blob.
    """
    end = f"{beginning}g"  # sorts after all hexadecimal digits
    columns = (select(column).where(column >= beginning, column < end) for column in REFERENCES)
    return set(session.scalars(union(*columns)))


def used(references: Iterable[InstrumentedAttribute[Any]] = REFERENCES) -> ColumnElement[bool]:
    """Return the condition that a row of the same team refers to a blob (`BlobRow`) by one of some columns."""
    return or_(*(exists().where(column == BlobRow.sha256, column.class_.team == BlobRow.team) for column in references))


def queue_positions(session: Session, table: type[AnyJob], numbers: Collection[int]) -> dict[int, int]:
    """Return each queued job's place among its team's of its table, by number: 1 is the next; others are left out.

    The people of a team are served in turn (`store.turns`): the first job of each, then the second of each.
    """
    if not numbers:
        return {}
    round_ = func.row_number().over(partition_by=[table.team, table.maker], order_by=table.number)
    queued = (
        select(table.number, table.team, table.maker, round_.label("round")).where(table.status == "queued").subquery()
    )
    served = select(Turn.team, Turn.maker, func.max(Turn.last).label("last")).group_by(Turn.team, Turn.maker).subquery()
    order = queued.c.round, func.coalesce(served.c.last, 0), queued.c.number
    place = func.row_number().over(partition_by=queued.c.team, order_by=order)
    same = (served.c.team == queued.c.team) & (served.c.maker == queued.c.maker)
    places = select(queued.c.number, place.label("place")).outerjoin(served, same).subquery()
    query = select(places.c.number, places.c.place).where(places.c.number.in_(numbers))
    return dict(session.execute(query).all())


def usual_seconds(session: Session, table: type[AnyJob]) -> float:
    """Return the median seconds of a table's jobs finished last; one answered from an equal one was never started."""
    took = session.scalars(
        select(table.finished - table.started)
        .where(table.status == "succeeded", table.started.is_not(None))
        .order_by(table.started.desc())
        .limit(_RECENT)
    ).all()
    known = sorted(seconds for seconds in took if seconds is not None)
    return known[len(known) // 2] if known else _FIRST_GUESS_S[table]


def waits(session: Session, table: type[AnyJob], rows: Sequence[Any]) -> dict[int, tuple[int | None, float | None]]:
    """Return each job's place in the queue and the seconds until it is finished, by its number.

    A row has at least a job's number, status and progress.
    """
    places = queue_positions(session, table, [row.number for row in rows if row.status == "queued"])
    unfinished = [row for row in rows if row.status not in TERMINAL]
    usual_s = usual_seconds(session, table) if unfinished else 0.0
    found: dict[int, tuple[int | None, float | None]] = {row.number: (None, None) for row in rows}
    for row in unfinished:
        place = places.get(row.number)
        found[row.number] = place, usual_s * (1.0 - row.progress + (place or 1) - 1)
    return found


def stored_bytes(session: Session) -> int:
    """Return the bytes that all photos and clips take, deleted but not yet removed ones too; equal files count once."""
    blobs = (select(table.blob, func.max(table.bytes).label("bytes")).group_by(table.blob) for table in UPLOADED)
    each = union(*blobs).subquery()
    return int(session.scalar(select(func.sum(each.c.bytes))) or 0)  # Postgres sums whole numbers as decimals


def _replays(session: Session, key: str) -> Select[Replay]:
    return select(Replay).where(Replay.key == key, Replay.maker == scope_of(session).maker)


def _mark(session: Session, table: type[Kept], *chosen: ColumnElement[bool], deleted: float | None) -> bool:
    """Set when a row was deleted, or that it is not; nobody else changes it meanwhile."""
    row = session.scalars(select(table).where(*chosen).with_for_update()).first()
    if row is None:
        return False
    check_removable(session, row)
    if row.deleted != deleted:
        row.deleted, row.seen = deleted, None
        kind, done = table.__tablename__.removesuffix("s"), "restored" if deleted is None else "deleted"
        record(session, f"{kind}.{done}", row.id)
        session.flush()
    return True


def _kept(session: Session, table: type[Kept], id: str, deleted: bool) -> Kept | None:
    found = session.scalars(select(table).where(table.id == id)).first()
    return found if found is not None and (deleted or found.deleted is None) else None


def _by_model_and_name(session: Session, table: type[FileRow], models: Iterable[str]) -> dict[str, dict[str, FileRow]]:
    found: dict[str, dict[str, FileRow]] = {model: {} for model in models}
    for row in session.scalars(select(table).where(table.model.in_(found))):
        found[row.model][row.name] = row
    return found
