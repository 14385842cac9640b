"""The sender of messages to webhooks: a thread of each web process that finds what is due, and one for each attempt."""

import threading
import time
from collections import Counter as Counts
from datetime import UTC, datetime

import structlog
from prometheus_client import Counter
from sqlalchemy.exc import SQLAlchemyError

from treestroke.service.deliveries import Due, Outcome, claim_due, record
from treestroke.service.webhook_calls import Caller, CallFailed, NotPublic
from treestroke.service.webhook_secrets import secret_of, signed_headers
from treestroke.store.database import Database

_TICK_SECONDS = 1.0
_BACKOFF_SECONDS = 5.0
_AT_ONCE, _OF_TEAM, _OF_WEBHOOK = 16, 4, 2
"""Attempts that one process makes at the same time: in all, for one team and for one webhook."""
ATTEMPTS = Counter("treestroke_webhook_attempts", "Attempts to send a message to a webhook.", ["outcome"])
log = structlog.get_logger()


class WebhookSender:
    """Sends what is due in the outbox. Any number of processes may do so; each attempt is made by one of them.

    A receiver that is slow keeps the others waiting only where all of a team's, or of the process's, attempts at the
    same time are such.
    """

    def __init__(self, database: Database, service_secret: str, caller: Caller) -> None:
        self._database, self._secret, self._caller = database, service_secret, caller
        self._under_way: dict[str, Due] = {}
        self._notified, self._stopped = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name="webhooks", daemon=True)

    def start(self) -> None:
        """Start sending."""
        self._thread.start()

    def notify(self) -> None:
        """Look at once for what is due."""
        self._notified.set()

    def stop(self) -> None:
        """Stop; attempts that are under way end with the process, and are made again by another."""
        self._stopped.set()
        self._notified.set()
        if self._thread.is_alive():
            self._thread.join(timeout=_TICK_SECONDS)

    def _run(self) -> None:
        while not self._stopped.is_set():
            pause = _TICK_SECONDS
            try:
                while not self._stopped.is_set() and self.begin_next():
                    pass
            except SQLAlchemyError as error:
                log.error("webhooks_not_sent", error=str(error))
                pause = _BACKOFF_SECONDS
            self._notified.wait(pause)
            self._notified.clear()

    def begin_next(self) -> bool:
        """Begin the attempt that is due first; return whether there is one, and room for it.

        Raises
        ------
        SQLAlchemyError
            The database is away.
        """
        under_way = list(self._under_way.values())
        if len(under_way) >= _AT_ONCE:
            return False
        webhooks, teams = Counts(due.webhook for due in under_way), Counts(due.team for due in under_way)
        busy = [id for id, count in webhooks.items() if count >= _OF_WEBHOOK]
        with self._database.writing() as session:
            due = claim_due(session, busy, [team for team, count in teams.items() if count >= _OF_TEAM])
        if due is None:
            return False
        self._under_way[f"{due.id} {due.attempt}"] = due
        threading.Thread(target=self._make, args=(due,), name="webhook", daemon=True).start()
        return True

    def _make(self, due: Due) -> None:
        """Make an attempt and record what came of it; what is not recorded is sent again."""
        try:
            outcome = self._attempt(due)
            with self._database.writing() as session:
                record(session, due, outcome)
            told = "blocked" if outcome.blocked else "delivered" if outcome.delivered else "failed"
            ATTEMPTS.labels(told).inc()
            log.info("webhook_sent", webhook=due.webhook, message=due.id, attempt=due.attempt, outcome=told)
        except SQLAlchemyError as error:
            log.error("webhook_not_recorded", message=due.id, error=str(error))
        finally:
            del self._under_way[f"{due.id} {due.attempt}"]
            self.notify()

    def _attempt(self, due: Due) -> Outcome:
        begun = time.monotonic()
        secret = secret_of(self._secret, due.webhook, due.salt)
        headers = signed_headers(secret, due.id, due.body, datetime.now(UTC))
        status: int | None = None
        error: str | None = None
        blocked = False
        try:
            status = self._caller.post(due.url, headers, due.body.encode())
        except NotPublic as refused:
            error, blocked = str(refused), True
        except CallFailed as failed:
            error = str(failed)
        return Outcome(status, error, round(time.monotonic() - begun, 3), blocked)
