"""Clips as they are uploaded, whole or in pieces: streams that go to disk, by the headers of resumable uploads.

The headers are those of the IETF's draft-ietf-httpbis-resumable-upload: ``Upload-Complete`` tells whether a request
brings the rest of the file, ``Upload-Offset`` where it begins, ``Upload-Length`` how long the whole is.
"""

from collections.abc import AsyncIterator
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import Header, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse

from treestroke.api.deps import form_of, media_type
from treestroke.api.errors import Refusal
from treestroke.api.uploads import file_in, upload_body
from treestroke.api.views import clip_view
from treestroke.clip_schemas import UploadInfo
from treestroke.codec.video_kinds import VIDEO_KINDS
from treestroke.limits import MAX_CLIP_BYTES, MAX_NAME
from treestroke.service import clips
from treestroke.service.clip_loading import too_large
from treestroke.service.makers import find_makers
from treestroke.service.photos import Resources
from treestroke.store.tables import ClipRow, UploadRow

_RAW = (*(kind.media_type for kind in VIDEO_KINDS), "video/*", "application/octet-stream")
_PIECES = ("application/partial-upload", "application/octet-stream", "")
"""Media types of the pieces that follow the first one."""
_PIECE = 1_000_000
"""Bytes of a form's file that are written at once."""
CLIP_BODY: dict[str, Any] = upload_body(_RAW)
PIECE_BODY: dict[str, Any] = {
    "requestBody": {"content": {_PIECES[0]: {"schema": {"type": "string", "format": "binary"}}}}
}
PROGRESS_HEADERS: dict[str, Any] = {
    "Upload-Offset": {"schema": {"type": "string", "pattern": "^[0-9]+$"}, "description": "bytes that have arrived"},
    "Upload-Complete": {"schema": {"type": "string", "pattern": r"^\?[01]$"}, "description": "whether that is all"},
}
UploadComplete = Annotated[
    str | None,
    Header(pattern=r"^\?[01]$", description="?0 where further pieces will follow, ?1 with the last one"),
]
UploadOffset = Annotated[str, Header(pattern="^[0-9]{1,12}$", description="how many bytes were sent before this piece")]
UploadLength = Annotated[
    str | None, Header(pattern="^[0-9]{1,12}$", description="how many bytes the whole clip has, where that is known")
]
ClipName = Annotated[
    str | None,
    Query(max_length=MAX_NAME, description="the file's name, where no form gives it", examples=["ash.mp4"]),
]


async def receive_clip(request: Request, resources: Resources, name: str | None, length: str | None) -> UploadRow:
    """Receive the first piece of a clip, or all of it, and return its upload.

    Raises
    ------
    Refusal, ClipError, NoRoom
        The body is of another media type or a form without a file, the clip is too large, or there is no room for it.
    """
    kind = media_type(request)
    if kind == "multipart/form-data":
        async with form_of(request, max_files=1, max_fields=0) as form:
            file = file_in(form, "clip")
            upload = await run_in_threadpool(clips.begin_upload, resources, name or file.filename or "", file.size)
            await _write(resources, upload.id, 0, _pieces_of(file.read))
            return upload
    if not kind.startswith("video/") and kind not in (*_RAW, ""):
        raise Refusal(
            "unsupported_media_type", f"send a form with the field file, or the clip itself as {' or '.join(_RAW)}"
        )
    known = None if length is None else int(length)
    upload = await run_in_threadpool(clips.begin_upload, resources, name or "", known)
    try:
        await _write(resources, upload.id, 0, request.stream())
    except BaseException:
        if "upload-complete" not in request.headers:  # nobody would go on with it
            await run_in_threadpool(clips.remove_upload, resources, upload.id)
        raise
    return upload


async def receive_piece(request: Request, resources: Resources, id: str, offset: int) -> None:
    """Add a piece, which begins at an offset, to an upload; what has arrived stays where the connection breaks.

    Raises
    ------
    NotFound, WrongOffset, Superseded, Refusal, ClipError
        There is no such upload, so many bytes have not arrived or more have, another request goes on with it, the body
        is of another media type, or the clip is too large.
    """
    if media_type(request) not in _PIECES:
        raise Refusal("unsupported_media_type", f"send the piece as {_PIECES[0]}")
    if await run_in_threadpool(clips.goes_on, resources, id, offset):
        await _write(resources, id, offset, request.stream())


def clip_answer(resources: Resources, clip: ClipRow) -> JSONResponse:
    """Return the response that says a clip was stored."""
    makers = find_makers(resources.database, [clip])
    headers = {"Location": f"/v1/clips/{clip.id}", "Upload-Offset": str(clip.bytes), "Upload-Complete": "?1"}
    return JSONResponse(clip_view(clip, makers).model_dump(), HTTPStatus.CREATED, headers)


def upload_answer(resources: Resources, id: str, status: HTTPStatus) -> JSONResponse:
    """Return the response that says how much of an upload has arrived.

    Raises
    ------
    NotFound
        There is no such upload.
    """
    row, offset = clips.get_upload(resources, id)
    complete = "?0" if row.clip is None else "?1"
    limit = f"max-size={MAX_CLIP_BYTES}"
    headers = {"Upload-Offset": str(offset), "Upload-Complete": complete, "Upload-Limit": limit}
    headers |= {"Location": f"/v1/uploads/{id}"} if status == HTTPStatus.CREATED else {}
    return JSONResponse(UploadInfo(id=id, offset=offset, clip=row.clip).model_dump(), status, headers)


async def _write(resources: Resources, id: str, offset: int, pieces: AsyncIterator[bytes]) -> None:
    """Write pieces to the end of an upload as they arrive: what has arrived before an error stays."""
    with resources.uploads.adding(id, offset) as writer:
        async for piece in pieces:
            if await run_in_threadpool(writer.write, piece) > MAX_CLIP_BYTES:
                raise too_large()


async def _pieces_of(read: Any) -> AsyncIterator[bytes]:
    while piece := await read(_PIECE):
        yield piece
