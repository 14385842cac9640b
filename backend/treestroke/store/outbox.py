"""The outbox: messages to webhooks, those about a job's end written by the transaction that ends it."""

import json
import time
from collections.abc import Collection, Sequence
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from treestroke.store.queries import new_id
from treestroke.store.tables import AnyJob, CaptureRow, ModelRow, SolveRow
from treestroke.store.times import iso_time
from treestroke.store.webhook_tables import DeliveryRow, WebhookRow
from treestroke.webhook_schemas import JobEvent

_EVENTS: dict[tuple[type[AnyJob], str], JobEvent] = {
    (ModelRow, "succeeded"): "model.succeeded",
    (ModelRow, "failed"): "model.failed",
    (ModelRow, "canceled"): "model.canceled",
    (SolveRow, "succeeded"): "capture.solved",
    (SolveRow, "failed"): "capture.failed",
}
_OF_JOBS = ("engine", "attempt", "error")
_OF_MODELS = ("id", "name", "tags", "status", "photo", "capture", "clip", "seed", *_OF_JOBS)
_TIMES = ("created", "started", "finished")


def note_ended(session: Session, table: type[AnyJob], ids: Collection[str]) -> None:
    """Write a message about each of some jobs of a table that have just ended to each webhook that is told of it.

    Nothing is sent here. A webhook that is being removed at this moment is waited for: no message is left without one.
    """
    if not ids:
        return
    teams = select(table.team).where(table.id.in_(ids))
    enabled = select(WebhookRow).where(WebhookRow.team.in_(teams), WebhookRow.enabled)
    webhooks = session.scalars(enabled.with_for_update(read=True, key_share=True)).all()
    ended: Any = select(table).where(table.id.in_(ids)).execution_options(populate_existing=True)
    jobs: Sequence[AnyJob] = session.scalars(ended).all() if webhooks else ()
    for job in jobs:
        event = _EVENTS.get((table, job.status))
        told = [webhook for webhook in webhooks if webhook.team == job.team and event in webhook.events]
        if event is not None and told:
            data = _told_of(session, job)
            session.add_all(message(webhook, event, data) for webhook in told)


def message(webhook: WebhookRow, event: str, data: dict[str, Any]) -> DeliveryRow:
    """Return the row of a message to a webhook, which is due at once."""
    now = time.time()
    body = json.dumps({"type": event, "timestamp": iso_time(now), "data": data}, separators=(",", ":"))
    return DeliveryRow(id=new_id("msg"), team=webhook.team, webhook=webhook.id, event=event, body=body, created=now)


def _told_of(session: Session, job: AnyJob) -> dict[str, Any]:
    """Return what a message tells of a job: little of what the API answers, by the same names."""
    times = {name: None if (at := getattr(job, name)) is None else iso_time(at) for name in _TIMES}
    if isinstance(job, ModelRow):
        return {**{name: getattr(job, name) for name in _OF_MODELS}, **times, "url": f"/v1/models/{job.id}"}
    capture = session.scalars(select(CaptureRow).where(CaptureRow.id == job.capture)).one()
    told = {"id": capture.id, "name": capture.name, "status": "solved" if job.status == "succeeded" else job.status}
    return {
        **told,
        **{name: getattr(job, name) for name in _OF_JOBS},
        **times,
        "created": iso_time(capture.created),
        "url": f"/v1/captures/{capture.id}",
    }
