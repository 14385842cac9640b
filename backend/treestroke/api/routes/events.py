"""A model's events, as they happen."""

import asyncio
from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Depends, Header
from fastapi.concurrency import run_in_threadpool
from fastapi.sse import EventSourceResponse, ServerSentEvent
from starlette.requests import Request

from treestroke.api.deps import ModelId, ShelfOf
from treestroke.api.errors import documented
from treestroke.api.views import model_view
from treestroke.service import models
from treestroke.service.jobs import GROWTH
from treestroke.service.models import Seen
from treestroke.store.leases import TERMINAL

router = APIRouter(prefix="/v1/models", tags=["models"])
_LOOK_SECONDS = 0.25
_RETRY_MS = 2000


def _seen(shelf: ShelfOf, id: ModelId) -> Seen:
    """Find the model before the stream begins, while the answer can still be 404."""
    return models.see(shelf.database, id)


@router.get("/{id}/events", response_class=EventSourceResponse, responses=documented(403, 404, 422))
async def follow_model(
    request: Request,
    shelf: ShelfOf,
    seen: Annotated[Seen, Depends(_seen)],
    last_event_id: Annotated[str | None, Header(max_length=40)] = None,
) -> AsyncIterator[ServerSentEvent]:
    """Follow a model: ``snapshot``, then ``progress``, one ``preview``, and ``succeeded``, ``failed`` or ``canceled``.

    Only what must not be missed carries an id: ``preview`` and the last event. After a broken connection ``preview``
    comes again unless ``Last-Event-ID`` says that it came; the last event always comes.
    """
    told = int(last_event_id) if last_event_id and last_event_id.isdecimal() else 0
    shown = model_view(seen)
    yield ServerSentEvent(event="snapshot", data=shown, retry=_RETRY_MS)
    while True:
        row = seen.row
        if row.preview_seq and row.preview_seq > told and GROWTH in seen.files:
            growth = await run_in_threadpool(shelf.blobs.get, seen.files[GROWTH].blob)
            told = row.preview_seq
            yield ServerSentEvent(event="preview", raw_data=growth.decode(), id=str(told))
        if row.status in TERMINAL:
            yield ServerSentEvent(event=row.status, data=model_view(seen), id=str(row.seq))
            return
        await asyncio.sleep(_LOOK_SECONDS)
        if request.app.state.closing.is_set():
            return
        # One that is deleted meanwhile is canceled too, and whoever follows it is told so.
        seen = await run_in_threadpool(models.see, shelf.database, row.id, True)
        if (now := model_view(seen)) != shown and now.status not in TERMINAL:
            shown = now
            yield ServerSentEvent(event="progress", data=now)
