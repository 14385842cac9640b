"""Clips that arrive in pieces: how far they are, further pieces, their end."""

from http import HTTPStatus

from fastapi import APIRouter, Request, Response
from fastapi.concurrency import run_in_threadpool

from treestroke.api.clip_uploads import (
    PIECE_BODY,
    PROGRESS_HEADERS,
    UploadComplete,
    UploadOffset,
    clip_answer,
    receive_piece,
    upload_answer,
)
from treestroke.api.deps import ResourcesOf, UploadId
from treestroke.api.errors import BODY, documented
from treestroke.clip_schemas import ClipInfo, UploadInfo
from treestroke.service import clips

router = APIRouter(prefix="/v1/uploads", tags=["clips"])


@router.get(
    "/{id}",
    response_model=UploadInfo,
    responses={HTTPStatus.OK: {"headers": PROGRESS_HEADERS}, **documented("not_found")},
)
def get_upload(resources: ResourcesOf, id: UploadId) -> Response:
    """Tell how many bytes have arrived, in the headers of a HEAD, too; a piece that is under way is ended."""
    return upload_answer(resources, id, HTTPStatus.OK)


@router.patch(
    "/{id}",
    response_model=UploadInfo,
    responses={
        HTTPStatus.OK: {"headers": PROGRESS_HEADERS},
        HTTPStatus.CREATED: {"model": ClipInfo, "description": "The clip", "headers": PROGRESS_HEADERS},
        **documented(*BODY, "not_found", "upload_offset_wrong", "storage_full"),
    },
    openapi_extra=PIECE_BODY,
)
async def add_piece(
    request: Request,
    resources: ResourcesOf,
    id: UploadId,
    upload_offset: UploadOffset,
    upload_complete: UploadComplete = None,
) -> Response:
    """Add the piece that begins at Upload-Offset; with Upload-Complete: ?1, also empty, the clip is then stored."""
    await receive_piece(request, resources, id, int(upload_offset))
    if upload_complete != "?1":
        return await run_in_threadpool(upload_answer, resources, id, HTTPStatus.OK)
    clip = await run_in_threadpool(clips.finish_upload, resources, id)
    return await run_in_threadpool(clip_answer, resources, clip)


@router.delete(
    "/{id}", status_code=HTTPStatus.NO_CONTENT, responses=documented("not_yours", "not_found", "storage_full")
)
def delete_upload(resources: ResourcesOf, id: UploadId) -> None:
    """Give an upload up; the clip that was made of it stays."""
    clips.remove_upload(resources, id)
