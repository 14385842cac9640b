"""The worker: a Celery process whose children grow models; `treestroke serve` runs one, `treestroke worker` too."""

import os
import secrets
import socket
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
from sqlalchemy.exc import SQLAlchemyError

from treestroke.logs import start_logging
from treestroke.parent_process import PREVIOUS_RUN_ID, RUN_ID, kill_with_parent, stop_with_parent
from treestroke.queue import DRAIN_SECONDS, TASK, make_queue
from treestroke.service.dispatch import holds_jobs, record_heartbeat, remove_worker
from treestroke.service.engine_version import engine_version
from treestroke.service.failures import problem_of
from treestroke.service.jobs import Hint, grow_model
from treestroke.service.tracing_pool import limit_memory
from treestroke.settings import Settings, read_settings
from treestroke.store.blobs import Blobs
from treestroke.store.data_folder import check_version, prepare_folder
from treestroke.store.database import Database
from treestroke.store.leases import end, take_back
from treestroke.store.tables import ModelRow

NICENESS = 10
"""Growing gives way to tracing, which somebody waits for with the pen in hand."""
_BEAT_SECONDS = 2.0
_SCHEMA_SECONDS = 60.0
_LOOK_SECONDS = 0.2
_IDLE_LOOKS = 2
"""So often nothing must be under way before a worker leaves: a child may be about to take what it was given."""
_unforked = threading.RLock()
log = structlog.get_logger()


def main() -> int:
    """Run a worker until it is told to stop.

    Raises
    ------
    DataFolderError
        The data folder is open to others and not plainly ours, or its database is lost or a newer program's.
    """
    settings = read_settings()
    start_logging()
    stop_with_parent()
    prepare_folder(settings.folder)
    database = Database(settings.folder)
    os.register_at_fork(before=_unforked.acquire, after_in_parent=_unforked.release, after_in_child=_unforked.release)
    if not _wait_for_tables(database):
        log.error("no_database", data=str(settings.folder), mend="start the web process, which makes the tables")
        return 1
    name = os.environ.pop(RUN_ID, "") or secrets.token_hex(12)
    if before := os.environ.pop(PREVIOUS_RUN_ID, ""):
        with _briefly(database):
            remove_worker(database, before, problem_of("worker_lost"))
    grown_by = engine_version()  # before any child is forked: it is that of the code which all of them have loaded
    app = make_worker(settings, database, name)
    signals.setup_logging.connect(_keep_logging, weak=False)
    # Running as root is the container's or the person's choice; messages are JSON and hold an id.
    warnings.simplefilter("ignore", SecurityWarning)
    slots = app.conf.worker_concurrency
    stopped = threading.Event()
    beats = threading.Thread(target=_beat, args=(database, name, slots, stopped), name="beats", daemon=True)

    @signals.worker_ready.connect(weak=False)
    def _begin(**_: object) -> None:
        beats.start()
        log.info("worker_ready", worker=name, slots=slots, engine=grown_by, process=os.getpid())

    @signals.worker_shutting_down.connect(weak=False)
    def _end(**_: object) -> None:
        threading.Thread(target=_leave, args=(database, name), name="leaving", daemon=True).start()

    app.Worker(
        hostname=f"treestroke@{socket.gethostname()}",
        pool_cls="prefork",
        concurrency=slots,
        without_gossip=True,
        without_mingle=True,
        without_heartbeat=True,
        quiet=True,
    ).start()
    stopped.set()
    with suppress(SQLAlchemyError):  # others find out by themselves
        remove_worker(database, name)
    log.info("worker_stopped", worker=name)
    return 0


@contextmanager
def _briefly(database: Database) -> Iterator[Database]:
    """Use the database while no child is being forked, and close it again.

    A child inherits what SQLite knows of the locks of its parent's connections: it would wait for ever for one that
    was held at that moment, and would lose its own when the inherited connection is closed.
    """
    with _unforked:
        try:
            yield database
        finally:
            database.close()


def _leave(database: Database, name: str) -> None:
    """End a worker that is told to stop, as soon as nothing is being grown; what takes too long queues again.

    All that matters is in the database by then. Celery would wait for its own processes, or for a broker that does
    not answer. The children see that their parent is gone.
    """
    deadline, idle = time.monotonic() + DRAIN_SECONDS, 0
    while time.monotonic() < deadline and idle < _IDLE_LOOKS:
        time.sleep(_LOOK_SECONDS)
        with suppress(SQLAlchemyError), _briefly(database):
            idle = 0 if holds_jobs(database, name) else idle + 1
    with suppress(SQLAlchemyError), _briefly(database):
        remove_worker(database, name)
    log.info("worker_stopped", worker=name)
    os._exit(0)


def _keep_logging(**_: object) -> None:
    """Stand in for Celery's own set-up of the log, which would replace ours."""


def make_worker(settings: Settings, database: Database, name: str) -> Celery:
    """Make the Celery application with its one task."""
    app = make_queue(settings)
    opened: list[tuple[Database, Blobs]] = []
    parent = os.getpid()

    @signals.worker_process_init.connect(weak=False)
    def _open(**_: object) -> None:
        kill_with_parent(parent)
        os.nice(NICENESS)
        limit_memory(settings.memory_mb * 2**20)
        opened[:] = [(Database(settings.folder), Blobs(settings.folder))]

    class JobRequest(Request):
        """Hears from the parent process what a child cannot say any more."""

        def on_timeout(self, soft: bool, timeout: float) -> None:
            super().on_timeout(soft, timeout)
            if not soft:
                _close(database, self.id, "time_limit")

        def on_failure(self, exc_info: Any, *args: Any, **kwargs: Any) -> Any:
            error = exc_info.exception
            if isinstance(getattr(error, "exc", error), WorkerLostError):  # billiard wraps what it reports
                _close(database, self.id, "worker_lost")
            return super().on_failure(exc_info, *args, **kwargs)

    class Grow(Task):  # type: ignore[type-arg]
        """Grow the model that a message names."""

        name = TASK
        Request = JobRequest  # type: ignore[assignment]

        def run(self, model: str) -> None:
            hint = Hint(model, str(self.request.id), name_of_worker, settings.model_seconds)
            grow_model(*opened[0], hint)

    name_of_worker = name
    app.register_task(Grow())
    return app


def _close(database: Database, token: str, code: str) -> None:
    """End or give back what a child held when it was killed."""
    try:
        with _briefly(database), database.writing() as session:
            job = session.scalars(select(ModelRow).where(ModelRow.claim == token, ModelRow.status == "running")).first()
            if job is not None and code == "time_limit":
                end(session, job, "failed", problem_of(code))
            elif job is not None:
                # A pool that is being stopped kills its children before long; that is no fault of theirs.
                take_back(session, job, None if state.should_stop is not None else problem_of(code))
    except SQLAlchemyError as error:
        log.error("not_closed", token=token, code=code, error=str(error))
    else:
        log.warning("child_lost", job=job.id if job else None, code=code)


def _beat(database: Database, name: str, slots: int, stopped: threading.Event) -> None:
    while not stopped.is_set():
        try:
            with _briefly(database):
                record_heartbeat(database, name, slots)
        except SQLAlchemyError as error:
            log.warning("beat_missed", error=str(error))
        stopped.wait(_BEAT_SECONDS)


def _wait_for_tables(database: Database) -> bool:
    deadline = time.monotonic() + _SCHEMA_SECONDS
    while time.monotonic() < deadline:
        with _briefly(database):
            check_version(database.path.parent)
            if database.path.exists() and database.current():
                return True
        time.sleep(0.2)
    return False


if __name__ == "__main__":
    sys.exit(main())
