"""Questions to the tables that more than one use case asks."""

import secrets
from collections.abc import Collection, Iterable, Sequence
from typing import TypeVar

from sqlalchemy import func, select, union
from sqlalchemy.orm import Session

from treestroke.store.tables import REFERENCES, File, ModelRow, PhotoRow

Listed = TypeVar("Listed", ModelRow, PhotoRow)
_RECENT = 20
"""Finished models whose time tells how long the next will take."""
_FIRST_GUESS_S = 5.0


def new_id(kind: str) -> str:
    """Make an id that nobody can guess."""
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
    """Give the files of models, by model and name."""
    found: dict[str, dict[str, File]] = {model: {} for model in models}
    for file in session.scalars(select(File).where(File.model.in_(found))):
        found[file.model][file.name] = file
    return found


def page(session: Session, table: type[Listed], cursor: str | None, limit: int) -> tuple[Sequence[Listed], str | None]:
    """Give a page of models or photos, newest first, and the cursor of the next page: decimal digits."""
    wanted = select(table).where(table.deleted.is_(None)).order_by(table.number.desc()).limit(limit + 1)
    rows = session.scalars(wanted if cursor is None else wanted.where(table.number < int(cursor))).all()
    return rows[:limit], str(rows[limit - 1].number) if len(rows) > limit else None


def twin(session: Session, fingerprint: str, engine: str) -> ModelRow | None:
    """Find a model that this engine has finished of the same photo, drawings, settings and seed."""
    same = ModelRow.fingerprint == fingerprint, ModelRow.engine == engine, ModelRow.status == "succeeded"
    return session.scalars(select(ModelRow).where(*same).limit(1)).first()


def referenced(session: Session, beginning: str = "") -> set[str]:
    """Give the blobs that a row refers to, of those whose names begin so: two digits for a folder's, 64 for one."""
    end = f"{beginning}g"  # behind all hexadecimal digits
    return set(session.scalars(union(*(select(one).where(one >= beginning, one < end) for one in REFERENCES))))


def queue_positions(session: Session, numbers: Collection[int]) -> dict[int, int]:
    """Count the queued jobs up to each of these that queues, by number: 1 for the next."""
    if not numbers:
        return {}
    places = (
        select(ModelRow.number, func.row_number().over(order_by=ModelRow.number).label("place"))
        .where(ModelRow.status == "queued", ModelRow.number <= max(numbers))
        .subquery()
    )
    wanted = select(places.c.number, places.c.place).where(places.c.number.in_(numbers))
    return dict(session.execute(wanted).all())


def usual_seconds(session: Session) -> float:
    """Say how long a model took of late; one that was answered from a twin was never started."""
    took = session.scalars(
        select(ModelRow.finished - ModelRow.started)
        .where(ModelRow.status == "succeeded", ModelRow.started.is_not(None))
        .order_by(ModelRow.started.desc())
        .limit(_RECENT)
    ).all()
    known = sorted(seconds for seconds in took if seconds is not None)
    return known[len(known) // 2] if known else _FIRST_GUESS_S


def stored_bytes(session: Session) -> int:
    """Add up what photos take, the deleted that are not yet removed among them; the same pixels count once."""
    blobs = select(func.max(PhotoRow.bytes).label("bytes")).group_by(PhotoRow.blob).subquery()
    return session.scalar(select(func.sum(blobs.c.bytes))) or 0
