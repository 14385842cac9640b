"""Queries that more than one use case needs."""

import secrets
from collections.abc import Collection, Iterable, Sequence
from typing import TypeVar

from sqlalchemy import func, select, union
from sqlalchemy.orm import Session

from treestroke.store.tables import REFERENCES, File, ModelPart, ModelRow, PhotoRow

FileRow = TypeVar("FileRow", File, ModelPart)
Listed = TypeVar("Listed", ModelRow, PhotoRow)
_RECENT = 20
"""Finished models by whose times the next one's is estimated."""
_FIRST_GUESS_S = 5.0


def new_id(kind: str) -> str:
    """Return a new id that cannot be guessed."""
    return f"{kind}_{secrets.token_hex(12)}"


def photo(session: Session, id: str, deleted: bool = False) -> PhotoRow | None:
    """Find a photo; a deleted one only where ``deleted``."""
    found = session.scalars(select(PhotoRow).where(PhotoRow.id == id)).first()
    return found if found is not None and (deleted or found.deleted is None) else None


def model(session: Session, id: str, deleted: bool = False) -> ModelRow | None:
    """Find a model; a deleted one only where ``deleted``."""
    found = session.scalars(select(ModelRow).where(ModelRow.id == id)).first()
    return found if found is not None and (deleted or found.deleted is None) else None


def files(session: Session, models: Iterable[str]) -> dict[str, dict[str, File]]:
    """Return the files of models, by model and name."""
    return _by_model_and_name(session, File, models)


def parts(session: Session, models: Iterable[str]) -> dict[str, dict[str, ModelPart]]:
    """Return the parts that models are made of, by model and name."""
    return _by_model_and_name(session, ModelPart, models)


def page(session: Session, table: type[Listed], cursor: str | None, limit: int) -> tuple[Sequence[Listed], str | None]:
    """Return a page of models or photos, newest first, and the cursor of the next page: decimal digits."""
    query = select(table).where(table.deleted.is_(None)).order_by(table.number.desc()).limit(limit + 1)
    rows = session.scalars(query if cursor is None else query.where(table.number < int(cursor))).all()
    return rows[:limit], str(rows[limit - 1].number) if len(rows) > limit else None


def finished_model(session: Session, fingerprint: str, engine: str) -> ModelRow | None:
    """Find a model that this engine has finished with the same inputs, settings and seed."""
    same = ModelRow.fingerprint == fingerprint, ModelRow.engine == engine, ModelRow.status == "succeeded"
    return session.scalars(select(ModelRow).where(*same).limit(1)).first()


def referenced(session: Session, beginning: str = "") -> set[str]:
    """Return the names of the blobs that rows refer to, of those whose names begin with some hexadecimal digits.

    Two digits select a folder of blobs, all 64 one blob.
    """
    end = f"{beginning}g"  # sorts after all hexadecimal digits
    columns = (select(column).where(column >= beginning, column < end) for column in REFERENCES)
    return set(session.scalars(union(*columns)))


def queue_positions(session: Session, numbers: Collection[int]) -> dict[int, int]:
    """Return each queued job's place in the queue, by job number: 1 is the next; other jobs are left out."""
    if not numbers:
        return {}
    places = (
        select(ModelRow.number, func.row_number().over(order_by=ModelRow.number).label("place"))
        .where(ModelRow.status == "queued", ModelRow.number <= max(numbers))
        .subquery()
    )
    query = select(places.c.number, places.c.place).where(places.c.number.in_(numbers))
    return dict(session.execute(query).all())


def usual_seconds(session: Session) -> float:
    """Return the median seconds of the models finished last; one copied from an equal model was never started."""
    took = session.scalars(
        select(ModelRow.finished - ModelRow.started)
        .where(ModelRow.status == "succeeded", ModelRow.started.is_not(None))
        .order_by(ModelRow.started.desc())
        .limit(_RECENT)
    ).all()
    known = sorted(seconds for seconds in took if seconds is not None)
    return known[len(known) // 2] if known else _FIRST_GUESS_S


def stored_bytes(session: Session) -> int:
    """Return the bytes that all photos take, deleted but not yet removed ones too; equal pixels count once."""
    blobs = select(func.max(PhotoRow.bytes).label("bytes")).group_by(PhotoRow.blob).subquery()
    return session.scalar(select(func.sum(blobs.c.bytes))) or 0


def _by_model_and_name(session: Session, table: type[FileRow], models: Iterable[str]) -> dict[str, dict[str, FileRow]]:
    found: dict[str, dict[str, FileRow]] = {model: {} for model in models}
    for row in session.scalars(select(table).where(table.model.in_(found))):
        found[row.model][row.name] = row
    return found
