"""Photos and their traces."""

from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse

from treestroke.api.deps import Cursor, JsonBody, Limit, PhotoId, ResourcesOf, leads_to
from treestroke.api.errors import BODY, documented
from treestroke.api.sending import file_responses, send_blob
from treestroke.api.uploads import UPLOAD_BODY, UploadOf
from treestroke.api.views import photo_view
from treestroke.schemas import PhotoInfo, PhotoPage, TraceAnswer
from treestroke.service import photos
from treestroke.wire_strokes import STROKES_EXAMPLE

router = APIRouter(prefix="/v1/photos", tags=["photos"])
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
    openapi_extra=UPLOAD_BODY,
)
def add_photo(resources: ResourcesOf, upload: UploadOf, response: Response) -> PhotoInfo:
    """Upload a photo: JPEG, PNG, WebP, HEIC, AVIF or TIFF, one frame."""
    row = photos.add_photo(resources, upload.content)
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


@router.delete(
    "/{id}", status_code=HTTPStatus.NO_CONTENT, responses=documented("not_yours", "not_found", "storage_full")
)
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
