"""One attempt of a job: claim the next row, hold its lease, do the work, publish its result or record why not."""

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType
from typing import Any, Generic, Self, TypeVar

import structlog
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from treestroke.core.errors import TreestrokeError
from treestroke.service.failures import WORTH_WAITING, code_of, problem_of, problem_of_input
from treestroke.service.progress_estimate import ProgressEstimate
from treestroke.store.database import Database
from treestroke.store.leases import Holder, claim_next, end, heartbeat, take_back
from treestroke.store.objects import Damaged
from treestroke.store.tables import AnyJob, JobRow

_BEAT_SECONDS = 2.0
_LOOK_SECONDS = 0.5
_PATIENCE_SECONDS = 60.0
"""How long a job that is done waits for a database that is away: nobody else can take it meanwhile."""
_RETRY_SECONDS = 0.5
Result = TypeVar("Result")
log = structlog.get_logger()


class Canceled(Exception):
    """The person has canceled the job."""


class Superseded(Exception):
    """Another attempt has the job by now."""


class TimeLimit(Exception):
    """The job takes longer than is allowed."""


class AttemptLost(Exception):
    """A process that the work needs died; another attempt may do better."""


class Heartbeat(Generic[JobRow]):
    """Renews a job's lease from a thread of its own, records its progress, and notices when it is to stop."""

    def __init__(self, database: Database, job: JobRow, estimate: ProgressEstimate, seconds: float) -> None:
        self._database, self._estimate = database, estimate
        self._job: JobRow = job
        self._deadline = time.monotonic() + seconds
        self._state: tuple[str | None, float, float] = (None, 0.0, 0.0)
        self._stop_by: type[Exception] | None = None
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="heartbeat", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self._over.set()
        self._thread.join()

    def report(self, phase: str, fraction: float) -> None:
        """Record the progress of the work, and interrupt it where it is to stop.

        Raises
        ------
        Canceled, Superseded, TimeLimit
            The work is to end here.
        """
        if self._stop_by is not None:
            raise self._stop_by
        if time.monotonic() > self._deadline:
            raise TimeLimit
        self._state = phase, fraction, self._estimate.progress(phase, fraction)

    def _run(self) -> None:
        shown, last_beat, pause = self._state, 0.0, 0.0
        while not self._over.wait(pause):
            pause = _LOOK_SECONDS
            if self._state == shown and time.monotonic() - last_beat < _BEAT_SECONDS and not self._is_to_stop():
                continue
            state = self._state
            # A database that is busy or full for a moment costs one beat; the lease outlasts several.
            with suppress(SQLAlchemyError):
                with self._database.autocommitting() as session:
                    stop = heartbeat(session, self._job, *state)
                self._stop_by = {None: Superseded, True: Canceled, False: None}[stop]
                shown, last_beat = state, time.monotonic()

    def _is_to_stop(self) -> bool:
        """Return whether the row says that this attempt must stop."""
        with suppress(SQLAlchemyError), self._database.reading() as session:
            row = session.get(type(self._job), self._job.number)
            return row is None or row.cancel or row.attempt != self._job.attempt or row.status != "running"
        return False


def claim_job(database: Database, holder: Holder, most_running: int) -> AnyJob | None:
    """Claim the job that is next; None if none waits, or if the database cannot say now: the next hint asks again."""
    try:
        with database.writing() as session:
            return claim_next(session, holder, most_running)
    except SQLAlchemyError as error:
        log.error("claim_failed", error=str(error))
        return None


def carry_out(database: Database, job: JobRow, work: Callable[[JobRow], None]) -> None:
    """Do a job that was claimed; ``work`` publishes its result, else why there is none is recorded.

    ``work`` may raise what `Heartbeat.report` raises, and `AttemptLost`.
    """
    with structlog.contextvars.bound_contextvars(job=job.id, attempt=job.attempt):
        log.info("job_started")
        try:
            work(job)
        except Superseded:
            log.warning("job_superseded")
        except Canceled:
            _end(database, job, "canceled", None)
        except AttemptLost as lost:
            log.error("attempt_lost", why=str(lost.__cause__))
            _take_back(database, job)
        except TimeLimit:
            _end(database, job, "failed", problem_of("time_limit"))
        except TreestrokeError as error:
            _end(database, job, "failed", problem_of_input(error))
        except Damaged as error:
            log.error("file_damaged", file=str(error))
            _end(database, job, "failed", problem_of("input_damaged"))
        except SQLAlchemyError as error:
            # Nothing can be written now; the lease runs out, and the job is queued again.
            log.error("database_failed", error=str(error))
        except Exception as error:
            code = code_of(error)
            log.exception("job_broke", code=code)
            _end(database, job, "failed", problem_of(code))


def publish(database: Database, job: AnyJob, succeed: Callable[[Session], bool]) -> None:
    """Publish a job's result by ``succeed``, which returns False where the attempt was taken back or is to stop."""

    def write() -> tuple[bool, bool]:
        with database.writing() as session:
            published = succeed(session)
            # Not published: it was canceled at the last moment, or another attempt has the job.
            return published, not published and end(session, job, "canceled", None)

    published, canceled = persist(write)
    log.info("job_succeeded" if published else "job_canceled" if canceled else "job_superseded")


def persist(use: Callable[[], Result]) -> Result:
    """Use the database, over and over while it is away or busy: the work of minutes is not lost for a restart of it.

    Raises
    ------
    SQLAlchemyError
        It stays away for longer than a job waits, or fails in another way.
    """
    deadline = time.monotonic() + _PATIENCE_SECONDS
    while True:
        try:
            return use()
        except SQLAlchemyError as error:
            if code_of(error) not in WORTH_WAITING or time.monotonic() > deadline:
                raise
            log.warning("database_awaited", error=str(getattr(error, "orig", error)))
        time.sleep(_RETRY_SECONDS)


def _take_back(database: Database, job: JobRow) -> None:
    """Queue a job again, or end it where it has used up its attempts."""
    with database.writing() as session:
        now = session.get(type(job), job.number)
        if now is not None and now.attempt == job.attempt:
            take_back(session, now, problem_of("worker_lost"))


def _end(database: Database, job: AnyJob, status: Any, error: dict[str, Any] | None) -> None:
    def write() -> bool:
        with database.writing() as session:
            return end(session, job, status, error)

    ended = persist(write)
    log.info(f"job_{status}" if ended else "job_superseded", code=error["code"] if error else None)
