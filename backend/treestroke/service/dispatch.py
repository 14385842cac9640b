"""The dispatcher: tells workers of jobs that wait, takes back the jobs of workers that are gone, and sweeps.

Leases are judged by the change of a row's ``beat`` as this process sees it on its own monotonic clock. No two
machines need agree on the time, and a clock that jumps expires nothing.
"""

import threading
import time
from collections.abc import Callable, Hashable, Iterable
from dataclasses import asdict
from typing import Any, Generic, TypeVar

import structlog
from prometheus_client import Counter
from sqlalchemy import delete, func, select, update
from sqlalchemy.exc import SQLAlchemyError

from treestroke.service.failures import problem_of
from treestroke.service.retention import Sweeper
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.leases import take_back
from treestroke.store.tables import ModelRow, Worker

LEASE_SECONDS = 10.0
RESEND_SECONDS = 5.0
_TICK_SECONDS = 0.5
_BACKOFF_SECONDS = 2.0
_SWEEP_SECONDS = 600.0
_OVERDUE_SECONDS = 30.0
"""Jobs wait for a dispatcher that has not done all its work once within this."""
_UNKNOWN_SLOTS = 2
"""Hints that are sent where no worker has spoken yet: one may be about to start."""
LOST = Counter("treestroke_attempts_lost", "Attempts whose lease ran out.")
SENT = Counter("treestroke_hints_sent", "Messages to the queue.")
UNSENT = Counter("treestroke_hints_unsent", "Messages that the broker did not take.")
Key = TypeVar("Key", bound=Hashable)
log = structlog.get_logger()


class StallDetector(Generic[Key]):
    """For how long each of some counters has stood still, by this process's monotonic clock."""

    def __init__(self) -> None:
        self._seen: dict[Key, tuple[int, float]] = {}

    def stalled(self, counters: Iterable[tuple[Key, int]], seconds: float) -> set[Key]:
        """Take all counters that there are now; give the keys of those that stood still for ``seconds``."""
        now = time.monotonic()
        before, self._seen = self._seen, {}
        for key, count in counters:
            known = before.get(key)
            self._seen[key] = known if known is not None and known[0] == count else (count, now)
        return {key for key, (_, since) in self._seen.items() if now - since >= seconds}


class Dispatcher:
    """A thread beside the web server; it holds nothing that another cannot find again in the database."""

    def __init__(self, database: Database, blobs: Blobs, send: Callable[[str], None], keep_days: float) -> None:
        self._database, self._send = database, send
        self._jobs, self._workers = StallDetector[tuple[str, int]](), StallDetector[str]()
        self._sent: dict[str, float] = {}
        self._wake, self._stopped = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, name="dispatcher", daemon=True)
        self._well_at = time.monotonic()
        self._sweeper = Sweeper(database, blobs, keep_days, self._stopped)
        self._sweeping = threading.Thread(target=self._sweep, name="sweeper", daemon=True)
        self._quiet_until = 0.0
        self.broker_takes = True

    def start(self) -> None:
        """Begin."""
        self._thread.start()
        self._sweeping.start()

    @property
    def state(self) -> str:
        """Say "ok", or what is wrong with it."""
        if not self._thread.is_alive():
            return "does not run; jobs wait until the service is started anew"
        silent_s = time.monotonic() - self._well_at
        return (
            "ok" if silent_s < _OVERDUE_SECONDS else f"has not finished a round for {silent_s:.0f} s; its log says why"
        )

    def notify(self) -> None:
        """Look at the queue now: something has changed."""
        self._wake.set()

    def stop(self) -> None:
        """End; jobs that wait stay rows and are found by the next one."""
        self._stopped.set()
        self._wake.set()
        for thread in (self._thread, self._sweeping):
            thread.join(timeout=_TICK_SECONDS)

    def _run(self) -> None:
        while not self._stopped.is_set():
            # Each has its turn, whatever became of the others.
            done = [_tried(step) for step in (self.recover, self.dispatch)]
            if all(done):
                self._well_at = time.monotonic()
            else:
                self._stopped.wait(_BACKOFF_SECONDS)
            self._wake.wait(_TICK_SECONDS)
            self._wake.clear()

    def recover(self) -> None:
        """Take back the jobs whose worker has not beaten for a lease, and forget workers that are silent."""
        with self._database.reading() as session:
            jobs = {job.id: job for job in session.scalars(select(ModelRow).where(ModelRow.status == "running"))}
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
        """Tell the workers of the jobs that are next, as many as they have hands for and one more each."""
        if time.monotonic() < self._quiet_until:
            return
        with self._database.reading() as session:
            slots = session.scalar(select(func.sum(Worker.slots))) or 0
            running = session.scalar(select(func.count()).where(ModelRow.status == "running")) or 0
            wanted = max(2 * slots - running, 0) if slots else _UNKNOWN_SLOTS
            queued = select(ModelRow.id).where(ModelRow.status == "queued").order_by(ModelRow.number).limit(wanted)
            next_ones = session.scalars(queued).all()
        now = time.monotonic()
        self._sent = {id: at for id, at in self._sent.items() if id in next_ones}
        for id in next_ones:
            # Where no worker lives one message is enough: more would only pile up until one comes.
            due = id not in self._sent or (slots and now - self._sent[id] >= RESEND_SECONDS)
            if due and not self._tell(id, now):
                return

    def sweep(self) -> None:
        """Remove what is to go."""
        log.info("swept", **asdict(self._sweeper.sweep()))

    def _sweep(self) -> None:
        """Sweep now and then, beside the dispatching: it may take a while."""
        while not self._stopped.is_set():
            _tried(self.sweep)
            self._stopped.wait(_SWEEP_SECONDS)

    def _tell(self, id: str, now: float) -> bool:
        try:
            self._send(id)
        except Exception as error:  # noqa: BLE001 - a broker fails in many ways; each means the same: later
            UNSENT.inc()
            self.broker_takes, self._quiet_until = False, time.monotonic() + _BACKOFF_SECONDS
            log.warning("hint_unsent", job=id, error=str(error) or type(error).__name__)
            return False
        SENT.inc()
        self.broker_takes, self._sent[id] = True, now
        return True


def _tried(step: Callable[[], None]) -> bool:
    """Take one of the dispatcher's steps; nothing that fails in it ends its thread."""
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
    """Write down that a worker lives."""
    with database.writing() as session:
        beaten = session.execute(
            update(Worker).where(Worker.id == worker).values(beat=Worker.beat + 1, slots=slots).returning(Worker.id)
        ).first()
        if beaten is None:
            session.add(Worker(id=worker, slots=slots, beat=1))


def holds_jobs(database: Database, worker: str) -> bool:
    """Tell whether a worker has jobs under way."""
    with database.reading() as session:
        held = select(ModelRow.id).where(ModelRow.status == "running", ModelRow.worker == worker).limit(1)
        return session.scalar(held) is not None


def remove_worker(database: Database, worker: str, error: dict[str, Any] | None = None) -> None:
    """Write down that a worker stops, or by what ``error`` it ended: what it still held queues again at once."""
    with database.writing() as session:
        session.execute(delete(Worker).where(Worker.id == worker))
        for job in session.scalars(
            select(ModelRow).where(ModelRow.status == "running", ModelRow.worker == worker)
        ).all():
            take_back(session, job, error)


def queue_figures(database: Database) -> dict[str, tuple[str, float]]:
    """Give the queue's figures by name, each with what it means."""
    with database.reading() as session:
        counts = dict(session.execute(select(ModelRow.status, func.count()).group_by(ModelRow.status)).tuples().all())
        queued = select(ModelRow.created).where(ModelRow.status == "queued").order_by(ModelRow.number).limit(1)
        oldest = session.scalar(queued)
        slots = session.scalar(select(func.sum(Worker.slots))) or 0
    return {
        "models_queued": ("Models that wait.", counts.get("queued", 0)),
        "models_running": ("Models that are being grown.", counts.get("running", 0)),
        "models_failed": ("Models that failed and are kept.", counts.get("failed", 0)),
        "models_succeeded": ("Models that are kept.", counts.get("succeeded", 0)),
        "queue_age_seconds": (
            "How long the oldest queued model waits.",
            max(time.time() - oldest, 0.0) if oldest else 0.0,
        ),
        "worker_slots": ("Models that the workers alive grow at once.", slots),
    }
