"""Clips: videos of one tree, uploaded whole or in pieces, their frames and traces."""

from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import FileResponse

from treestroke.api.clip_uploads import (
    CLIP_BODY,
    PROGRESS_HEADERS,
    ClipName,
    UploadComplete,
    UploadLength,
    clip_answer,
    receive_clip,
    upload_answer,
)
from treestroke.api.deps import ClipId, Cursor, JsonBody, Limit, ResourcesOf, leads_to
from treestroke.api.errors import BODY, documented
from treestroke.api.sending import file_responses, send_blob
from treestroke.api.views import clip_view
from treestroke.clip_schemas import ClipInfo, ClipPage, ClipTraceAnswer, UploadInfo
from treestroke.codec.video_kinds import MP4, VIDEO_KINDS
from treestroke.limits import MAX_CLIP_SIDE, MAX_FRAME
from treestroke.service import clips
from treestroke.service.makers import find_makers
from treestroke.wire_strokes import STROKES_EXAMPLE

router = APIRouter(prefix="/v1/clips", tags=["clips"])
_TRACE: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": {"$ref": "#/components/schemas/ClipTraceRequest"},
                "example": {"frame": 0, **STROKES_EXAMPLE, "rev": 7, "grow": False},
            }
        },
    }
}
_NEXT = {"next_page": {"operationId": "list_clips", "parameters": {"cursor": "$response.body#/next"}}}
_LOCATION = {
    "schema": {"type": "string", "pattern": "^/v1/(clips/clp|uploads/upl)_[0-9a-f]{24}$"},
    "description": "the clip, or the upload to which further pieces are sent",
}
_JPEG: dict[str, Any] = {"image/jpeg": {"schema": {"type": "string", "format": "binary"}}}
_VIDEO: dict[int | str, dict[str, Any]] = {
    status: {
        **answer,
        "content": {kind.media_type: {"schema": {"type": "string", "format": "binary"}} for kind in VIDEO_KINDS},
    }
    if status in (HTTPStatus.OK, HTTPStatus.PARTIAL_CONTENT)
    else answer
    for status, answer in file_responses(MP4.media_type).items()
}
_FRAME_SECONDS = 86_400
"""How long a browser may keep a frame: a clip's frames never change."""
FrameHeight = Annotated[int | None, Query(ge=16, le=MAX_CLIP_SIDE, description="most pixels high")]
Frame = Annotated[int, Path(ge=0, le=MAX_FRAME)]


@router.post(
    "",
    status_code=HTTPStatus.CREATED,
    response_model=None,
    responses={
        HTTPStatus.CREATED: {
            "content": {
                "application/json": {
                    "schema": {
                        "anyOf": [{"$ref": f"#/components/schemas/{kind.__name__}"} for kind in (ClipInfo, UploadInfo)]
                    }
                }
            },
            "description": "The clip; with Upload-Complete: ?0 the upload",
            "headers": {"Location": _LOCATION, **PROGRESS_HEADERS},
            "links": leads_to("get_clip", "get_clip_video", "trace_clip", "delete_clip"),
        },
        **documented(*BODY, "photos_full", "storage_full"),
    },
    openapi_extra=CLIP_BODY,
)
async def add_clip(
    request: Request,
    resources: ResourcesOf,
    name: ClipName = None,
    upload_complete: UploadComplete = None,
    upload_length: UploadLength = None,
) -> Response:
    """Upload a clip: MP4, MOV, WebM, AVI or GIF; or with Upload-Complete: ?0 its first piece, perhaps empty."""
    upload = await receive_clip(request, resources, name, upload_length)
    if upload_complete == "?0":
        return await run_in_threadpool(upload_answer, resources, upload.id, HTTPStatus.CREATED)
    finish = clips.finish_whole if upload_complete is None else clips.finish_upload
    clip = await run_in_threadpool(finish, resources, upload.id)
    return await run_in_threadpool(clip_answer, resources, clip)


@router.get("", responses={HTTPStatus.OK: {"links": _NEXT}, **documented("invalid")})
def list_clips(resources: ResourcesOf, cursor: Cursor = None, limit: Limit = 20) -> ClipPage:
    """List clips, newest first."""
    page, next_cursor = clips.list_clips(resources, cursor, limit)
    makers = find_makers(resources.database, page)
    return ClipPage(clips=[clip_view(row, makers) for row in page], next=next_cursor)


@router.get("/{id}", responses=documented("not_found"))
def get_clip(resources: ResourcesOf, id: ClipId) -> ClipInfo:
    """Return a clip."""
    row = clips.get_clip(resources, id)
    return clip_view(row, find_makers(resources.database, [row]))


@router.get("/{id}/video", response_class=FileResponse, responses=_VIDEO)
def get_clip_video(request: Request, resources: ResourcesOf, id: ClipId) -> Response:
    """Return the file as it was uploaded."""
    row = clips.get_clip(resources, id)
    return send_blob(request, resources, row.blob, row.media_type)


@router.get(
    "/{id}/frames/{frame}",
    response_class=Response,
    responses={HTTPStatus.OK: {"content": _JPEG, "description": "The frame"}, **documented("not_found", "invalid")},
)
def get_clip_frame(resources: ResourcesOf, id: ClipId, frame: Frame, height: FrameHeight = None) -> Response:
    """Return one frame as a JPEG; those that follow each other are read fastest."""
    headers = {"Cache-Control": f"private, max-age={_FRAME_SECONDS}"}
    return Response(clips.frame_jpeg(resources, id, frame, height), headers=headers, media_type="image/jpeg")


@router.delete(
    "/{id}", status_code=HTTPStatus.NO_CONTENT, responses=documented("not_yours", "not_found", "storage_full")
)
def delete_clip(resources: ResourcesOf, id: ClipId) -> None:
    """Delete a clip; models that were made of it keep their own copy."""
    clips.delete_clip(resources, id)


@router.post(
    "/{id}/trace",
    response_model=ClipTraceAnswer,
    responses=documented(*BODY, "not_found"),
    openapi_extra=_TRACE,
)
def trace_clip(resources: ResourcesOf, id: ClipId, body: JsonBody) -> Response:
    """Find foliage and visible branches in one frame, and follow points of the tree through all frames.

    With ``grow`` the whole tree's skeleton too. Tracks are found once for a frame and its crown.
    """
    return Response(clips.trace_clip(resources, id, body), media_type="application/json")
