"""What is deleted goes, a day later, with its files; so does what nothing refers to."""

import time
from dataclasses import dataclass

from sqlalchemy import delete, select, update
from sqlalchemy.orm import Session

from treestroke.service.models import RESTORABLE_SECONDS
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.leases import TERMINAL
from treestroke.store.tables import PARTS, File, Model, Photo, Replay

YOUNG_SECONDS = 3600.0
"""A blob this young may belong to a row that is about to be written."""


@dataclass(frozen=True)
class Swept:
    """How many of each went."""

    models: int
    photos: int
    blobs: int


def sweep(database: Database, blobs: Blobs, keep_days: float, young_s: float = YOUNG_SECONDS) -> Swept:
    """Delete what is older than ``keep_days`` (0: nothing), and remove what was deleted a day ago, for good."""
    now = time.time()
    with database.writing() as session:
        if keep_days:
            oldest = now - keep_days * 86_400
            for table, finished in ((Model, Model.status.in_(TERMINAL)), (Photo, Photo.id.is_not(None))):
                session.execute(
                    update(table).where(table.created < oldest, table.deleted.is_(None), finished).values(deleted=now)
                )
        gone = now - RESTORABLE_SECONDS
        models = session.execute(
            delete(Model).where(Model.deleted < gone, Model.status.in_(TERMINAL)).returning(Model.id)
        ).all()
        photos = session.execute(delete(Photo).where(Photo.deleted < gone).returning(Photo.id)).all()
        session.execute(delete(Replay).where(Replay.created < gone))
        kept = _referenced(session)
    return Swept(len(models), len(photos), blobs.sweep(kept, young_s))


def referenced(database: Database) -> set[str]:
    """Give the blobs that a row refers to."""
    with database.reading() as session:
        return _referenced(session)


def _referenced(session: Session) -> set[str]:
    columns = (Photo.blob, *(getattr(Model, f"{part}_blob") for part in PARTS), File.blob)
    return {blob for column in columns for blob in session.scalars(select(column)) if blob is not None}
