"""Messages to webhooks: claimed by whoever sends them, with what became of each attempt; listed and sent again."""

import secrets
import time
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from sqlalchemy import ColumnElement, Float, cast, func, select, update
from sqlalchemy.orm import Session

from treestroke.service.photos import NotFound
from treestroke.store.database import Database
from treestroke.store.outbox import message
from treestroke.store.webhook_tables import DeliveryRow, WebhookRow
from treestroke.webhook_schemas import PING

RETRY_SECONDS = (5, 300, 1800, 7200, 18_000, 36_000, 50_400, 72_000, 86_400)
"""Waits before the further attempts, as Standard Webhooks proposes: ten attempts in a little over three days."""
CLAIM_SECONDS = 60
"""A message is sent again when so much time has passed without an outcome: who sent it is gone."""
MOST_FAILURES = 5
"""A webhook is disabled when so many messages in a row were given up."""
_GONE = 410
_LONGEST_ERROR = 200


class Disabled(Exception):
    """A message was to be sent to a webhook that is disabled."""


@dataclass(frozen=True)
class Due:
    """An attempt that one process may make."""

    id: str
    team: str
    webhook: str
    url: str
    salt: str
    event: str
    body: str
    attempt: int


@dataclass(frozen=True)
class Outcome:
    """What came of an attempt: the HTTP status of the answer, or why there was none."""

    status: int | None
    error: str | None
    seconds: float
    blocked: bool = False

    @property
    def delivered(self) -> bool:
        """Whether the receiver has taken the message."""
        return self.status is not None and 200 <= self.status < 300


def claim_due(session: Session, webhooks: Collection[str] = (), teams: Collection[str] = ()) -> Due | None:
    """Claim the message that is due first, for one attempt; not one to some webhooks or of some teams.

    Whoever claims at the same time gets another one. An attempt without an outcome is made again later. Times are
    those of the database, a Postgres.
    """
    first = (
        select(DeliveryRow.number)
        .join(WebhookRow, WebhookRow.id == DeliveryRow.webhook)
        .where(DeliveryRow.state == "waiting", DeliveryRow.due <= _now(), WebhookRow.enabled)
        .where(DeliveryRow.webhook.not_in(webhooks), DeliveryRow.team.not_in(teams))
        .order_by(DeliveryRow.due, DeliveryRow.number)
        .limit(1)
        .with_for_update(skip_locked=True, of=DeliveryRow)
    )
    number = session.scalar(first)
    if number is None:
        return None
    begun = {"attempts": DeliveryRow.attempts + 1, "due": _now() + CLAIM_SECONDS, "last_attempt": time.time()}
    session.execute(update(DeliveryRow).where(DeliveryRow.number == number).values(**begun))
    claimed = select(DeliveryRow, WebhookRow).join(WebhookRow, WebhookRow.id == DeliveryRow.webhook)
    row, to = session.execute(claimed.where(DeliveryRow.number == number)).one()
    return Due(row.id, row.team, to.id, to.url, to.salt, row.event, row.body, row.attempts)


def record(session: Session, due: Due, outcome: Outcome) -> None:
    """Record what came of an attempt, and when the next one is due; nothing where there was a later attempt."""
    webhook = _locked(session, due.webhook)
    last = DeliveryRow.id == due.id, DeliveryRow.attempts == due.attempt, DeliveryRow.state == "waiting"
    row = session.scalars(select(DeliveryRow).where(*last).with_for_update()).first()
    if webhook is None or row is None:
        return
    row.last_status, row.last_seconds = outcome.status, outcome.seconds
    row.last_error = outcome.error and outcome.error[:_LONGEST_ERROR]
    if outcome.delivered:
        row.state, webhook.failures = "delivered", 0
    elif outcome.status == _GONE:
        row.state = "failed"
        disable(session, webhook, "gone")
    elif outcome.blocked or due.event == PING or due.attempt > len(RETRY_SECONDS):
        row.state = "blocked" if outcome.blocked else "failed"
        _count_failure(session, webhook, due)
    else:
        session.execute(update(DeliveryRow).where(*last).values(due=_now() + RETRY_SECONDS[due.attempt - 1]))


def disable(session: Session, webhook: WebhookRow, reason: str | None) -> None:
    """Disable a locked webhook; what waits for it is canceled."""
    session.flush()
    webhook.enabled, webhook.disabled_reason = False, reason
    waiting = DeliveryRow.webhook == webhook.id, DeliveryRow.state == "waiting"
    session.execute(update(DeliveryRow).where(*waiting).values(state="canceled"))


def ping(database: Database, id: str) -> DeliveryRow:
    """Write a message that tells nothing, to see whether a webhook takes it; it is sent once.

    Raises
    ------
    NotFound, Disabled
        There is no such webhook, or it is disabled.
    """
    with database.writing() as session:
        row = message(_enabled(session, id), PING, {"webhook": id, "nonce": secrets.token_hex(8)})
        session.add(row)
    return row


def list_deliveries(
    database: Database, webhook: str, cursor: str | None, limit: int
) -> tuple[Sequence[DeliveryRow], str | None]:
    """Return a page of the messages to a webhook, newest first, and the cursor of the next page: decimal digits.

    Raises
    ------
    NotFound
        There is no such webhook.
    """
    newest = select(DeliveryRow).where(DeliveryRow.webhook == webhook).order_by(DeliveryRow.number.desc())
    with database.reading() as session:
        if session.scalars(select(WebhookRow.id).where(WebhookRow.id == webhook)).first() is None:
            raise NotFound("webhook")
        page = newest if cursor is None else newest.where(DeliveryRow.number < int(cursor))
        rows = session.scalars(page.limit(limit + 1)).all()
    return rows[:limit], str(rows[limit - 1].number) if len(rows) > limit else None


def resend(database: Database, id: str) -> DeliveryRow:
    """Have a message sent at once, by the id that it has; if it fails, it is sent again as often as it still may be.

    Raises
    ------
    NotFound, Disabled
        There is no such message, or its webhook is disabled.
    """
    with database.writing() as session:
        webhook = session.scalar(select(DeliveryRow.webhook).where(DeliveryRow.id == id))
        if webhook is None:
            raise NotFound("delivery")
        _enabled(session, webhook)
        row = session.scalars(select(DeliveryRow).where(DeliveryRow.id == id).with_for_update()).one()
        row.state, row.due = "waiting", 0.0
    return row


def _enabled(session: Session, id: str) -> WebhookRow:
    """Return a webhook, locked.

    Raises
    ------
    NotFound, Disabled
        There is no such webhook, or it is disabled.
    """
    webhook = _locked(session, id)
    if webhook is None:
        raise NotFound("webhook")
    if not webhook.enabled:
        raise Disabled
    return webhook


def _locked(session: Session, id: str) -> WebhookRow | None:
    """Return a webhook that nobody else changes meanwhile; messages to it are written nevertheless."""
    return session.scalars(select(WebhookRow).where(WebhookRow.id == id).with_for_update(key_share=True)).first()


def _count_failure(session: Session, webhook: WebhookRow, due: Due) -> None:
    """Count a message that was given up; a ping is not counted, since somebody looks at what becomes of it."""
    if due.event != PING:
        webhook.failures += 1
    if webhook.failures >= MOST_FAILURES:
        disable(session, webhook, "failing")


def _now() -> ColumnElement[float]:
    return cast(func.extract("epoch", func.clock_timestamp()), Float)
