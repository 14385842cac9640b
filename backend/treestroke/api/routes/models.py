"""Models: asked for, followed, named, stopped, deleted, restored."""

import asyncio
import re
import time
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, HTTPException, Query, Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import JSONResponse
from starlette.datastructures import UploadFile

from treestroke.api.deps import DispatcherOf, ShelfOf, media_type
from treestroke.api.errors import documented
from treestroke.api.views import model_view
from treestroke.codec.image import MAX_BYTES
from treestroke.schemas import Model, ModelPage, Rename
from treestroke.service import models, photos
from treestroke.service.models import MAX_PAGE, Seen
from treestroke.service.photos import Shelf
from treestroke.service.tracing import Wish, read_fields
from treestroke.store.leases import TERMINAL

router = APIRouter(prefix="/v1/models", tags=["models"])
MAX_WAIT_SECONDS = 60.0
_LOOK_SECONDS = 0.1
_WAIT = re.compile(r"(?:^|[,;\s])wait=(\d{1,4})(?:$|[,;\s])")
_LOCATION = {"Location": {"schema": {"type": "string"}, "description": "the model"}}
_TEXT = {"type": "string"}
_ASK: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {"schema": {"$ref": "#/components/schemas/ModelRequest"}},
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["photo", "strokes"],
                    "properties": {
                        "photo": {"type": "string", "format": "binary"},
                        "strokes": {**_TEXT, "description": "JSON"},
                        "settings": {**_TEXT, "description": "JSON"},
                        "seed": _TEXT,
                        "name": _TEXT,
                    },
                }
            },
        },
    }
}


async def _wish(request: Request, shelf: ShelfOf) -> Wish:
    """Read a request for a model: JSON that names a photo, or a form that brings one."""
    kind = media_type(request)
    if kind in ("application/json", ""):
        return await run_in_threadpool(models.read_wish, shelf, await request.body())
    if kind != "multipart/form-data":
        raise HTTPException(415, "send application/json, or a form with the fields photo and strokes")
    async with request.form(max_files=2, max_fields=5) as form:
        photo = form.get("photo")
        if not isinstance(photo, UploadFile):
            raise HTTPException(400, "the form has no file in the field photo; send the photo there")
        texts = [await _text(form.get(name)) for name in ("strokes", "settings", "seed", "name")]
        content = await photo.read()
    return await run_in_threadpool(_take_in, shelf, content, texts)


def _take_in(shelf: Shelf, content: bytes, texts: list[bytes]) -> Wish:
    if len(content) > MAX_BYTES:
        raise HTTPException(413, f"the photo has more than {MAX_BYTES // 10**6} MB; save it smaller")
    wish = shelf.tracers("", read_fields, "", *texts)
    return Wish(photos.add_photo(shelf, content).id, wish.strokes, wish.settings, wish.seed, wish.name)


async def _text(field: UploadFile | str | None) -> bytes:
    if isinstance(field, UploadFile):
        return await field.read()
    return (field or "").encode("utf-8", "surrogatepass")


@router.post(
    "",
    status_code=202,
    response_model=Model,
    responses={
        200: {"model": Model, "description": "finished already", "headers": _LOCATION},
        202: {"model": Model, "headers": _LOCATION},
        **documented(400, 403, 404, 408, 413, 415, 422, 503, 507),
    },
    openapi_extra=_ASK,
)
async def ask_for_model(
    shelf: ShelfOf,
    dispatcher: DispatcherOf,
    wish: Annotated[Wish, Depends(_wish)],
    idempotency_key: Annotated[str | None, Header(min_length=1, max_length=255, pattern=r"^[\x21-\x7e]+$")] = None,
    prefer: Annotated[str | None, Header(description="wait=SECONDS answers when the model is finished")] = None,
) -> Response:
    """Ask for a tree: always a new model, finished at once where the same was made before."""
    seen = await run_in_threadpool(models.ask_for_model, shelf, wish, idempotency_key)
    dispatcher.wake()
    wanted = _WAIT.search(prefer or "")
    if wanted:
        seen = await _finished(shelf, seen, min(float(wanted[1]), MAX_WAIT_SECONDS))
    headers = {"Location": f"/v1/models/{seen.row.id}"}
    if wanted:
        headers["Preference-Applied"] = f"wait={wanted[1]}"
    status = 200 if seen.row.status in TERMINAL else 202
    return JSONResponse(model_view(seen).model_dump(), status, headers)


async def _finished(shelf: Shelf, seen: Seen, seconds: float) -> Seen:
    deadline = time.monotonic() + seconds
    while seen.row.status not in TERMINAL and time.monotonic() < deadline:
        await asyncio.sleep(_LOOK_SECONDS)
        seen = await run_in_threadpool(models.see, shelf.database, seen.row.id)
    return seen


@router.get("", responses=documented(403, 422))
def list_models(
    shelf: ShelfOf,
    cursor: Annotated[str | None, Query(max_length=40)] = None,
    limit: Annotated[int, Query(ge=1, le=MAX_PAGE)] = 20,
) -> ModelPage:
    """List models, newest first."""
    page, following = models.list_models(shelf.database, cursor, limit)
    return ModelPage(models=[model_view(seen) for seen in page], next=following)


@router.get("/{id}", responses=documented(403, 404))
def get_model(shelf: ShelfOf, id: str) -> Model:
    """Look a model up."""
    return model_view(models.see(shelf.database, id))


@router.patch("/{id}", responses=documented(400, 403, 404, 408, 413, 422))
def rename_model(shelf: ShelfOf, id: str, change: Rename) -> Model:
    """Name a model."""
    return model_view(models.rename(shelf.database, id, change.name))


@router.delete("/{id}", status_code=204, responses=documented(403, 404))
def delete_model(shelf: ShelfOf, id: str) -> None:
    """Delete a model; its files go after 24 hours, until then it can be restored."""
    models.delete(shelf.database, id)


@router.post("/{id}/restore", responses=documented(403, 404))
def restore_model(shelf: ShelfOf, id: str) -> Model:
    """Take a deletion back."""
    return model_view(models.restore(shelf.database, id))


@router.post("/{id}/cancel", responses=documented(403, 404))
def cancel_model(shelf: ShelfOf, id: str) -> Model:
    """Stop a model that is not finished; a finished one stays as it is."""
    return model_view(models.cancel(shelf.database, id))
