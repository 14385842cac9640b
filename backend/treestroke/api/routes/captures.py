"""Captures: photos of one tree from several places, and their cameras."""

from collections.abc import AsyncIterator
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request, Response
from fastapi.responses import FileResponse
from fastapi.sse import EventSourceResponse, ServerSentEvent

from treestroke.api.deps import (
    RENAME_BODY,
    CaptureId,
    CapturePhotoId,
    Cursor,
    DispatcherOf,
    JsonBody,
    Limit,
    PrincipalOf,
    ResourcesOf,
    WatcherOf,
    leads_to,
)
from treestroke.api.errors import BODY, documented
from treestroke.api.following import Follower
from treestroke.api.sending import file_responses, send_blob
from treestroke.api.uploads import UPLOAD_BODY, UploadOf
from treestroke.api.views import capture_photo_view, capture_state, capture_view
from treestroke.capture_schemas import CaptureInfo, CapturePage, CapturePhotoInfo, CaptureTraceAnswer
from treestroke.limits import MAX_NAME
from treestroke.service import capture_traces, captures
from treestroke.service.captures import SETTLED, StoredCapture
from treestroke.service.model_request import read_name
from treestroke.service.photos import Resources
from treestroke.wire_edits import EDITS_EXAMPLE
from treestroke.wire_requests import VIEWS_EXAMPLE

router = APIRouter(prefix="/v1/captures", tags=["captures"])
_RETRY_MS = 2000
_NEW: dict[str, Any] = {
    "requestBody": {
        "content": {
            "application/json": {
                "schema": {"$ref": "#/components/schemas/CaptureRequest"},
                "example": {"name": "The old oak, all around"},
            }
        },
    }
}
_TRACE: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": {"$ref": "#/components/schemas/CaptureTraceRequest"},
                "example": {**VIEWS_EXAMPLE, "edits": EDITS_EXAMPLE, "rev": 7, "grow": False},
            }
        },
    }
}
_NEXT = {"next_page": {"operationId": "list_captures", "parameters": {"cursor": "$response.body#/next"}}}
_LOCATION = {
    "schema": {"type": "string", "pattern": "^/v1/captures/cap_[0-9a-f]{24}$"},
    "description": "the capture",
}
_PHOTO_LOCATION = {
    "schema": {"type": "string", "pattern": "^/v1/captures/cap_[0-9a-f]{24}/photos/cph_[0-9a-f]{24}$"},
    "description": "the photo",
}
_LINKS = leads_to(
    "get_capture",
    "add_capture_photo",
    "solve_capture",
    "follow_capture",
    "cancel_solve",
    "trace_capture",
    "rename_capture",
    "delete_capture",
    "restore_capture",
)
_OF_PHOTO = {"id": "$request.path.id", "photo": "$response.body#/id"}
_PHOTO_LINKS = {
    name: {"operationId": name, "parameters": _OF_PHOTO}
    for name in ("get_capture_photo", "get_capture_image", "remove_capture_photo")
}
_PHOTO_ANSWER: dict[str, Any] = {
    "model": CapturePhotoInfo,
    "headers": {"Location": _PHOTO_LOCATION},
    "links": _PHOTO_LINKS,
}
FileName = Annotated[
    str | None,
    Query(max_length=MAX_NAME, description="the file's name, where no form gives it", examples=["IMG_03.jpg"]),
]


def _view(resources: Resources, capture: StoredCapture) -> CaptureInfo:
    return capture_view(capture, captures.structure_of(resources.blobs, capture))


@router.post(
    "",
    status_code=HTTPStatus.CREATED,
    responses={
        HTTPStatus.CREATED: {"model": CaptureInfo, "headers": {"Location": _LOCATION}, "links": _LINKS},
        **documented(*BODY, "storage_full"),
    },
    openapi_extra=_NEW,
)
def make_capture(resources: ResourcesOf, body: JsonBody, response: Response) -> CaptureInfo:
    """Make a capture, to which photos are added one by one."""
    capture = captures.make_capture(resources.database, body)
    response.headers["Location"] = f"/v1/captures/{capture.id}"
    return capture_view(capture, None)


@router.get("", responses={HTTPStatus.OK: {"links": _NEXT}, **documented("invalid")})
def list_captures(resources: ResourcesOf, cursor: Cursor = None, limit: Limit = 20) -> CapturePage:
    """List captures, newest first."""
    page, next_cursor = captures.list_captures(resources.database, cursor, limit)
    return CapturePage(captures=[capture_state(capture) for capture in page], next=next_cursor)


@router.get("/{id}", responses=documented("not_found"))
def get_capture(resources: ResourcesOf, id: CaptureId) -> CaptureInfo:
    """Look a capture up: its photos, and once it is solved their cameras and the points that they show."""
    return _view(resources, captures.find_capture(resources.database, id))


@router.patch("/{id}", responses=documented(*BODY, "not_found", "storage_full"), openapi_extra=RENAME_BODY)
def rename_capture(resources: ResourcesOf, id: CaptureId, body: JsonBody) -> CaptureInfo:
    """Name a capture."""
    return _view(resources, captures.rename(resources.database, id, read_name(body)))


@router.post("/{id}/restore", responses=documented("not_yours", "not_found", "storage_full"))
def restore_capture(resources: ResourcesOf, id: CaptureId) -> CaptureInfo:
    """Undo a deletion."""
    return _view(resources, captures.restore(resources.database, id))


@router.delete(
    "/{id}", status_code=HTTPStatus.NO_CONTENT, responses=documented("not_yours", "not_found", "storage_full")
)
def delete_capture(resources: ResourcesOf, id: CaptureId) -> None:
    """Delete a capture with its photos, which go after 24 hours; until then it can be restored."""
    captures.delete(resources.database, id)


@router.post(
    "/{id}/photos",
    status_code=HTTPStatus.CREATED,
    responses={
        HTTPStatus.OK: {**_PHOTO_ANSWER, "description": "the capture has this photo already"},
        HTTPStatus.CREATED: _PHOTO_ANSWER,
        **documented(*BODY, "not_found", "storage_full"),
    },
    openapi_extra=UPLOAD_BODY,
)
def add_capture_photo(
    resources: ResourcesOf, id: CaptureId, upload: UploadOf, response: Response, name: FileName = None
) -> CapturePhotoInfo:
    """Add a photo, in any order; sent again by the same name it is the same photo. The cameras are to be found anew."""
    row, added = captures.add_photo(resources, id, name or upload.name, upload.content)
    if not added:
        response.status_code = HTTPStatus.OK
    response.headers["Location"] = f"/v1/captures/{id}/photos/{row.id}"
    return capture_photo_view(row)


@router.get("/{id}/photos/{photo}", responses=documented("not_found"))
def get_capture_photo(resources: ResourcesOf, id: CaptureId, photo: CapturePhotoId) -> CapturePhotoInfo:
    """Look a photo of a capture up."""
    capture = captures.find_capture(resources.database, id)
    row = captures.find_photo(resources.database, id, photo)
    return capture_photo_view(row, captures.structure_of(resources.blobs, capture))


@router.get("/{id}/photos/{photo}/image", response_class=FileResponse, responses=file_responses("image/png"))
def get_capture_image(request: Request, resources: ResourcesOf, id: CaptureId, photo: CapturePhotoId) -> Response:
    """Return the stored picture: PNG, upright, sRGB, without metadata."""
    return send_blob(request, resources, captures.find_photo(resources.database, id, photo).blob, "image/png")


@router.delete(
    "/{id}/photos/{photo}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=documented("not_yours", "not_found", "storage_full"),
)
def remove_capture_photo(resources: ResourcesOf, id: CaptureId, photo: CapturePhotoId) -> None:
    """Remove a photo from a capture; the cameras of the others are to be found anew."""
    captures.remove_photo(resources.database, id, photo)


@router.post(
    "/{id}/solve",
    status_code=HTTPStatus.ACCEPTED,
    responses={
        HTTPStatus.OK: {"model": CaptureInfo, "description": "solved already", "links": _LINKS},
        HTTPStatus.ACCEPTED: {"model": CaptureInfo, "links": _LINKS},
        **documented("not_found", "invalid", "storage_full"),
    },
)
def solve_capture(resources: ResourcesOf, dispatcher: DispatcherOf, id: CaptureId, response: Response) -> CaptureInfo:
    """Find the cameras of a capture's photos; at once where they were found before."""
    capture = captures.solve(resources, id)
    dispatcher.notify()
    if capture.status in SETTLED:
        response.status_code = HTTPStatus.OK
    return _view(resources, capture)


@router.post("/{id}/cancel", responses=documented("not_found", "storage_full"))
def cancel_solve(resources: ResourcesOf, id: CaptureId) -> CaptureInfo:
    """Stop looking for a capture's cameras; what was found stays as it is."""
    return _view(resources, captures.cancel(resources.database, id))


@router.post(
    "/{id}/trace",
    response_model=CaptureTraceAnswer,
    responses=documented(*BODY, "not_found", "capture_unsolved"),
    openapi_extra=_TRACE,
)
def trace_capture(resources: ResourcesOf, id: CaptureId, body: JsonBody) -> Response:
    """Find the tree in all photos of a solved capture, its crown and its visible branches, to which edits are applied.

    With ``grow`` the whole tree's skeleton too. Strokes are read once: edits and settings are answered soon after.
    """
    return Response(capture_traces.trace_capture(resources, id, body), media_type="application/json")


def _capture(resources: ResourcesOf, id: CaptureId) -> StoredCapture:
    """Return the capture; before the stream begins, while the response can still be a problem."""
    return captures.find_capture(resources.database, id)


async def _follower(
    watcher: WatcherOf, principal: PrincipalOf, capture: Annotated[StoredCapture, Depends(_capture)]
) -> AsyncIterator[Follower[StoredCapture]]:
    """Yield a follower of the capture; before the stream begins, while the response can still be a problem."""
    async with watcher.stream(capture, principal) as follower:
        yield follower


@router.get("/{id}/events", response_class=EventSourceResponse, responses=documented("not_found"))
async def follow_capture(
    capture: Annotated[StoredCapture, Depends(_capture)],
    follower: Annotated[Follower[StoredCapture], Depends(_follower)],
) -> AsyncIterator[ServerSentEvent]:
    """Follow a capture: ``snapshot``, then ``progress``, and at the end ``solved``, ``failed`` or ``unsolved``.

    The last event has an id. It is sent at once where nothing is under way.
    """
    shown = capture_state(capture)
    yield ServerSentEvent(event="snapshot", data=shown, retry=_RETRY_MS)
    while shown.status not in SETTLED:
        if (change := await follower.next_change()) is None:
            return
        if (now := capture_state(change)) != shown and now.status not in SETTLED:
            yield ServerSentEvent(event="progress", data=now)
        shown, capture = now, change
    yield ServerSentEvent(event=shown.status, data=shown, id=str(capture.row.seq))
