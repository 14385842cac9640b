"""The dispatcher: sends messages for queued jobs, takes back the jobs of workers that have gone, and starts sweeps.

A lease has run out when the row's heartbeat counter (``beat``) has not changed for a while on this process's own
monotonic clock. So machines need not agree on the time, and no lease runs out because a clock jumps.
"""

import threading
import time
from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import asdict
from itertools import islice, zip_longest
from typing import Any, Generic, TypeVar

import structlog
from prometheus_client import Counter
from sqlalchemy import delete, func, select, update
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from treestroke.queue import GROW, SOLVE
from treestroke.service.failures import problem_of
from treestroke.service.retention import Sweeper
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.leases import AnyJob, take_back
from treestroke.store.tables import JOBS, ModelRow, SolveRow, Worker

LEASE_SECONDS = 10.0
RESEND_SECONDS = 5.0
_TICK_SECONDS = 0.5
_BACKOFF_SECONDS = 2.0
_SWEEP_SECONDS = 600.0
_OVERDUE_SECONDS = 30.0
"""The service is degraded when the dispatcher has not finished a round within this time."""
_UNWATCHED_SECONDS = 3.0
"""Rounds that are further apart than this left a time in which nobody looked."""
_UNKNOWN_SLOTS = 2
"""Messages that are sent while no worker is known: one may be about to start."""
TASKS: dict[type[AnyJob], str] = {ModelRow: GROW, SolveRow: SOLVE}
"""The task by which workers do the jobs of each table."""
LOST = Counter("treestroke_attempts_lost", "Attempts whose lease ran out.")
SENT = Counter("treestroke_messages_sent", "Messages sent to the broker.")
UNSENT = Counter("treestroke_messages_unsent", "Messages that the broker did not accept.")
Key = TypeVar("Key", bound=Hashable)
log = structlog.get_logger()


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

    ``send`` takes the name of a task and the id of a job.
    """

    def __init__(self, database: Database, blobs: Blobs, send: Callable[[str, str], None], keep_days: float) -> None:
        self._database, self._send = database, send
        self._jobs, self._workers = StallDetector[tuple[str, int]](), StallDetector[str]()
        self._sent: dict[str, float] = {}
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
        """State of the dispatcher: "ok", or what is wrong."""
        if not self._thread.is_alive():
            return "has stopped; jobs wait until the service is restarted"
        silent_s = time.monotonic() - self._last_round
        return "ok" if silent_s < _OVERDUE_SECONDS else f"has finished no round for {silent_s:.0f} s; its log says why"

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
            succeeded = [_try(step) for step in (self.recover, self.dispatch)]  # both, even if the first fails
            if all(succeeded):
                self._last_round = time.monotonic()
            else:
                self._stopped.wait(_BACKOFF_SECONDS)
            self._notified.wait(_TICK_SECONDS)
            self._notified.clear()

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
                self._sent.pop(job.id, None)
        for name in self._workers.stalled(((worker.id, worker.beat) for worker in workers.values()), LEASE_SECONDS):
            with self._database.writing() as session:
                session.execute(delete(Worker).where(Worker.id == name, Worker.beat == workers[name].beat))

    def dispatch(self) -> None:
        """Send messages for the next jobs: as many as fill all slots, and one more for each slot.

        The tables take turns, so that no kind of job waits for all of another.
        """
        if time.monotonic() < self._no_messages_until:
            return
        with self._database.reading() as session:
            slots = session.scalar(select(func.sum(Worker.slots))) or 0
            running = sum(_count(session, table, "running") for table in JOBS)
            wanted = max(2 * slots - running, 0) if slots else _UNKNOWN_SLOTS
            next_ones = dict(_next_ones(session, wanted))
        now = time.monotonic()
        self._sent = {id: at for id, at in self._sent.items() if id in next_ones}
        for id, task in next_ones.items():
            # Without workers one message for each job is enough: more would pile up in the broker.
            due = id not in self._sent or (slots and now - self._sent[id] >= RESEND_SECONDS)
            if due and not self._send_message(task, id, now):
                return

    def sweep(self) -> None:
        """Remove old models, photos, captures and files that no row refers to."""
        log.info("swept", **asdict(self._sweeper.sweep()))

    def _sweep(self) -> None:
        """Sweep at intervals, on a thread of its own: a sweep may take a while."""
        while not self._stopped.is_set():
            _try(self.sweep)
            self._stopped.wait(_SWEEP_SECONDS)

    def _send_message(self, task: str, id: str, now: float) -> bool:
        """Send the message for a job; False if the broker does not accept it."""
        try:
            self._send(task, id)
        except Exception as error:  # noqa: BLE001 - a broker fails in many ways, and all of them mean: try later
            UNSENT.inc()
            self.broker_accepts, self._no_messages_until = False, time.monotonic() + _BACKOFF_SECONDS
            log.warning("message_unsent", job=id, error=str(error) or type(error).__name__)
            return False
        SENT.inc()
        self.broker_accepts, self._sent[id] = True, now
        return True


def _try(step: Callable[[], None]) -> bool:
    """Run a step and return whether it succeeded; an error is logged and does not end the thread."""
    try:
        step()
    except (SQLAlchemyError, OSError) as error:
        log.error(f"{step.__name__}_failed", error=str(error))
    except Exception:
        log.exception(f"{step.__name__}_failed")
    else:
        return True
    return False


def record_heartbeat(database: Database, worker: str, slots: int) -> None:
    """Increase a worker's heartbeat counter, or add the worker."""
    with database.writing() as session:
        updated = session.execute(
            update(Worker).where(Worker.id == worker).values(beat=Worker.beat + 1, slots=slots).returning(Worker.id)
        ).first()
        if updated is None:
            session.add(Worker(id=worker, slots=slots, beat=1))


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
        models, solves = (_counts(session, table) for table in (ModelRow, SolveRow))
        waiting = (
            select(table.created).where(table.status == "queued").order_by(table.number).limit(1) for table in JOBS
        )
        oldest = min((at for query in waiting if (at := session.scalar(query))), default=None)
        slots = session.scalar(select(func.sum(Worker.slots))) or 0
    return {
        "models_queued": ("Models that are queued.", models.get("queued", 0)),
        "models_running": ("Models that are being grown.", models.get("running", 0)),
        "models_failed": ("Failed models that are kept.", models.get("failed", 0)),
        "models_succeeded": ("Finished models that are kept.", models.get("succeeded", 0)),
        "solves_queued": ("Captures that are queued for their cameras to be found.", solves.get("queued", 0)),
        "solves_running": ("Captures whose cameras are being found.", solves.get("running", 0)),
        "queue_age_seconds": (
            "Time since the oldest queued job was requested, in seconds.",
            max(time.time() - oldest, 0.0) if oldest else 0.0,
        ),
        "worker_slots": ("Jobs that all running workers can do at once.", slots),
    }


def _running(session: Session, worker: str | None = None) -> Iterator[AnyJob]:
    """Yield the running jobs of all tables; those of one worker where it is named."""
    for table in JOBS:
        held: Any = select(table).where(table.status == "running")
        yield from session.scalars(held if worker is None else held.where(table.worker == worker))


def _next_ones(session: Session, wanted: int) -> Iterator[tuple[str, str]]:
    """Yield the ids of the jobs to be done next, each with its task."""
    lines = ([(id, TASKS[table]) for id in session.scalars(_queued(table).limit(wanted))] for table in JOBS)
    in_turns = (job for turn in zip_longest(*lines) for job in turn if job is not None)
    yield from islice(in_turns, wanted)


def _queued(table: type[AnyJob]) -> Any:
    return select(table.id).where(table.status == "queued").order_by(table.number)


def _count(session: Session, table: type[AnyJob], status: str) -> int:
    return session.scalar(select(func.count()).where(table.status == status)) or 0


def _counts(session: Session, table: type[AnyJob]) -> dict[str, int]:
    counted = session.execute(select(table.status, func.count()).group_by(table.status))
    return {status: count for status, count in counted.all()}  # noqa: C416 - rows are no pairs to mypy
