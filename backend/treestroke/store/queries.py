"""Questions to the tables that more than one use case asks."""

import secrets
from collections.abc import Sequence

from sqlalchemy import func, select, union
from sqlalchemy.orm import Session

from treestroke.store.tables import REFERENCES, File, Model, Photo

_RECENT = 20
"""Finished models whose time tells how long the next will take."""
_FIRST_GUESS_S = 5.0


def new_id(kind: str) -> str:
    """Make an id that nobody can guess."""
    return f"{kind}_{secrets.token_hex(12)}"


def photo(session: Session, id: str, deleted: bool = False) -> Photo | None:
    """Find a photo; a deleted one only where ``deleted``."""
    found = session.scalars(select(Photo).where(Photo.id == id)).first()
    return found if found is not None and (deleted or found.deleted is None) else None


def model(session: Session, id: str, deleted: bool = False) -> Model | None:
    """Find a model; a deleted one only where ``deleted``."""
    found = session.scalars(select(Model).where(Model.id == id)).first()
    return found if found is not None and (deleted or found.deleted is None) else None


def files(session: Session, model: str) -> dict[str, File]:
    """Give a model's files by name."""
    return {file.name: file for file in session.scalars(select(File).where(File.model == model))}


def newest(session: Session, before: int | None, limit: int) -> Sequence[Model]:
    """Give models, newest first, from the one before a number on."""
    wanted = select(Model).where(Model.deleted.is_(None)).order_by(Model.number.desc()).limit(limit)
    return session.scalars(wanted if before is None else wanted.where(Model.number < before)).all()


def twin(session: Session, fingerprint: str, engine: str) -> Model | None:
    """Find a model that this engine has finished of the same photo, drawings, settings and seed."""
    same = Model.fingerprint == fingerprint, Model.engine == engine, Model.status == "succeeded"
    return session.scalars(select(Model).where(*same).limit(1)).first()


def referenced(session: Session, beginning: str = "") -> set[str]:
    """Give the blobs that a row refers to, of those whose names begin so: two digits for a folder's, 64 for one."""
    end = f"{beginning}g"  # behind all hexadecimal digits
    return set(session.scalars(union(*(select(one).where(one >= beginning, one < end) for one in REFERENCES))))


def queue_position(session: Session, job: Model) -> int | None:
    """Count the queued jobs up to this one, 1 for the next; None where it does not queue."""
    if job.status != "queued":
        return None
    return session.scalar(
        select(func.count()).select_from(Model).where(Model.status == "queued", Model.number <= job.number)
    )


def usual_seconds(session: Session) -> float:
    """Say how long a model took of late; one that was answered from a twin was never started."""
    took = session.scalars(
        select(Model.finished - Model.started)
        .where(Model.status == "succeeded", Model.started.is_not(None))
        .order_by(Model.started.desc())
        .limit(_RECENT)
    ).all()
    known = sorted(seconds for seconds in took if seconds is not None)
    return known[len(known) // 2] if known else _FIRST_GUESS_S
