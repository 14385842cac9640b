"""Stored clips: uploaded whole or in pieces, found, shown frame by frame, traced and deleted."""

import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

from sqlalchemy import update

from treestroke.core.errors import ClipError
from treestroke.limits import MAX_CLIP_BYTES
from treestroke.service import clip_tracer
from treestroke.service.clip_loading import too_large
from treestroke.service.file_names import file_name
from treestroke.service.photos import NotFound, Resources
from treestroke.service.quotas import admit_upload
from treestroke.service.tracer import NoRoom
from treestroke.service.tracing_pool import Crashed
from treestroke.store.objects import sha256_of
from treestroke.store.queries import check_removable, mark_deleted, new_id, page
from treestroke.store.queries import clip as find_clip
from treestroke.store.tables import ClipRow, UploadRow
from treestroke.store.uploads import WrongOffset


def begin_upload(resources: Resources, name: str, length: int | None = None) -> UploadRow:
    """Begin an upload of a clip that was sent by a ``name``; ``length`` is its number of bytes, where it is known.

    Raises
    ------
    ClipError
        It is too large.
    NoRoom
        All photos and clips together would take more than they may.
    """
    if length is not None and length > MAX_CLIP_BYTES:
        raise too_large()
    with resources.database.reading() as session:
        room = resources.room(session) - resources.uploads.total_size()
    if room < (length or 1):
        raise NoRoom
    row = UploadRow(id=new_id("upl"), name=file_name(name), created=time.time())
    with resources.database.writing() as session:
        session.add(row)
    return row


def get_upload(resources: Resources, id: str) -> tuple[UploadRow, int]:
    """Find an upload, and how many bytes have arrived; a request that still adds some is ended.

    Raises
    ------
    NotFound
        There is no such upload.
    """
    with resources.database.reading() as session:
        row = session.get(UploadRow, id)
    if row is None:
        raise NotFound("upload")
    size = resources.uploads.size(id)
    if row.clip is not None:
        size = get_clip(resources, row.clip, deleted=True).bytes
    return row, size


def goes_on(resources: Resources, id: str, offset: int) -> bool:
    """Note that an upload goes on at an offset; False where it is whole, and its last answer was lost.

    It is removed a day after it stopped, not after it began.

    Raises
    ------
    NotFound, WrongOffset
        There is no such upload, or so many bytes have not arrived, or more have.
    """
    upload, size = get_upload(resources, id)
    if size != offset:
        raise WrongOffset(size)
    if upload.clip is None:
        with resources.database.writing() as session:
            session.execute(update(UploadRow).where(UploadRow.id == id).values(seen=None))
    return upload.clip is None


def remove_upload(resources: Resources, id: str) -> None:
    """Remove an upload; the clip that was made of it stays.

    Raises
    ------
    NotFound, NotYours
        There is no such upload, or it may not be removed by whom the session is for.
    """
    with resources.database.writing() as session:
        row = session.get(UploadRow, id)
        if row is not None:
            check_removable(session, row)
            session.delete(row)
    resources.uploads.remove(id)
    if row is None:
        raise NotFound("upload")


def finish_upload(resources: Resources, id: str) -> ClipRow:
    """Make a clip of an upload that is whole, once; an upload that cannot be used is removed.

    Raises
    ------
    NotFound
        There is no such upload.
    ClipError
        It is no video that can be read, is too short or too dark, or nothing moves in it.
    QuotaExceeded
        As `quotas.admit_upload`; the upload stays.
    Overloaded
        Too many clips are being read; the upload stays.
    Superseded
        Another request does so at the moment.
    """
    with resources.uploads.finishing(id):
        upload, _ = get_upload(resources, id)
        if upload.clip is not None:
            return get_clip(resources, upload.clip, deleted=True)
        return _kept(resources, upload)


def _kept(resources: Resources, upload: UploadRow) -> ClipRow:
    """Read an upload, store it and note that it is a clip."""
    try:
        columns = _stored(resources, upload.id)
    except Crashed as error:
        remove_upload(resources, upload.id)
        fault = "it cannot be decoded, or takes too long; make it shorter, or convert it to MP4 (H.264)"
        raise ClipError(f"clip: {fault}") from error
    except ClipError:
        remove_upload(resources, upload.id)
        raise
    row = ClipRow(id=new_id("clp"), name=upload.name, created=time.time(), **columns)
    with resources.database.writing() as session:
        now = session.get(UploadRow, upload.id, with_for_update=True)
        made = None if now is None else now.clip  # by another web process, meanwhile
        if made is None:
            admit_upload(session, resources.quotas, row.bytes)
            session.add(row)
        if now is not None and made is None:
            now.clip, now.seen = row.id, None
    resources.uploads.remove(upload.id)
    return row if made is None else get_clip(resources, made, deleted=True)


def _stored(resources: Resources, id: str) -> dict[str, Any]:
    """Read what has arrived of an upload and store it; return the columns of its clip."""
    with resources.uploads.whole(id) as path:
        sha256 = sha256_of(path)
        columns = resources.clip_tracers(sha256, clip_tracer.look, path, sha256)
        size = path.stat().st_size
        resources.blobs.take(path, sha256)
    return {**columns, "sha256": sha256, "blob": sha256, "bytes": size}


def finish_whole(resources: Resources, id: str) -> ClipRow:
    """Make a clip of an upload that came in one request, and forget the upload, whatever happens.

    Raises
    ------
    NotFound, ClipError, Overloaded
        As `finish_upload`.
    """
    try:
        return finish_upload(resources, id)
    finally:
        with suppress(NotFound):
            remove_upload(resources, id)


def get_clip(resources: Resources, id: str, deleted: bool = False) -> ClipRow:
    """Find a clip; a deleted one only where ``deleted``.

    Raises
    ------
    NotFound
        There is no such clip.
    """
    with resources.database.reading() as session:
        found = find_clip(session, id, deleted)
    if found is None:
        raise NotFound("clip")
    return found


def list_clips(resources: Resources, cursor: str | None, limit: int) -> tuple[Sequence[ClipRow], str | None]:
    """Return a page of clips, newest first, and the cursor of the next page: decimal digits."""
    with resources.database.reading() as session:
        return page(session, ClipRow, cursor, limit)


def delete_clip(resources: Resources, id: str) -> None:
    """Delete a clip; models that were made of it keep their own copy.

    Raises
    ------
    NotFound, NotYours
        There is no such clip, or it may not be deleted by whom the session is for.
    """
    with resources.database.writing() as session:
        if not mark_deleted(session, ClipRow, id):
            raise NotFound("clip")


def frame_jpeg(resources: Resources, id: str, frame: int, height: int | None) -> bytes:
    """Return one frame of a clip as a JPEG, at most ``height`` px high.

    Raises
    ------
    NotFound
        There is no such clip or frame.
    Overloaded, Crashed, Damaged
        Too many clips are being read, the process died over this one, or its file is damaged.
    """
    row = get_clip(resources, id)
    if frame >= row.frames:
        raise NotFound("frame")
    path = resources.blobs.check(row.blob)
    return resources.clip_tracers(f"frames of {row.blob}", clip_tracer.frame_jpeg, path, frame, height)


def trace_clip(resources: Resources, id: str, body: bytes) -> bytes:
    """Trace a clip by the body of a request; return the response's JSON.

    Raises
    ------
    NotFound, ClipError, StrokesError, SettingsError
        There is no such clip, or the body cannot be used.
    Overloaded, Crashed, Damaged
        Too many clips are being read, the process died over this one, or its file is damaged.
    """
    path = resources.blobs.check(get_clip(resources, id).blob)
    return resources.clip_tracers(path.name, clip_tracer.trace_answer, path, body)
