"""The worker: a Celery process whose children do jobs; `treestroke serve` runs one, `treestroke worker` too."""

import os
import secrets
import signal
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import structlog
from billiard.exceptions import WorkerLostError
from celery import Celery, Task, signals
from celery.platforms import SecurityWarning  # type: ignore[attr-defined]
from celery.worker import state
from celery.worker.request import Request
from sqlalchemy import select
from sqlalchemy.exc import OperationalError, SQLAlchemyError

from treestroke.logs import start_logging
from treestroke.parent_process import PREVIOUS_RUN_ID, RUN_ID, kill_with_parent, stop_with_parent
from treestroke.queue import DRAIN_SECONDS, EARLIER_TASKS, WORK, Hearing, Hints, hard_limit, make_queue
from treestroke.service.attempts import claim_job
from treestroke.service.dispatch import holds_jobs, record_heartbeat, remove_worker
from treestroke.service.engine_version import engine_version
from treestroke.service.failures import problem_of
from treestroke.service.jobs import grow_model
from treestroke.service.solving import solve_capture
from treestroke.service.tracing_pool import limit_memory
from treestroke.settings import Settings, read_settings
from treestroke.store.blobs import Blobs, open_blobs
from treestroke.store.data_folder import prepare_folder
from treestroke.store.database import Database
from treestroke.store.leases import Holder, end, take_back
from treestroke.store.scope import SERVICE
from treestroke.store.tables import JOBS, AnyJob, ModelRow

NICENESS = 10
"""Growing runs at low priority: tracing has a person waiting for it."""
_HEARTBEAT_SECONDS = 2.0
_LOOK_SECONDS = 2.0
"""How often it is seen whether messages are left waiting."""
_TABLES_SECONDS = 60.0
"""Time that the web process has to make the database's tables."""
_PATIENCE_SECONDS = 120.0
"""Time that a job waits for the place of the blobs to come back, while its lease is held."""
_POLL_SECONDS = 0.2
_IDLE_POLLS = 2
"""A worker that is told to stop ends after finding no running job this often: a child may be about to claim one."""
_BY_ALARM = f"({signal.SIGALRM.name})"
"""Billiard tells by this text that a child was ended by its alarm."""
_no_fork = threading.RLock()
"""Held while a child is forked and while this process uses the database."""
log = structlog.get_logger()


def main() -> int:
    """Run a worker until it is told to stop; return the exit code.

    Raises
    ------
    DataFolderError
        Other users can read the data folder and it may not be the service's alone, or its database is lost or was
        made by a newer treestroke.
    """
    settings = read_settings()
    start_logging()
    stop_with_parent()
    prepare_folder(settings.folder)
    database = Database(settings.folder, settings.database_url).of(SERVICE)
    os.register_at_fork(before=_no_fork.acquire, after_in_parent=_no_fork.release, after_in_child=_no_fork.release)
    if not _wait_for_tables(database):
        log.error("no_database", data=str(settings.folder), mend="start the web process, which makes the tables")
        return 1
    name = os.environ.pop(RUN_ID, "") or secrets.token_hex(12)
    if previous := os.environ.pop(PREVIOUS_RUN_ID, ""):
        with _without_forks(database):
            remove_worker(database, previous, problem_of("worker_lost"))
    engine = engine_version()  # cached before children are forked: it describes the code that all of them loaded
    _run(make_worker(settings, database, name), database, name, engine)
    with suppress(SQLAlchemyError):  # the dispatcher notices the missing heartbeat anyway
        remove_worker(database, name)
    log.info("worker_stopped", worker=name)
    return 0


def _run(app: Celery, database: Database, name: str, engine: str) -> None:
    """Run Celery's worker until it is told to stop, with heartbeats in the database while it runs."""
    slots = app.conf.worker_concurrency
    stopped, hearing = threading.Event(), Hearing(Hints(app))
    arguments = (database, (name, slots, engine), stopped)
    heartbeats = threading.Thread(target=_send_heartbeats, args=arguments, name="heartbeats", daemon=True)
    listening = threading.Thread(
        target=_end_when_deaf, args=(database, name, hearing, stopped), name="listening", daemon=True
    )

    @signals.worker_ready.connect(weak=False)
    def _begin(**_: object) -> None:
        heartbeats.start()
        listening.start()
        log.info("worker_ready", worker=name, slots=slots, engine=engine, process=os.getpid())

    @signals.task_received.connect(weak=False)
    def _hear(**_: object) -> None:
        hearing.heard()

    @signals.worker_shutting_down.connect(weak=False)
    def _end(**_: object) -> None:
        threading.Thread(target=_leave, args=(database, name), name="leaving", daemon=True).start()

    signals.setup_logging.connect(_keep_logging, weak=False)
    # Celery warns of running as root with pickled messages; messages here are JSON and hold nothing.
    warnings.simplefilter("ignore", SecurityWarning)
    app.Worker(
        hostname=f"treestroke@{name}",
        pool_cls="prefork",
        concurrency=slots,
        without_gossip=True,
        without_mingle=True,
        without_heartbeat=True,
        quiet=True,
    ).start()
    stopped.set()


@contextmanager
def _without_forks(database: Database) -> Iterator[Database]:
    """Use the database while no child is forked, and close it afterwards.

    A forked child inherits SQLite's record of its parent's locks: it would wait for ever for a lock that was held at
    that moment, and closing the inherited connection would release the child's own locks.
    """
    with _no_fork:
        try:
            yield database
        finally:
            database.close()


def _leave(database: Database, name: str) -> None:
    """End this process as soon as no job of it is running; a job that takes too long is queued again.

    By then everything that matters is in the database. Celery itself would wait for its processes, or for a broker
    that does not respond. The children notice that their parent has ended.
    """
    deadline, idle = time.monotonic() + DRAIN_SECONDS, 0
    while time.monotonic() < deadline and idle < _IDLE_POLLS:
        time.sleep(_POLL_SECONDS)
        with suppress(SQLAlchemyError), _without_forks(database):
            idle = 0 if holds_jobs(database, name) else idle + 1
    with suppress(SQLAlchemyError), _without_forks(database):
        remove_worker(database, name)
    log.info("worker_stopped", worker=name)
    os._exit(0)


def _keep_logging(**_: object) -> None:
    """Do nothing: a receiver of this signal keeps Celery from replacing the log's configuration."""


def make_worker(settings: Settings, database: Database, worker: str) -> Celery:
    """Return the Celery application with its tasks."""
    app = make_queue(settings)
    stores: list[tuple[Database, Blobs]] = []  # of each child, filled after the fork
    parent = os.getpid()

    @signals.worker_process_init.connect(weak=False)
    def _open(**_: object) -> None:
        kill_with_parent(parent)
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        os.nice(NICENESS)
        limit_memory(settings.memory_mb * 2**20)
        stores[:] = [_stores(settings)]

    class JobRequest(Request):
        """Records in the database, from the parent process, how a child was killed."""

        def on_timeout(self, soft: bool, timeout: float) -> None:
            super().on_timeout(soft, timeout)
            if not soft:
                _record_end(database, self.id, "time_limit")

        def on_failure(self, exc_info: Any, *args: Any, **kwargs: Any) -> Any:
            error = getattr(exc_info.exception, "exc", exc_info.exception)  # billiard wraps it
            if isinstance(error, WorkerLostError):
                _record_end(database, self.id, "time_limit" if _BY_ALARM in str(error) else "worker_lost")
            return super().on_failure(exc_info, *args, **kwargs)

    class Hint(Task):  # type: ignore[type-arg]
        """Do the job that is next; whatever a message holds, it only says that one waits."""

        time_limit = hard_limit(max(settings.model_seconds, settings.solve_seconds))
        Request = JobRequest  # type: ignore[assignment]

        def run(self, *_: object, **__: object) -> None:
            holder = Holder(str(self.request.id), worker, engine_version())
            job = claim_job(stores[0][0], holder, settings.most_running)
            if job is not None:
                _do(*stores[0], job, seconds_of(settings, job))

    for name in (WORK, *EARLIER_TASKS):
        app.register_task(type("Hint", (Hint,), {"name": name})())
    return app


def _stores(settings: Settings) -> tuple[Database, Blobs]:
    """Return the database and the blobs of all teams, for the process that calls this alone."""
    database = Database(settings.folder, settings.database_url).of(SERVICE)
    return database, open_blobs(database, settings.folder, settings.bucket_url, _PATIENCE_SECONDS)


def seconds_of(settings: Settings, job: AnyJob) -> float:
    """Return the time that a job may take."""
    return settings.model_seconds if isinstance(job, ModelRow) else settings.solve_seconds


def _do(database: Database, blobs: Blobs, job: AnyJob, seconds: float) -> None:
    """Do a job; the system ends this process where it takes much longer, even in code that never comes back."""
    signal.setitimer(signal.ITIMER_REAL, hard_limit(seconds))
    try:
        if isinstance(job, ModelRow):
            grow_model(database, blobs, job, seconds)
        else:
            solve_capture(database, blobs, job, seconds)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


def _record_end(database: Database, token: str, code: str) -> None:
    """End the job of a child that was killed at its time limit, or take it back if the child was lost."""
    try:
        with _without_forks(database), database.writing() as session:
            jobs: list[AnyJob] = []
            for table in JOBS:
                held: Any = select(table).where(table.claim == token, table.status == "running")
                jobs += session.scalars(held)
            job = next(iter(jobs), None)
            if job is not None and code == "time_limit":
                end(session, job, "failed", problem_of(code))
            elif job is not None:
                # A pool that is being stopped kills its children; that is not an error of the job.
                take_back(session, job, None if state.should_stop is not None else problem_of(code))
    except SQLAlchemyError as error:
        log.error("end_not_recorded", token=token, code=code, error=str(error))
    else:
        log.warning("child_lost", job=job.id if job else None, code=code)


def _send_heartbeats(database: Database, worker: tuple[str, int, str], stopped: threading.Event) -> None:
    while not stopped.is_set():
        try:
            with _without_forks(database):
                record_heartbeat(database, *worker)
        except SQLAlchemyError as error:
            log.warning("heartbeat_missed", error=str(error))
        stopped.wait(_HEARTBEAT_SECONDS)


def _end_when_deaf(database: Database, name: str, hearing: Hearing, stopped: threading.Event) -> None:
    """End this process where it has stopped taking messages; whatever started it starts it again."""

    def idle() -> bool:
        with _without_forks(database):
            return not holds_jobs(database, name)

    while not stopped.wait(_LOOK_SECONDS):
        with suppress(SQLAlchemyError):
            if hearing.is_deaf(idle):
                log.error("worker_deaf", worker=name, mend="nothing: it ends, and is started again")
                with _without_forks(database):
                    remove_worker(database, name)
                os._exit(1)


def _wait_for_tables(database: Database) -> bool:
    """Wait until the database has the tables of this program; False if they are not there in time."""
    deadline = time.monotonic() + _TABLES_SECONDS
    while time.monotonic() < deadline:
        with suppress(OperationalError), _without_forks(database):  # Postgres may come later than the worker
            database.check()
            if database.current():
                return True
        time.sleep(_POLL_SECONDS)
    return False


if __name__ == "__main__":
    sys.exit(main())
