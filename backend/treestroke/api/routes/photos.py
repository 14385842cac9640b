"""Photos and their traces."""

from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Request, Response
from fastapi.responses import FileResponse
from starlette.datastructures import UploadFile

from treestroke.api.deps import (
    Cursor,
    JsonBody,
    Limit,
    PhotoId,
    ResourcesOf,
    check_length,
    form_of,
    leads_to,
    media_type,
)
from treestroke.api.errors import BODY, Refusal, documented
from treestroke.api.sending import file_responses, send_blob
from treestroke.api.views import photo_view
from treestroke.codec.photo_kinds import MEDIA_TYPES
from treestroke.schemas import PhotoInfo, PhotoPage, TraceAnswer
from treestroke.service import photos
from treestroke.wire_strokes import STROKES_EXAMPLE

router = APIRouter(prefix="/v1/photos", tags=["photos"])
_RAW = (*MEDIA_TYPES, "image/*", "application/octet-stream")
_BINARY = {"type": "string", "format": "binary"}
_UPLOAD: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file"],
                    "properties": {"file": _BINARY},
                    "additionalProperties": False,
                }
            },
            **{kind: {"schema": _BINARY} for kind in _RAW},
        },
    }
}
_TRACE: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": {"$ref": "#/components/schemas/TraceRequest"},
                "example": {**STROKES_EXAMPLE, "rev": 7, "grow": False},
            }
        },
    }
}
_NEXT = {"next_page": {"operationId": "list_photos", "parameters": {"cursor": "$response.body#/next"}}}
_LOCATION = {"schema": {"type": "string", "pattern": "^/v1/photos/pho_[0-9a-f]{24}$"}, "description": "the photo"}


async def _photo_bytes(request: Request) -> bytes:
    """Return an upload: the field ``file`` of a form, or the whole body."""
    kind = media_type(request)
    if kind != "multipart/form-data":
        # A picture is judged by its bytes, not by its media type.
        if not kind.startswith("image/") and kind not in (*_RAW, ""):
            raise Refusal(
                "unsupported_media_type", f"send a form with the field file, or the photo itself as {' or '.join(_RAW)}"
            )
        return await request.body()
    async with form_of(request, max_files=1, max_fields=0) as form:
        file = form.get("file")
        if not isinstance(file, UploadFile):
            raise Refusal("bad_request", "the form has no file in the field file; send the photo there")
        return await file.read()


@router.post(
    "",
    status_code=HTTPStatus.CREATED,
    responses={
        HTTPStatus.CREATED: {
            "model": PhotoInfo,
            "headers": {"Location": _LOCATION},
            "links": leads_to("get_photo", "get_image", "trace_photo", "delete_photo"),
        },
        **documented(*BODY, "storage_full"),
    },
    openapi_extra=_UPLOAD,
)
def add_photo(
    resources: ResourcesOf, content: Annotated[bytes, Depends(_photo_bytes)], response: Response
) -> PhotoInfo:
    """Upload a photo: JPEG, PNG, WebP, HEIC, AVIF or TIFF, one frame."""
    check_length(content)
    row = photos.add_photo(resources, content)
    response.headers["Location"] = f"/v1/photos/{row.id}"
    return photo_view(row)


@router.get("", responses={HTTPStatus.OK: {"links": _NEXT}, **documented("invalid")})
def list_photos(resources: ResourcesOf, cursor: Cursor = None, limit: Limit = 20) -> PhotoPage:
    """List photos, newest first."""
    page, next_cursor = photos.list_photos(resources, cursor, limit)
    return PhotoPage(photos=[photo_view(row) for row in page], next=next_cursor)


@router.get("/{id}", responses=documented("not_found"))
def get_photo(resources: ResourcesOf, id: PhotoId) -> PhotoInfo:
    """Return a photo."""
    return photo_view(photos.get_photo(resources, id))


@router.get("/{id}/image", response_class=FileResponse, responses=file_responses("image/png"))
def get_image(request: Request, resources: ResourcesOf, id: PhotoId) -> Response:
    """Return the stored picture: PNG, upright, sRGB, without metadata."""
    return send_blob(request, resources, photos.get_photo(resources, id).blob, "image/png")


@router.delete("/{id}", status_code=HTTPStatus.NO_CONTENT, responses=documented("not_found", "storage_full"))
def delete_photo(resources: ResourcesOf, id: PhotoId) -> None:
    """Delete a photo; models that were made of it keep their own copy."""
    photos.delete_photo(resources, id)


@router.post(
    "/{id}/trace",
    response_model=TraceAnswer,
    responses=documented(*BODY, "not_found"),
    openapi_extra=_TRACE,
)
def trace_photo(resources: ResourcesOf, id: PhotoId, body: JsonBody) -> Response:
    """Find foliage and visible branches; with ``grow`` the whole tree's skeleton too."""
    return Response(photos.trace_photo(resources, id, body), media_type="application/json")
