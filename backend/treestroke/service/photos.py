"""Photos: taken in, found, traced and deleted."""

import hashlib
import time
from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import update

from treestroke.core.errors import PhotoError
from treestroke.service import tracer
from treestroke.service.tracing_pool import Crashed, TracingPool
from treestroke.settings import PHOTO_MB, PHOTOS_MB
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.queries import new_id, page, stored_bytes
from treestroke.store.queries import photo as find_photo
from treestroke.store.tables import PhotoRow


class NotFound(Exception):
    """There is no such photo or model."""


@dataclass(frozen=True)
class Shelf:
    """Where everything is kept, and who looks into photos."""

    database: Database
    blobs: Blobs
    tracers: TracingPool
    photo_bytes: int = PHOTO_MB * 10**6
    """What one photo may take as it is kept."""
    photos_bytes: int = PHOTOS_MB * 10**6
    """What all of them may take."""


def add_photo(shelf: Shelf, content: bytes) -> PhotoRow:
    """Take a photo in and keep it.

    Raises
    ------
    PhotoError, OSError
        As `take_in`.
    """
    row = take_in(shelf, content)
    with shelf.database.writing() as session:
        session.add(row)
    return row


def take_in(shelf: Shelf, content: bytes) -> PhotoRow:
    """Decode a photo and store its upright pixels, without its metadata; the row that is given is not yet kept.

    Raises
    ------
    PhotoError
        It cannot be used.
    NoRoom
        All photos together would take more than they may.
    OSError
        The disk is full.
    """
    sha256 = hashlib.sha256(content).hexdigest()
    with shelf.database.reading() as session:
        room = shelf.photos_bytes - stored_bytes(session)
    folder, most = shelf.blobs.folder.parent, shelf.photo_bytes
    try:
        kept = shelf.tracers(sha256, tracer.keep_photo, folder, content, most, room)
    except Crashed as error:
        raise PhotoError("photo: it cannot be decoded; save or copy it anew") from error
    return PhotoRow(id=new_id("pho"), sha256=sha256, created=time.time(), **kept)


def get_photo(shelf: Shelf, id: str) -> PhotoRow:
    """Find a photo.

    Raises
    ------
    NotFound
        There is none.
    """
    with shelf.database.reading() as session:
        found = find_photo(session, id)
    if found is None:
        raise NotFound("photo")
    return found


def list_photos(shelf: Shelf, cursor: str | None, limit: int) -> tuple[Sequence[PhotoRow], str | None]:
    """Give a page of photos, newest first, and the cursor of the next page: decimal digits."""
    with shelf.database.reading() as session:
        return page(session, PhotoRow, cursor, limit)


def delete_photo(shelf: Shelf, id: str) -> None:
    """Delete a photo; models that were made of it keep their own copy.

    Raises
    ------
    NotFound
        There is none.
    """
    with shelf.database.writing() as session:
        gone = (
            update(PhotoRow).where(PhotoRow.id == id, PhotoRow.deleted.is_(None)).values(deleted=time.time(), seen=None)
        )
        if session.scalars(gone.returning(PhotoRow.id)).first() is None:
            raise NotFound("photo")


def trace_photo(shelf: Shelf, id: str, body: bytes) -> bytes:
    """Trace a photo by a request's body; give the answer's JSON.

    Raises
    ------
    NotFound, StrokesError
        There is no such photo, or the body cannot be used.
    Overloaded, Crashed
        The tracing processes have too much to do, or one died over this.
    """
    row = get_photo(shelf, id)
    return shelf.tracers(row.blob, tracer.trace_answer, shelf.blobs.path(row.blob), body, row.warnings)
