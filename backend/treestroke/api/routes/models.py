"""Models: asked for, followed, named, stopped, deleted, restored."""

import asyncio
import json
import re
from contextlib import suppress
from dataclasses import dataclass
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Query, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse
from starlette.datastructures import UploadFile

from treestroke.api.deps import (
    SIBLINGS_BODY,
    Cursor,
    DispatcherOf,
    JsonBody,
    Limit,
    ModelId,
    ResourcesOf,
    WatcherOf,
    body_of,
    check_length,
    form_of,
    leads_to,
    media_type,
)
from treestroke.api.errors import BODY, Refusal, documented
from treestroke.api.following import TooManyFollowers, Watcher
from treestroke.api.views import model_view
from treestroke.codec.photo_kinds import ACCEPTED_FORMATS
from treestroke.limits import MAX_ID, MAX_NAME, MAX_TAG, MAX_TEXT_BYTES
from treestroke.schemas import ModelInfo, ModelPage
from treestroke.service import photos, stored_models, stored_siblings
from treestroke.service.model_request import ModelOrder, read_change, read_form, read_order
from treestroke.service.photos import Resources
from treestroke.service.sibling_request import read_siblings
from treestroke.service.stored_models import StoredModel
from treestroke.store.search import Search
from treestroke.store.tables import TERMINAL, PhotoRow
from treestroke.wire_requests import MODEL_EXAMPLE, FormRequest
from treestroke.wire_strokes import STROKES_EXAMPLE

router = APIRouter(prefix="/v1/models", tags=["models"])
MAX_WAIT_SECONDS = 60.0
_WAIT = re.compile(r"(?:^|[,;\s])wait=(\d{1,4})(?:$|[,;\s])")
_LOCATION = {
    "Location": {"schema": {"type": "string", "pattern": "^/v1/models/mdl_[0-9a-f]{24}$"}, "description": "the model"},
    "Preference-Applied": {"schema": {"type": "string"}, "description": "the wait that Prefer asked for"},
}
_FILES = (
    "get_tree",
    "get_preview",
    "get_strokes",
    "get_views",
    "get_frame_strokes",
    "get_edits",
    "get_sketch",
    "get_project",
    "get_tree_file",
)
_CHANGES = ("change_model", "cancel_model", "delete_model", "restore_model", "share_model", "list_shares")
_LINKS = leads_to("get_model", "follow_model", *_FILES, *_CHANGES)
_NEXT = {"next_page": {"operationId": "list_models", "parameters": {"cursor": "$response.body#/next"}}}
_PHOTO_FIELD = {"photo": {"type": "string", "format": "binary", "description": ACCEPTED_FORMATS}}
_FORM = FormRequest.model_json_schema()
_FIELDS = (*_PHOTO_FIELD, *FormRequest.model_fields)
_REQUEST_BODY: dict[str, Any] = {
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


@dataclass(frozen=True)
class _Received:
    """A request for a model, and the photo that was sent with it."""

    order: ModelOrder
    photo: PhotoRow | None = None


async def _receive(request: Request, resources: ResourcesOf) -> _Received:
    """Read a request for a model, in a tracing process: JSON that may name a photo, or a form that may bring one."""
    kind = media_type(request)
    if kind in ("application/json", ""):
        return _Received(await run_in_threadpool(resources.tracers, "", read_order, await request.body()))
    if kind != "multipart/form-data":
        raise Refusal(
            "unsupported_media_type", "send application/json, or a form with photo and strokes, or front and side"
        )
    most = len(_FIELDS)
    async with form_of(request, max_files=most, max_fields=most, max_part_size=MAX_TEXT_BYTES) as form:
        if len(form) < len(form.multi_items()):
            raise Refusal("bad_request", "the form has a field twice; send each once")
        photo = form.get("photo")
        if photo is not None and not isinstance(photo, UploadFile):
            raise Refusal("bad_request", "the form has no file in the field photo; send the photo there")
        fields = {name: await _content(field) for name, field in form.items() if field is not photo}
        content = None if photo is None else await photo.read()
    return await run_in_threadpool(_read_form, resources, content, fields)


def _read_form(resources: Resources, photo: bytes | None, fields: dict[str, bytes]) -> _Received:
    if photo is None:
        return _Received(resources.tracers("", read_form, fields, brings_photo=False))
    check_length(photo)
    return _Received(resources.tracers("", read_form, fields), photos.store_pixels(resources, photo))


async def _content(field: UploadFile | str) -> bytes:
    return await field.read() if isinstance(field, UploadFile) else field.encode("utf-8", "surrogatepass")


@router.post(
    "",
    status_code=HTTPStatus.ACCEPTED,
    response_model=ModelInfo,
    responses={
        HTTPStatus.OK: {"model": ModelInfo, "description": "finished already", "headers": _LOCATION, "links": _LINKS},
        HTTPStatus.ACCEPTED: {"model": ModelInfo, "headers": _LOCATION, "links": _LINKS},
        **documented(*BODY, "not_found", "capture_unsolved", "storage_full"),
    },
    openapi_extra=_REQUEST_BODY,
)
async def ask_for_model(
    resources: ResourcesOf,
    dispatcher: DispatcherOf,
    watcher: WatcherOf,
    received: Annotated[_Received, Depends(_receive)],
    idempotency_key: Annotated[str | None, Header(min_length=1, max_length=255, pattern=r"^[\x21-\x7e]+$")] = None,
    prefer: Annotated[str | None, Header(description="wait=SECONDS answers when the model is finished")] = None,
) -> Response:
    """Ask for a tree: always a new model, finished at once where the same was made before."""
    model = await run_in_threadpool(
        stored_models.accept_model, resources, received.order, idempotency_key, received.photo
    )
    dispatcher.notify()
    wanted = _WAIT.search(prefer or "")
    if wanted:
        model = await _finished(watcher, model, min(float(wanted[1]), MAX_WAIT_SECONDS))
    headers = {"Location": f"/v1/models/{model.row.id}"}
    if wanted:
        headers["Preference-Applied"] = f"wait={wanted[1]}"
    status = HTTPStatus.OK if model.row.status in TERMINAL else HTTPStatus.ACCEPTED
    return JSONResponse(model_view(model).model_dump(), status, headers)


async def _finished(watcher: Watcher, model: StoredModel, seconds: float) -> StoredModel:
    """Wait up to ``seconds`` for a model to finish; not at all where too many requests wait."""
    with suppress(TooManyFollowers, TimeoutError), watcher.follow(model) as follower:
        async with asyncio.timeout(seconds):
            while model.row.status not in TERMINAL and (news := await follower.next_change()) is not None:
                model = news
    return model


@router.post(
    "/{id}/siblings",
    status_code=HTTPStatus.ACCEPTED,
    response_model=ModelInfo,
    responses={
        HTTPStatus.OK: {"model": ModelInfo, "description": "finished already", "headers": _LOCATION, "links": _LINKS},
        HTTPStatus.ACCEPTED: {"model": ModelInfo, "headers": _LOCATION, "links": _LINKS},
        **documented(*BODY, "not_found", "storage_full"),
    },
    openapi_extra=SIBLINGS_BODY,
)
def ask_for_siblings(resources: ResourcesOf, dispatcher: DispatcherOf, id: ModelId, body: JsonBody) -> Response:
    """Ask for siblings of a model's tree: a new model of the same inputs, the siblings among its files."""
    model = stored_siblings.accept_siblings(resources, id, resources.tracers("", read_siblings, body))
    dispatcher.notify()
    status = HTTPStatus.OK if model.row.status in TERMINAL else HTTPStatus.ACCEPTED
    return JSONResponse(model_view(model).model_dump(), status, {"Location": f"/v1/models/{model.row.id}"})


def _wanted(
    q: Annotated[str, Query(max_length=MAX_NAME, description="words in name, tags or the maker's name")] = "",
    tag: Annotated[str, Query(max_length=MAX_TAG)] = "",
    maker: Annotated[str, Query(max_length=MAX_ID, description="id of who made them")] = "",
) -> Search:
    return Search(q, tag, maker)


@router.get("", responses={HTTPStatus.OK: {"links": _NEXT}, **documented("invalid")})
def list_models(
    resources: ResourcesOf, wanted: Annotated[Search, Depends(_wanted)], cursor: Cursor = None, limit: Limit = 20
) -> ModelPage:
    """List models, newest first; a search looks through 1000 at a time, and leads on by ``next`` where more follow."""
    page, next_cursor = stored_models.list_models(resources.database, cursor, limit, wanted)
    return ModelPage(models=[model_view(model) for model in page], next=next_cursor)


@router.get("/{id}", responses=documented("not_found"))
def get_model(resources: ResourcesOf, id: ModelId) -> ModelInfo:
    """Look a model up."""
    return model_view(stored_models.find_model(resources.database, id))


@router.patch("/{id}", responses=documented(*BODY, "not_found", "storage_full"), openapi_extra=body_of("ModelChange"))
def change_model(resources: ResourcesOf, id: ModelId, body: JsonBody) -> ModelInfo:
    """Give a model a new name, new tags, or both."""
    return model_view(stored_models.change(resources.database, id, read_change(body)))


@router.delete(
    "/{id}", status_code=HTTPStatus.NO_CONTENT, responses=documented("not_yours", "not_found", "storage_full")
)
def delete_model(resources: ResourcesOf, id: ModelId) -> None:
    """Delete a model; its files go after 24 hours, until then it can be restored."""
    stored_models.delete(resources.database, id)


@router.post("/{id}/restore", responses=documented("not_yours", "not_found", "storage_full"))
def restore_model(resources: ResourcesOf, id: ModelId) -> ModelInfo:
    """Undo a deletion."""
    return model_view(stored_models.restore(resources.database, id))


@router.post("/{id}/cancel", responses=documented("not_found", "storage_full"))
def cancel_model(resources: ResourcesOf, id: ModelId) -> ModelInfo:
    """Stop a model that is not finished; a finished one stays as it is."""
    return model_view(stored_models.cancel(resources.database, id))
