"""The dispatcher: says that jobs wait, takes back the jobs of workers that have gone, and starts sweeps.

A lease has run out when the row's heartbeat counter (``beat``) has not changed for a while on this process's own
monotonic clock. So machines need not agree on the time, and no lease runs out because a clock jumps.
"""

import threading
import time
from collections import Counter as Counts
from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import asdict
from typing import Any, Generic, Protocol, TypeVar

import structlog
from prometheus_client import Counter
from sqlalchemy import delete, func, select, update
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from treestroke.service.engine_version import engine_version
from treestroke.service.failures import problem_of
from treestroke.service.retention import Sweeper
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.leadership import Leadership, LeadLost
from treestroke.store.leases import change_engine, take_back
from treestroke.store.tables import JOBS, AnyJob, ModelRow, SolveRow, Worker

LEASE_SECONDS = 10.0
_TICK_SECONDS = 0.5
_BACKOFF_SECONDS = 2.0
_SWEEP_SECONDS = 600.0
_OVERDUE_SECONDS = 30.0
"""The service is degraded when the dispatcher has not finished a round within this time."""
_UNWATCHED_SECONDS = 3.0
"""Rounds that are further apart than this left a time in which nobody looked."""
LOST = Counter("treestroke_attempts_lost", "Attempts whose lease ran out.")
SENT = Counter("treestroke_messages_sent", "Messages sent to the broker.")
UNSENT = Counter("treestroke_messages_unsent", "Messages that the broker did not accept.")
Key = TypeVar("Key", bound=Hashable)
log = structlog.get_logger()


class Messages(Protocol):
    """The queue's messages, each of which says that a job waits."""

    def waiting(self) -> int:
        """Return how many no worker has taken."""

    def send(self) -> None:
        """Send one."""


class StallDetector(Generic[Key]):
    """Measures how long each of some counters has not changed, by this process's monotonic clock.

    Time in which nobody looked does not count: where the database was away, nobody could count on either.
    """

    def __init__(self) -> None:
        self._looked = time.monotonic()
        self._seen: dict[Key, tuple[int, float]] = {}

    def stalled(self, counters: Iterable[tuple[Key, int]], seconds: float) -> set[Key]:
        """Record all present counters, and return the keys of those that have not changed for ``seconds``."""
        now = time.monotonic()
        unwatched_s = max(now - self._looked - _UNWATCHED_SECONDS, 0.0)
        self._looked = now
        before, self._seen = self._seen, {}
        for key, count in counters:
            known = before.get(key)
            since = known[1] + unwatched_s if known is not None and known[0] == count else now
            self._seen[key] = count, since
        return {key for key, (_, since) in self._seen.items() if now - since >= seconds}


class Dispatcher:
    """A thread of the web process. It keeps no state that a new one could not read from the database.

    Of several web processes on one database one leads: it alone does all of this, and the others stand by.
    """

    def __init__(
        self, database: Database, blobs: Blobs, messages: Messages, keep_days: float, most_running: int = 0
    ) -> None:
        self._database, self._messages, self._most_running = database, messages, most_running
        self._leadership, self._leads = Leadership(database.url), False
        self._jobs, self._workers = StallDetector[tuple[str, int]](), StallDetector[str]()
        self._abandoned = StallDetector[str]()
        self._notified, self._stopped = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name="dispatcher", daemon=True)
        self._last_round = time.monotonic()
        self._sweeper = Sweeper(database, blobs, keep_days, self._stopped)
        self._sweeping = threading.Thread(target=self._sweep, name="sweeper", daemon=True)
        self._no_messages_until = 0.0
        self.broker_accepts = True

    def start(self) -> None:
        """Start dispatching and sweeping."""
        self._thread.start()
        self._sweeping.start()

    @property
    def state(self) -> str:
        """State of the dispatcher: "ok", "standby" where another web process leads, or what is wrong."""
        if not self._thread.is_alive():
            return "has stopped; jobs wait until the service is restarted"
        silent_s = time.monotonic() - self._last_round
        if silent_s >= _OVERDUE_SECONDS:
            return f"has finished no round for {silent_s:.0f} s; its log says why"
        return "ok" if self._leads else "standby"

    def notify(self) -> None:
        """Start the next round now: the queue has changed."""
        self._notified.set()

    def stop(self) -> None:
        """Stop; queued jobs remain rows, which the next dispatcher finds."""
        self._stopped.set()
        self._notified.set()
        for thread in (self._thread, self._sweeping):
            thread.join(timeout=_TICK_SECONDS)

    def _run(self) -> None:
        while not self._stopped.is_set():
            if self._round():
                self._last_round = time.monotonic()
            else:
                self._stopped.wait(_BACKOFF_SECONDS)
            self._notified.wait(_TICK_SECONDS)
            self._notified.clear()
        self._leadership.release()

    def _round(self) -> bool:
        """Do all that is due, each part even if another fails; tell whether all succeeded."""
        succeeded = [_try(self.lead)]
        if self._leads:
            succeeded += [_try(step) for step in (self.recover, self.take_over)]
        return all([*succeeded, _try(self.dispatch)])

    def lead(self) -> None:
        """Find out whether this process leads, or does by now."""
        led, self._leads = self._leads, False
        self._leads = self._leadership.held()
        if self._leads and not led:
            log.info("dispatcher_leads")

    def recover(self) -> None:
        """Take back the jobs whose lease has run out, and remove workers without a heartbeat."""
        with self._database.reading() as session:
            jobs = {job.id: job for job in _running(session)}
            workers = {worker.id: worker for worker in session.scalars(select(Worker))}
        for id, _ in self._jobs.stalled((((job.id, job.attempt), job.beat) for job in jobs.values()), LEASE_SECONDS):
            job = jobs[id]
            with self._database.writing() as session:
                lost = take_back(session, job, problem_of("worker_lost"))
            if lost:
                LOST.inc()
                log.warning("attempt_lost", job=job.id, attempt=job.attempt, worker=job.worker)
        for name in self._workers.stalled(((worker.id, worker.beat) for worker in workers.values()), LEASE_SECONDS):
            with self._database.writing() as session:
                session.execute(delete(Worker).where(Worker.id == name, Worker.beat == workers[name].beat))

    def take_over(self) -> None:
        """Have the jobs of engines that no worker has any more done by this one: they were accepted before an upgrade.

        An engine must lack workers for a while first: they may be about to start.
        """
        own = engine_version()
        with self._database.reading() as session:
            waiting = {engine for (engine, _), count in _counts(session, "queued").items() if count}
            manned = set(session.scalars(select(Worker.engine)))
        abandoned = ((engine, 0) for engine in waiting - manned - {own})
        for engine in self._abandoned.stalled(abandoned, LEASE_SECONDS):
            with self._database.writing() as session:
                change_engine(session, engine, own)
            log.warning("jobs_taken_over", of=engine, engine=own)

    def dispatch(self) -> None:
        """Send as many messages as let workers fill all their slots, and one more for each slot that is filled.

        None is sent beyond those that nobody has taken: the queue never holds more than workers can take.
        """
        if time.monotonic() < self._no_messages_until:
            return
        wanted = self._claimable() if self._leads else 0
        try:
            for _ in range(wanted - self._messages.waiting()):
                self._messages.send()
                SENT.inc()
        except Exception as error:  # noqa: BLE001 - a broker fails in many ways, and all of them mean: try later
            UNSENT.inc()
            self.broker_accepts, self._no_messages_until = False, time.monotonic() + _BACKOFF_SECONDS
            log.warning("message_unsent", error=str(error) or type(error).__name__)
        else:
            self.broker_accepts = True

    def _claimable(self) -> int:
        """Return how many jobs the running workers could claim, now and when they are done with those they have."""
        with self._database.reading() as session:
            queued, running = _counts(session, "queued"), _counts(session, "running")
            slots = session.execute(select(Worker.engine, func.sum(Worker.slots)).group_by(Worker.engine)).all()
        busy, at_work = Counts[str](), Counts[str]()
        for (engine, team), count in running.items():
            busy[engine] += count
            at_work[team] += count
        allowed = Counts[str]()
        for (engine, team), count in queued.items():
            allowed[engine] += min(count, max(self._most_running - at_work[team], 0)) if self._most_running else count
        return sum(min(allowed[engine], max(2 * number - busy[engine], 0)) for engine, number in slots)

    def sweep(self) -> None:
        """Remove old models, photos, captures and files that no row refers to."""
        log.info("swept", **asdict(self._sweeper.sweep()))

    def _sweep(self) -> None:
        """Sweep at intervals, on a thread of its own: a sweep may take a while."""
        while not self._stopped.wait(_TICK_SECONDS):
            if self._leads:
                _try(self.sweep)
                self._stopped.wait(_SWEEP_SECONDS)


def _try(step: Callable[[], None]) -> bool:
    """Run a step and return whether it succeeded; an error is logged and does not end the thread."""
    try:
        step()
    except (SQLAlchemyError, LeadLost, OSError) as error:
        log.error(f"{step.__name__}_failed", error=str(error))
    except Exception:
        log.exception(f"{step.__name__}_failed")
    else:
        return True
    return False


def record_heartbeat(database: Database, worker: str, slots: int, engine: str) -> None:
    """Increase a worker's heartbeat counter, or add the worker."""
    with database.writing() as session:
        updated = session.execute(
            update(Worker).where(Worker.id == worker).values(beat=Worker.beat + 1, slots=slots).returning(Worker.id)
        ).first()
        if updated is None:
            session.add(Worker(id=worker, slots=slots, beat=1, engine=engine))


def holds_jobs(database: Database, worker: str) -> bool:
    """Tell whether a worker has running jobs."""
    with database.reading() as session:
        return any(True for _ in _running(session, worker))


def remove_worker(database: Database, worker: str, error: dict[str, Any] | None = None) -> None:
    """Remove a worker that stops, or that ended by an ``error``, and take back its jobs at once."""
    with database.writing() as session:
        session.execute(delete(Worker).where(Worker.id == worker))
        for job in list(_running(session, worker)):
            take_back(session, job, error)


def queue_figures(database: Database) -> dict[str, tuple[str, float]]:
    """Return the queue's metrics by name, each with its description."""
    with database.reading() as session:
        models, solves = (_by_status(session, table) for table in (ModelRow, SolveRow))
        models_age_s, solves_age_s = (_queue_age_s(session, table) for table in (ModelRow, SolveRow))
        slots = session.scalar(select(func.sum(Worker.slots))) or 0
    return {
        "models_queued": ("Models that are queued.", models.get("queued", 0)),
        "models_running": ("Models that are being grown.", models.get("running", 0)),
        "models_failed": ("Failed models that are kept.", models.get("failed", 0)),
        "models_succeeded": ("Finished models that are kept.", models.get("succeeded", 0)),
        "solves_queued": ("Captures that are queued for their cameras to be found.", solves.get("queued", 0)),
        "solves_running": ("Captures whose cameras are being found.", solves.get("running", 0)),
        "models_queue_age_seconds": ("Time since the oldest queued model was requested, in seconds.", models_age_s),
        "solves_queue_age_seconds": ("Time since the oldest queued capture was requested, in seconds.", solves_age_s),
        "queue_age_seconds": (
            "Time since the oldest queued job was requested, in seconds.",
            max(models_age_s, solves_age_s),
        ),
        "worker_slots": ("Jobs that all running workers can do at once.", slots),
    }


def _running(session: Session, worker: str | None = None) -> Iterator[AnyJob]:
    """Yield the running jobs of all tables; those of one worker where it is named."""
    for table in JOBS:
        held: Any = select(table).where(table.status == "running")
        yield from session.scalars(held if worker is None else held.where(table.worker == worker))


def _counts(session: Session, status: str) -> Counts[tuple[str, str]]:
    """Return how many jobs have a status, by engine and team."""
    found = Counts[tuple[str, str]]()
    for table in JOBS:
        counted = select(table.engine, table.team, func.count()).where(table.status == status)
        for engine, team, count in session.execute(counted.group_by(table.engine, table.team)):
            found[engine, team] += count
    return found


def _queue_age_s(session: Session, table: type[AnyJob]) -> float:
    """Return the time since the oldest queued job of a table was requested, in seconds; 0 where none waits."""
    oldest = session.scalar(select(table.created).where(table.status == "queued").order_by(table.number).limit(1))
    return 0.0 if oldest is None else max(time.time() - oldest, 0.0)


def _by_status(session: Session, table: type[AnyJob]) -> dict[str, int]:
    counted = session.execute(select(table.status, func.count()).group_by(table.status))
    return {status: count for status, count in counted.all()}  # noqa: C416 - rows are no pairs to mypy
