"""Questions to the tables that more than one use case asks."""

import secrets
from collections.abc import Sequence

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from treestroke.store.tables import File, Model, Photo

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


def twin(session: Session, fingerprint: str) -> Model | None:
    """Find a finished model of the same photo, strokes, settings, seed and engine."""
    return session.scalars(
        select(Model).where(Model.fingerprint == fingerprint, Model.status == "succeeded").limit(1)
    ).first()


def queue_position(session: Session, job: Model) -> int | None:
    """Count the queued jobs up to this one, 1 for the next; None where it does not queue."""
    if job.status != "queued":
        return None
    return session.scalar(
        select(func.count()).select_from(Model).where(Model.status == "queued", Model.number <= job.number)
    )


def usual_seconds(session: Session) -> float:
    """Say how long a model took of late."""
    took = session.scalars(
        select(Model.finished - Model.started)
        .where(Model.status == "succeeded", Model.started.is_not(None))
        .order_by(Model.number.desc())
        .limit(_RECENT)
    ).all()
    known = sorted(seconds for seconds in took if seconds is not None)
    return known[len(known) // 2] if known else _FIRST_GUESS_S


def stored_bytes(session: Session) -> int:
    """Add up what photos take, the deleted that are not yet removed among them; the same pixels count once."""
    blobs = select(func.max(Photo.bytes).label("bytes")).group_by(Photo.blob).subquery()
    return session.scalar(select(func.sum(blobs.c.bytes))) or 0
