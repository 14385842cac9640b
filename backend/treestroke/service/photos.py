"""Stored photos: uploaded, found, traced and deleted."""

import hashlib
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

from sqlalchemy.orm import Session

from treestroke.core.errors import PhotoError
from treestroke.service import tracer
from treestroke.service.quotas import NO_QUOTAS, Quotas, admit_upload, stored_by_team
from treestroke.service.tracing_pool import Crashed, TracingPool
from treestroke.settings import PHOTO_MB, PHOTOS_MB
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.queries import mark_deleted, new_id, page, stored_bytes
from treestroke.store.queries import photo as find_photo
from treestroke.store.scope import Scope
from treestroke.store.tables import PhotoRow
from treestroke.store.upload_pieces import AnyUploads

Read = Callable[[Path, bytes, int, int], dict[str, Any]]
"""Reads a photo: `tracer.read_photo` and its like."""


class NotFound(Exception):
    """There is no such photo, model, capture, clip or upload."""


@dataclass(frozen=True)
class Resources:
    """The service's storage (rows, blobs, uploads) and its processes: for photos, for captures, and for clips."""

    database: Database
    blobs: Blobs
    tracers: TracingPool
    capture_tracers: TracingPool
    clip_tracers: TracingPool
    uploads: AnyUploads
    photo_bytes: int = PHOTO_MB * 10**6
    """Most bytes of one photo as it is stored."""
    photos_bytes: int = PHOTOS_MB * 10**6
    """Most bytes of all photos and clips together; of a team with a quota, the quota counts instead."""
    quotas: Quotas = NO_QUOTAS

    def of(self, scope: Scope) -> Self:
        """Return the same with what belongs to one scope: without it there are no sessions."""
        database, blobs, uploads = self.database.of(scope), self.blobs.of(scope), self.uploads.of(scope)
        return replace(self, database=database, blobs=blobs, uploads=uploads)

    def room(self, session: Session) -> int:
        """Return how many bytes of photos and clips may still be stored."""
        if self.quotas.stored_bytes:
            return self.quotas.stored_bytes - stored_by_team(session)
        return self.photos_bytes - stored_bytes(session)


def add_photo(resources: Resources, content: bytes) -> PhotoRow:
    """Store an uploaded photo.

    Raises
    ------
    PhotoError, NoRoom, QuotaExceeded, OSError
        As `store_pixels` and `quotas.admit_upload`.
    """
    row = store_pixels(resources, content)
    with resources.database.writing() as session:
        admit_upload(session, resources.quotas, row.bytes)
        session.add(row)
    return row


def store_pixels(resources: Resources, content: bytes) -> PhotoRow:
    """Decode a photo and store its upright pixels without metadata; return its row, which is not yet in the table.

    Raises
    ------
    PhotoError, NoRoom, OSError
        As `kept_columns`.
    """
    return PhotoRow(id=new_id("pho"), **kept_columns(resources, content, tracer.read_photo))


def kept_columns(resources: Resources, content: bytes, read: Read) -> dict[str, Any]:
    """Read a photo in a tracing process, and store it; return the columns of its row.

    Raises
    ------
    PhotoError
        It cannot be used.
    NoRoom
        All photos and clips together would take more than they may.
    OSError
        The disk is full, or the place of the blobs is away.
    """
    sha256 = hashlib.sha256(content).hexdigest()
    with resources.database.reading() as session:
        room = resources.room(session)
    with resources.blobs.temporary() as path:
        try:
            columns = resources.tracers(sha256, read, path, content, resources.photo_bytes, room)
        except Crashed as error:
            raise PhotoError("photo: it cannot be decoded; save or copy it again") from error
        resources.blobs.take(path, columns["blob"])
    return {"sha256": sha256, "created": time.time(), **columns}


def get_photo(resources: Resources, id: str) -> PhotoRow:
    """Find a photo.

    Raises
    ------
    NotFound
        There is no such photo.
    """
    with resources.database.reading() as session:
        found = find_photo(session, id)
    if found is None:
        raise NotFound("photo")
    return found


def list_photos(resources: Resources, cursor: str | None, limit: int) -> tuple[Sequence[PhotoRow], str | None]:
    """Return a page of photos, newest first, and the cursor of the next page: decimal digits."""
    with resources.database.reading() as session:
        return page(session, PhotoRow, cursor, limit)


def delete_photo(resources: Resources, id: str) -> None:
    """Delete a photo; models that were made of it keep their own copy.

    Raises
    ------
    NotFound, NotYours
        There is no such photo, or it may not be deleted by whom the session is for.
    """
    with resources.database.writing() as session:
        if not mark_deleted(session, PhotoRow, id):
            raise NotFound("photo")


def trace_photo(resources: Resources, id: str, body: bytes) -> bytes:
    """Trace a photo by the body of a request; return the response's JSON.

    Raises
    ------
    NotFound, StrokesError, SettingsError
        There is no such photo, or the body cannot be used.
    Overloaded, Crashed, Damaged
        The tracing processes are too busy, one died over this request, or the photo's file is damaged.
    """
    row = get_photo(resources, id)
    return resources.tracers(row.blob, tracer.trace_answer, resources.blobs.check(row.blob), body, row.warnings)
