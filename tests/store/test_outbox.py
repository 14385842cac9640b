"""A message to a webhook is there exactly where its job has ended."""

import json
import threading
from typing import Any

import pytest
from sqlalchemy import delete
from tests.rows import add_capture, add_model, add_solve, add_webhook, claim, deliveries

from treestroke.store import leases
from treestroke.store.database import Database
from treestroke.store.scope import SERVICE, Scope
from treestroke.store.tables import ModelRow, SolveRow
from treestroke.store.webhook_tables import WebhookRow

OAKS, ELMS = Scope("oaks", "usr_ann"), Scope("elms", "usr_ben")
GLB = {"tree.glb": ("c" * 64, 7)}
LOST = {"code": "worker_lost", "detail": "lost", "retryable": True}


class Undone(Exception):
    pass


def told(database: Database) -> list[dict[str, Any]]:
    return [json.loads(row.body) for row in deliveries(database)]


def events(database: Database) -> list[str]:
    return [row.event for row in deliveries(database)]


def test_a_message_tells_what_has_ended_and_how(database: Database) -> None:
    webhook = add_webhook(database)
    job = claim(database, add_model(database, name="The old oak", seed=7))
    with database.writing() as session:
        assert leases.succeed(session, job, {"much": "x" * 9999}, GLB)
    (row,) = deliveries(database)
    assert (row.webhook, row.event, row.state, row.attempts, row.due) == (
        webhook.id,
        "model.succeeded",
        "waiting",
        0,
        0,
    )
    body = json.loads(row.body)
    assert (body["type"], set(body)) == ("model.succeeded", {"type", "timestamp", "data"})
    data = body["data"]
    assert (data["id"], data["name"], data["status"], data["seed"]) == (job.id, "The old oak", "succeeded", 7)
    assert (data["attempt"], data["error"], data["url"]) == (1, None, f"/v1/models/{job.id}")
    assert data["finished"].endswith("Z")
    assert len(row.body) < 1000


def test_a_job_that_is_undone_leaves_no_message(database: Database) -> None:
    add_webhook(database)
    job = claim(database, add_model(database))

    def publish_in_vain() -> None:
        with database.writing() as session:
            assert leases.succeed(session, job, {}, GLB)
            session.flush()
            raise Undone

    with pytest.raises(Undone):
        publish_in_vain()
    assert deliveries(database) == []


def test_every_end_of_a_model_is_told(database: Database) -> None:
    add_webhook(database)
    failed, canceled, waiting = (add_model(database) for _ in range(3))
    job = claim(database, failed)
    with database.writing() as session:
        assert leases.end(session, job, "failed", LOST)
    job = claim(database, canceled)
    with database.writing() as session:
        leases.cancel(session, ModelRow, ModelRow.id.in_([canceled.id, waiting.id]))
    assert events(database) == ["model.failed", "model.canceled"]
    with database.writing() as session:
        assert leases.end(session, job, "canceled", None)
    assert [(one["data"]["id"], one["data"]["status"]) for one in told(database)] == [
        (failed.id, "failed"),
        (waiting.id, "canceled"),
        (canceled.id, "canceled"),
    ]
    assert told(database)[0]["data"]["error"] == LOST


def test_a_lost_attempt_is_told_when_it_was_the_last(database: Database) -> None:
    add_webhook(database)
    row = add_model(database)
    for attempt in range(leases.MAX_ATTEMPTS):
        assert events(database) == []
        job = claim(database, row, f"token {attempt}")
        with database.writing() as session:
            assert leases.take_back(session, job, LOST)
    assert events(database) == ["model.failed"]


@pytest.mark.parametrize(("ending", "event"), [("succeeded", "capture.solved"), ("failed", "capture.failed")])
def test_the_end_of_a_solve_is_told_of_its_capture(database: Database, ending: str, event: str) -> None:
    add_webhook(database)
    capture = add_capture(database, name="The ash")
    job = claim(database, add_solve(database, capture.id))
    with database.writing() as session:
        if ending == "succeeded":
            assert leases.complete(session, job, structure="d" * 64)
        else:
            assert leases.end(session, job, "failed", LOST)
    (body,) = told(database)
    assert (body["type"], body["data"]["id"], body["data"]["name"]) == (event, capture.id, "The ash")
    assert (body["data"]["status"], body["data"]["url"]) == (event.split(".")[1], f"/v1/captures/{capture.id}")


def test_a_solve_that_is_canceled_is_not_told(database: Database) -> None:
    add_webhook(database)
    capture = add_capture(database)
    add_solve(database, capture.id)
    with database.writing() as session:
        leases.cancel(session, SolveRow, SolveRow.capture == capture.id)
    assert deliveries(database) == []


def test_only_the_teams_own_enabled_webhooks_are_told_and_of_their_events_alone(database: Database) -> None:
    oaks, elms = database.of(OAKS), database.of(ELMS)
    first, second = add_webhook(oaks), add_webhook(oaks, events=["model.succeeded"])
    add_webhook(oaks, events=["model.failed"])
    add_webhook(oaks, enabled=False)
    add_webhook(elms)
    job = claim(database.of(SERVICE), add_model(oaks))
    with database.of(SERVICE).writing() as session:
        assert leases.succeed(session, job, {}, GLB)
    found = deliveries(database.of(SERVICE))
    assert [(row.webhook, row.team) for row in found] == [(first.id, "oaks"), (second.id, "oaks")]
    assert len({row.id for row in found}) == 2
    assert deliveries(elms) == []


@pytest.mark.parametrize("database_kind", ["postgres"])
def test_a_webhook_that_is_removed_meanwhile_fails_no_job(database: Database) -> None:
    """On Postgres alone, where others write meanwhile."""
    webhook = add_webhook(database)
    job = claim(database, add_model(database))
    published: list[bool] = []

    def publish() -> None:
        with database.writing() as session:
            published.append(leases.succeed(session, job, {}, GLB))

    thread = threading.Thread(target=publish)
    with database.writing() as session:
        session.execute(delete(WebhookRow).where(WebhookRow.id == webhook.id))
        thread.start()
        thread.join(0.5)
    thread.join()
    assert published == [True]
    assert deliveries(database) == []
