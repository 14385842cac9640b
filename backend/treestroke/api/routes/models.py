"""Models: asked for, followed, named, stopped, deleted, restored."""

import asyncio
import json
import re
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, HTTPException, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse
from starlette.datastructures import UploadFile

from treestroke.api.deps import (
    Cursor,
    DispatcherOf,
    JsonBody,
    Limit,
    ModelId,
    ShelfOf,
    WatcherOf,
    check_length,
    form_of,
    leads_to,
    media_type,
)
from treestroke.api.errors import documented
from treestroke.api.following import Crowded, Watcher
from treestroke.api.views import model_view
from treestroke.codec.photo_kinds import TAKEN
from treestroke.codec.project import MAX_TEXT_BYTES
from treestroke.schemas import ModelInfo, ModelPage
from treestroke.service import models, photos
from treestroke.service.model_request import ModelOrder, read_name
from treestroke.service.models import Seen
from treestroke.service.photos import Shelf
from treestroke.store.leases import TERMINAL
from treestroke.store.tables import PhotoRow
from treestroke.wire_requests import MODEL_EXAMPLE, FormRequest
from treestroke.wire_strokes import STROKES_EXAMPLE

router = APIRouter(prefix="/v1/models", tags=["models"])
MAX_WAIT_SECONDS = 60.0
_WAIT = re.compile(r"(?:^|[,;\s])wait=(\d{1,4})(?:$|[,;\s])")
_LOCATION = {
    "Location": {"schema": {"type": "string", "pattern": "^/v1/models/mdl_[0-9a-f]{24}$"}, "description": "the model"},
    "Preference-Applied": {"schema": {"type": "string"}, "description": "the wait that Prefer asked for"},
}
_FILES = ("get_tree", "get_preview", "get_strokes", "get_sketch", "get_project", "get_tree_file")
_CHANGES = ("rename_model", "cancel_model", "delete_model", "restore_model")
_LINKS = leads_to("get_model", "follow_model", *_FILES, *_CHANGES)
_NEXT = {"next_page": {"operationId": "list_models", "parameters": {"cursor": "$response.body#/next"}}}
_PHOTO_FIELD = {"photo": {"type": "string", "format": "binary", "description": TAKEN}}
_FORM = FormRequest.model_json_schema()
_FIELDS = (*_PHOTO_FIELD, *FormRequest.model_fields)
_ASK: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": {"$ref": "#/components/schemas/ModelRequest"},
                "example": MODEL_EXAMPLE,
            },
            "multipart/form-data": {
                "schema": {**_FORM, "properties": {**_PHOTO_FIELD, **_FORM["properties"]}},
                "example": {
                    "photo": "(the file's bytes)",
                    "strokes": json.dumps(STROKES_EXAMPLE),
                    "settings": '{"height": 14}',
                    "seed": "1",
                    "name": "The old oak",
                },
            },
        },
    }
}
_RENAME: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": {"$ref": "#/components/schemas/Rename"},
                "example": {"name": "The old oak"},
            }
        },
    }
}


@dataclass(frozen=True)
class _Request:
    """The model that is asked for, and the photo that came along."""

    order: ModelOrder
    photo: PhotoRow | None = None


async def _request(request: Request, shelf: ShelfOf) -> _Request:
    """Read a request for a model: JSON that may name a photo, or a form that may bring one."""
    kind = media_type(request)
    if kind in ("application/json", ""):
        return _Request(await run_in_threadpool(models.read_order, shelf, await request.body()))
    if kind != "multipart/form-data":
        raise HTTPException(415, "send application/json, or a form with photo and strokes, or front and side")
    most = len(_FIELDS)
    async with form_of(request, max_files=most, max_fields=most, max_part_size=MAX_TEXT_BYTES) as form:
        if len(form) < len(form.multi_items()):
            raise HTTPException(400, "the form has a field twice; send each once")
        photo = form.get("photo")
        if photo is not None and not isinstance(photo, UploadFile):
            raise HTTPException(400, "the form has no file in the field photo; send the photo there")
        texts = {name: await _text(field) for name, field in form.items() if field is not photo}
        content = None if photo is None else await photo.read()
    return await run_in_threadpool(_take_in, shelf, content, texts)


def _take_in(shelf: Shelf, photo: bytes | None, texts: dict[str, bytes]) -> _Request:
    if photo is None:
        return _Request(models.read_form(shelf, texts, brings_photo=False))
    check_length(photo)
    return _Request(models.read_form(shelf, texts), photos.take_in(shelf, photo))


async def _text(field: UploadFile | str) -> bytes:
    return await field.read() if isinstance(field, UploadFile) else field.encode("utf-8", "surrogatepass")


@router.post(
    "",
    status_code=202,
    response_model=ModelInfo,
    responses={
        200: {"model": ModelInfo, "description": "finished already", "headers": _LOCATION, "links": _LINKS},
        202: {"model": ModelInfo, "headers": _LOCATION, "links": _LINKS},
        **documented(400, 403, 404, 408, 413, 415, 422, 500, 503, 507),
    },
    openapi_extra=_ASK,
)
async def ask_for_model(
    shelf: ShelfOf,
    dispatcher: DispatcherOf,
    watcher: WatcherOf,
    request: Annotated[_Request, Depends(_request)],
    idempotency_key: Annotated[str | None, Header(min_length=1, max_length=255, pattern=r"^[\x21-\x7e]+$")] = None,
    prefer: Annotated[str | None, Header(description="wait=SECONDS answers when the model is finished")] = None,
) -> Response:
    """Ask for a tree: always a new model, finished at once where the same was made before."""
    seen = await run_in_threadpool(models.ask_for_model, shelf, request.order, idempotency_key, request.photo)
    dispatcher.wake()
    wanted = _WAIT.search(prefer or "")
    if wanted:
        seen = await _finished(watcher, seen, min(float(wanted[1]), MAX_WAIT_SECONDS))
    headers = {"Location": f"/v1/models/{seen.row.id}"}
    if wanted:
        headers["Preference-Applied"] = f"wait={wanted[1]}"
    status = 200 if seen.row.status in TERMINAL else 202
    return JSONResponse(model_view(seen).model_dump(), status, headers)


async def _finished(watcher: Watcher, seen: Seen, seconds: float) -> Seen:
    """Wait for a model as long as may be; not at all where too many wait."""
    with suppress(Crowded, TimeoutError), watcher.follow(seen) as follower:
        async with asyncio.timeout(seconds):
            while seen.row.status not in TERMINAL and (news := await follower.news()) is not None:
                seen = news
    return seen


@router.get("", responses={200: {"links": _NEXT}, **documented(403, 422)})
def list_models(shelf: ShelfOf, cursor: Cursor = None, limit: Limit = 20) -> ModelPage:
    """List models, newest first."""
    page, following = models.list_models(shelf.database, cursor, limit)
    return ModelPage(models=[model_view(seen) for seen in page], next=following)


@router.get("/{id}", responses=documented(403, 404))
def get_model(shelf: ShelfOf, id: ModelId) -> ModelInfo:
    """Look a model up."""
    return model_view(models.see(shelf.database, id))


@router.patch("/{id}", responses=documented(400, 403, 404, 408, 413, 415, 422, 507), openapi_extra=_RENAME)
def rename_model(shelf: ShelfOf, id: ModelId, body: JsonBody) -> ModelInfo:
    """Name a model."""
    return model_view(models.rename(shelf.database, id, read_name(body)))


@router.delete("/{id}", status_code=204, responses=documented(403, 404, 507))
def delete_model(shelf: ShelfOf, id: ModelId) -> None:
    """Delete a model; its files go after 24 hours, until then it can be restored."""
    models.delete(shelf.database, id)


@router.post("/{id}/restore", responses=documented(403, 404, 507))
def restore_model(shelf: ShelfOf, id: ModelId) -> ModelInfo:
    """Take a deletion back."""
    return model_view(models.restore(shelf.database, id))


@router.post("/{id}/cancel", responses=documented(403, 404, 507))
def cancel_model(shelf: ShelfOf, id: ModelId) -> ModelInfo:
    """Stop a model that is not finished; a finished one stays as it is."""
    return model_view(models.cancel(shelf.database, id))
