"""Messages on their way from the outbox to a receiver, on the database that hosted services have."""

import os
import signal
import ssl
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select, update
from standardwebhooks import Webhook, WebhookVerificationError
from tests.faults.processes import wait_for
from tests.receiver import Receiver, answering, receiving
from tests.rows import add_model, add_webhook, claim, deliveries
from tests.running import BACKEND

from treestroke.service.deliveries import (
    CLAIM_SECONDS,
    MOST_FAILURES,
    RETRY_SECONDS,
    Disabled,
    Outcome,
    claim_due,
    ping,
    record,
    resend,
)
from treestroke.service.public_addresses import is_public
from treestroke.service.webhook_secrets import secret_of
from treestroke.service.webhook_sender import WebhookSender
from treestroke.store import leases
from treestroke.store.database import Database
from treestroke.store.scope import SERVICE
from treestroke.store.webhook_tables import DeliveryRow, WebhookRow

SECRET = "a secret of the tests, long enough to digest keys by"
SECONDS = 120.0
TOOK = Outcome(200, None, 0.1)
REFUSED = Outcome(500, None, 0.1)
ROOT = Path(__file__).parents[2]


@pytest.fixture
def database_kind() -> str:
    return "postgres"


@pytest.fixture(scope="module")
def running() -> Iterator[Receiver]:
    with receiving() as receiver:
        yield receiver


@pytest.fixture
def receiver(running: Receiver) -> Receiver:
    running.behave = answering(200)
    running.arrived.clear()
    return running


def end_model(database: Database) -> str:
    """Have a model end, and return the id of the message about it."""
    job = claim(database, add_model(database))
    with database.writing() as session:
        assert leases.end(session, job, "failed", None)
    return deliveries(database)[-1].id


def set_rows(database: Database, table: type[DeliveryRow] | type[WebhookRow], **values: Any) -> None:
    with database.writing() as session:
        session.execute(update(table).values(**values))


def webhook_of(database: Database) -> WebhookRow:
    with database.reading() as session:
        return session.scalars(select(WebhookRow)).one()


def attempt(database: Database, outcome: Outcome) -> DeliveryRow:
    """Make the attempt that is due, with an outcome; what waits for a later one does so no more."""
    with database.writing() as session:
        due = claim_due(session)
        assert due is not None
        record(session, due, outcome)
    row = next(row for row in deliveries(database) if row.id == due.id)
    set_rows(database, DeliveryRow, due=0.0)
    return row


class Sending:
    """Senders that run while a test does."""

    def __init__(self, database: Database, receiver: Receiver, **caller: object) -> None:
        self._all = [WebhookSender(database.of(SERVICE), SECRET, receiver.caller(**caller)) for _ in range(2)]

    def __enter__(self) -> None:
        for sender in self._all:
            sender.start()

    def __exit__(self, *_: object) -> None:
        for sender in self._all:
            sender.stop()
        wait_for(lambda: not any(one.name == "webhook" for one in threading.enumerate()), SECONDS, "the last attempts")


def has_status(database: Database, status: int) -> bool:
    return deliveries(database)[0].last_status == status


def trusting(*receivers: Receiver) -> ssl.SSLContext:
    trust = ssl.create_default_context()
    for receiver in receivers:
        receiver.authority.configure_trust(trust)
    return trust


def wait_for_states(database: Database, *states: str) -> None:
    wait_for(lambda: [row.state for row in deliveries(database)] == list(states), SECONDS, "the states of deliveries")


def test_a_message_arrives_signed_by_the_webhooks_secret(database: Database, receiver: Receiver) -> None:
    webhook = add_webhook(database, url=receiver.url, salt="1")
    id = end_model(database)
    with Sending(database, receiver):
        wait_for_states(database, "delivered")
    (message,) = receiver.arrived
    assert message.id == id
    assert message.body == deliveries(database)[0].body
    assert message.headers["content-type"] == "application/json"
    secret = secret_of(SECRET, webhook.id, "1")
    assert Webhook(secret).verify(message.body, message.headers)["type"] == "model.failed"
    for other in (secret_of(SECRET, webhook.id, "2"), secret_of(SECRET, "hook_2", "1"), secret_of("other", "x", "1")):
        with pytest.raises(WebhookVerificationError):
            Webhook(other).verify(message.body, message.headers)
    (row,) = deliveries(database)
    assert (row.attempts, row.last_status, row.last_error) == (1, 200, None)


def test_every_message_arrives_once_where_two_processes_send(database: Database, receiver: Receiver) -> None:
    add_webhook(database, url=receiver.url)
    ids = [end_model(database) for _ in range(12)]
    with Sending(database, receiver):
        wait_for_states(database, *["delivered"] * 12)
    assert sorted(message.id for message in receiver.arrived) == sorted(ids)


def test_what_was_refused_is_sent_again_by_the_same_id(database: Database, receiver: Receiver) -> None:
    add_webhook(database, url=receiver.url)
    receiver.behave = answering(500, 302, 200)
    id = end_model(database)
    with Sending(database, receiver):
        for status in (500, 302):
            wait_for(partial(has_status, database, status), SECONDS, "an outcome")
            set_rows(database, DeliveryRow, due=0.0)
        wait_for_states(database, "delivered")
    assert [message.id for message in receiver.arrived] == [id] * 3
    assert deliveries(database)[0].attempts == 3


def test_a_receiver_that_is_gone_disables_its_webhook_at_once(database: Database, receiver: Receiver) -> None:
    add_webhook(database, url=receiver.url)
    first = end_model(database)
    with database.writing() as session:
        due = claim_due(session)
        assert due is not None
    end_model(database)
    with database.writing() as session:
        record(session, due, Outcome(410, None, 0.1))
    assert [(row.id == first, row.state) for row in deliveries(database)] == [(True, "failed"), (False, "canceled")]
    webhook = webhook_of(database)
    assert (webhook.enabled, webhook.disabled_reason) == (False, "gone")
    with database.writing() as session:
        assert claim_due(session) is None
    for again in (lambda: ping(database, webhook.id), lambda: resend(database, first)):
        with pytest.raises(Disabled):
            again()


def test_an_address_that_is_not_public_by_now_is_not_called(database: Database, receiver: Receiver) -> None:
    add_webhook(database, url=receiver.url)
    end_model(database)
    with Sending(database, receiver, allowed=is_public):
        wait_for_states(database, "blocked")
    assert receiver.arrived == []
    (row,) = deliveries(database)
    assert "127.0.0.1, which is not public" in (row.last_error or "")


def test_a_message_is_given_up_after_its_last_attempt(database: Database) -> None:
    add_webhook(database)
    end_model(database)
    rows = [attempt(database, REFUSED) for _ in range(len(RETRY_SECONDS) + 1)]
    assert [row.state for row in rows] == ["waiting"] * len(RETRY_SECONDS) + ["failed"]
    waits = [row.due - (row.last_attempt or 0) for row in rows[:-1]]
    assert waits == pytest.approx(RETRY_SECONDS, abs=60)
    assert 3 * 86_400 < sum(RETRY_SECONDS) < 4 * 86_400
    assert webhook_of(database).failures == 1


def test_a_webhook_is_disabled_when_messages_in_a_row_were_given_up(database: Database) -> None:
    webhook = add_webhook(database)
    for number in range(1, MOST_FAILURES + 3):
        end_model(database)
        set_rows(database, DeliveryRow, attempts=len(RETRY_SECONDS))
        attempt(database, TOOK if number == 2 else REFUSED)
        found = webhook_of(database)
        assert found.failures == (number if number < 2 else number - 2)
        assert found.enabled == (number < MOST_FAILURES + 2)
    assert webhook_of(database).disabled_reason == "failing"
    assert webhook.id == found.id


def test_a_ping_is_sent_once_and_counts_for_nothing(database: Database) -> None:
    row = ping(database, add_webhook(database, events=["model.failed"]).id)
    assert attempt(database, REFUSED).state == "failed"
    assert webhook_of(database).failures == 0
    resend(database, row.id)
    assert attempt(database, TOOK).state == "delivered"


def test_a_message_can_be_sent_again(database: Database) -> None:
    add_webhook(database)
    id = end_model(database)
    assert attempt(database, TOOK).state == "delivered"
    assert (resend(database, id).state, resend(database, id).id) == ("waiting", id)
    assert attempt(database, TOOK).attempts == 2


def test_an_attempt_of_a_process_that_died_is_made_again(database: Database) -> None:
    add_webhook(database)
    end_model(database)
    with database.writing() as session:
        lost = claim_due(session)
    with database.writing() as session:
        assert claim_due(session) is None  # for now
    (row,) = deliveries(database)
    assert row.due - (row.last_attempt or 0) == pytest.approx(CLAIM_SECONDS, abs=30)
    set_rows(database, DeliveryRow, due=0.0)
    with database.writing() as session:
        again = claim_due(session)
        assert lost is not None
        assert again is not None
        assert (again.id, again.attempt) == (lost.id, 2)
        record(session, lost, REFUSED)  # it was not dead but slow: what it says now is about an earlier attempt
    assert deliveries(database)[0].last_status is None


def test_a_claim_waits_for_nobody(database: Database) -> None:
    add_webhook(database)
    first, second = end_model(database), end_model(database)
    with database.writing() as one, database.writing() as other:
        claims = [claim_due(one), claim_due(other), claim_due(other)]
    assert [due and due.id for due in claims] == [first, second, None]


def test_a_slow_receiver_keeps_no_others_waiting(database: Database, receiver: Receiver) -> None:
    over = threading.Event()
    receiver.behave = lambda _: over.wait(SECONDS) and None
    slow = add_webhook(database, url=receiver.url)
    for _ in range(9):
        end_model(database)
    with receiving() as quick, Sending(database, quick, trust=trusting(receiver, quick)):
        wait_for(lambda: len(receiver.arrived) == 4, SECONDS, "two messages of each of two processes")
        add_webhook(database, url=quick.url)
        end_model(database)
        wait_for(lambda: len(quick.arrived) == 1, SECONDS, "the other webhook's message")
        assert len(receiver.arrived) == 4
        over.set()
    assert {row.webhook for row in deliveries(database) if row.state == "waiting"} <= {slow.id}


SENDER = """
import sys, ssl, time
from pathlib import Path
from treestroke.service.webhook_calls import Caller
from treestroke.service.webhook_sender import WebhookSender
from treestroke.store.database import Database
from treestroke.store.scope import SERVICE
url, certificates = sys.argv[1:]
trust = ssl.create_default_context(cafile=certificates)
caller = Caller(lambda _: True, lambda *_: ["127.0.0.1"], trust)
WebhookSender(Database(Path("."), url).of(SERVICE), "s" * 32, caller).start()
time.sleep(600)
"""


def test_a_process_that_is_killed_over_a_message_loses_none(
    database: Database, receiver: Receiver, tmp_path: Path
) -> None:
    """The receiver has taken it, and nobody has written that down: it comes again, by the same id."""
    add_webhook(database, url=receiver.url)
    id = end_model(database)
    over = threading.Event()
    receiver.behave = lambda _: over.wait(SECONDS) and None
    certificates = tmp_path / "ca.pem"
    certificates.write_bytes(receiver.authority.cert_pem.bytes())
    command = [sys.executable, "-c", SENDER, database.url, str(certificates)]
    environment: Mapping[str, str] = {**os.environ, "PYTHONPATH": str(BACKEND)}
    process = subprocess.Popen(command, env=environment)
    try:
        wait_for(lambda: receiver.arrived, SECONDS, "the message")
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
        over.set()
    assert deliveries(database)[0].state == "waiting"
    receiver.behave = answering(200)
    set_rows(database, DeliveryRow, due=0.0)  # as it would be a minute later
    with Sending(database, receiver):
        wait_for_states(database, "delivered")
    assert [message.id for message in receiver.arrived] == [id, id]
    assert deliveries(database)[0].attempts == 2
