"""A model's events as a stream (server-sent events)."""

from collections.abc import AsyncIterator
from typing import Annotated

import structlog
from fastapi import APIRouter, Depends, Header
from fastapi.concurrency import run_in_threadpool
from fastapi.sse import EventSourceResponse, ServerSentEvent

from treestroke.api.deps import ModelId, PrincipalOf, ResourcesOf, WatcherOf
from treestroke.api.errors import documented
from treestroke.api.following import Follower
from treestroke.api.views import model_view
from treestroke.service import stored_models
from treestroke.service.jobs import GROWTH
from treestroke.service.photos import Resources
from treestroke.service.stored_models import StoredModel
from treestroke.store.objects import Damaged, StorageAway
from treestroke.store.tables import TERMINAL

log = structlog.get_logger()
router = APIRouter(prefix="/v1/models", tags=["models"])
_RETRY_MS = 2000


def _model(resources: ResourcesOf, id: ModelId) -> StoredModel:
    """Return the model; before the stream begins, while the response can still be a problem."""
    return stored_models.find_model(resources.database, id)


async def _follower(
    watcher: WatcherOf, principal: PrincipalOf, model: Annotated[StoredModel, Depends(_model)]
) -> AsyncIterator[Follower[StoredModel]]:
    """Yield a follower of the model; before the stream begins, while the response can still be a problem."""
    async with watcher.stream(model, principal) as follower:
        yield follower


def _growth(resources: Resources, model: StoredModel) -> str | None:
    """Return the grown skeleton as JSON; None if it cannot be read, because a stream cannot become a problem."""
    try:
        return resources.blobs.get(model.files[GROWTH].blob).decode()
    except (Damaged, StorageAway) as error:
        log.error("growth_not_read", error=str(error))
        return None


@router.get("/{id}/events", response_class=EventSourceResponse, responses=documented("not_found", "invalid"))
async def follow_model(
    resources: ResourcesOf,
    model: Annotated[StoredModel, Depends(_model)],
    follower: Annotated[Follower[StoredModel], Depends(_follower)],
    last_event_id: Annotated[str | None, Header(max_length=40)] = None,
) -> AsyncIterator[ServerSentEvent]:
    """Follow a model: ``snapshot``, then ``progress``, one ``preview``, and ``succeeded``, ``failed`` or ``canceled``.

    Only ``preview`` and the last event have an id. After a broken connection ``preview`` is sent again unless
    ``Last-Event-ID`` says that it arrived; the last event is always sent.
    """
    sent = int(last_event_id) if last_event_id and last_event_id.isdecimal() else 0
    shown, latest = model_view(model), model
    yield ServerSentEvent(event="snapshot", data=shown, retry=_RETRY_MS)
    while True:
        row = latest.row
        if row.preview_seq and row.preview_seq > sent and GROWTH in latest.files:
            sent = row.preview_seq
            if growth := await run_in_threadpool(_growth, resources, latest):
                yield ServerSentEvent(event="preview", raw_data=growth, id=str(sent))
        if row.status in TERMINAL:
            yield ServerSentEvent(event=row.status, data=model_view(latest), id=str(row.seq))
            return
        # A model that is deleted meanwhile is also canceled, and that is sent as its last event.
        if (change := await follower.next_change()) is None:
            return
        latest = change
        if (now := model_view(latest)) != shown and now.status not in TERMINAL:
            shown = now
            yield ServerSentEvent(event="progress", data=now)
