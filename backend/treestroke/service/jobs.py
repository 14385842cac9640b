"""Grow one queued model: claim the row, keep its lease, make the tree, publish it or say why not."""

import json
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from types import TracebackType
from typing import Any, Self

import structlog
from sqlalchemy.exc import SQLAlchemyError

from treestroke.codec.archive import zipped
from treestroke.codec.image import encode_png
from treestroke.codec.skeleton import plain_grown
from treestroke.core.errors import TreestrokeError
from treestroke.core.pipeline.grown_tree import LiveTree
from treestroke.service.engine_version import engine_version
from treestroke.service.evidence import Evidence, make_of
from treestroke.service.failures import code_of, problem_of, problem_of_input
from treestroke.service.files import Bundle
from treestroke.service.inputs import load_settings
from treestroke.service.models import project_from
from treestroke.service.progress_estimate import ProgressEstimate
from treestroke.store import queries
from treestroke.store.blobs import Blobs, Damaged
from treestroke.store.database import Database
from treestroke.store.leases import add_file, claim, end, heartbeat, succeed
from treestroke.store.tables import ModelRow

GLB, PREVIEW, GROWTH = "tree.glb", "preview.png", "growth.json"
_BEAT_SECONDS = 2.0
_LISTEN_SECONDS = 0.5
log = structlog.get_logger()


class Stop(Exception):
    """The person does not want the model any more."""


class Superseded(Exception):
    """Another attempt has the job now."""


class TimeLimit(Exception):
    """The model takes longer than is allowed."""


class Pulse:
    """Keeps a job's lease from a thread of its own, passes its progress on, and hears when it is to stop."""

    def __init__(self, database: Database, job: ModelRow, seconds: float) -> None:
        self._database, self._job = database, job
        self._deadline = time.monotonic() + seconds
        self._course = ProgressEstimate(load_settings(job.settings), of_sketches="front" in job.parts)
        self._state: tuple[str | None, float, float] = (None, 0.0, 0.0)
        self._order: type[Exception] | None = None
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, name="pulse", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self._over.set()
        self._thread.join()

    def report(self, phase: str, fraction: float) -> None:
        """Take the progress of the work, and interrupt it where it is to stop.

        Raises
        ------
        Stop, Superseded, TimeLimit
            The work is to end here.
        """
        if self._order is not None:
            raise self._order
        if time.monotonic() > self._deadline:
            raise TimeLimit
        self._state = phase, fraction, self._course.progress(phase, fraction)

    def _run(self) -> None:
        shown, beaten, pause = self._state, 0.0, 0.0
        while not self._over.wait(pause):
            pause = _LISTEN_SECONDS
            if self._state == shown and time.monotonic() - beaten < _BEAT_SECONDS and not self._listen():
                continue
            state = self._state
            # A database that is busy or full for a moment costs one beat; the lease outlasts several.
            with suppress(SQLAlchemyError):
                with self._database.autocommitting() as session:
                    stop = heartbeat(session, self._job, *state)
                self._order = {None: Superseded, True: Stop, False: None}[stop]
                shown, beaten = state, time.monotonic()

    def _listen(self) -> bool:
        """Tell whether the row says anything else than to go on."""
        with suppress(SQLAlchemyError), self._database.reading() as session:
            row = session.get(ModelRow, self._job.number)
            return row is None or row.cancel or row.attempt != self._job.attempt or row.status != "running"
        return False


def grow_model(database: Database, blobs: Blobs, id: str, token: str, worker: str, seconds: float) -> None:
    """Grow the model that a hint names, unless somebody else does or did, and publish it whole or not at all."""
    with database.writing() as session:
        job = claim(session, id, token, worker, engine_version())
    if job is None:
        log.info("hint_ignored", job=id)
        return
    with structlog.contextvars.bound_contextvars(job=id, attempt=job.attempt):
        log.info("job_started")
        try:
            with Pulse(database, job, seconds) as pulse:
                report, files = _make(database, blobs, job, pulse)
            _publish(database, job, report, files)
        except Superseded:
            log.warning("job_superseded")
        except Stop:
            _end(database, job, "canceled", None)
        except TimeLimit:
            _end(database, job, "failed", problem_of("time_limit"))
        except TreestrokeError as error:
            _end(database, job, "failed", problem_of_input(error))
        except Damaged as error:
            log.error("file_damaged", file=str(error))
            _end(database, job, "failed", problem_of("input_damaged"))
        except SQLAlchemyError as error:
            # Nothing can be written down now; the lease runs out, and the job is taken up again.
            log.error("database_failed", error=str(error))
        except Exception as error:
            code = code_of(error)
            log.exception("job_broke", code=code)
            _end(database, job, "failed", problem_of(code))


def _make(
    database: Database, blobs: Blobs, job: ModelRow, pulse: Pulse
) -> tuple[dict[str, Any], dict[str, tuple[str, int]]]:
    """Make the tree and store its files; nobody sees them before they are published."""
    pulse.report("decode", 0.0)
    given = Evidence.of(project_from(blobs, job))

    def show(grown: LiveTree) -> None:
        content = json.dumps(plain_grown(grown), separators=(",", ":")).encode()
        blob, first = blobs.put(content), {} if job.preview_seq else {"preview_seq": ModelRow.seq + 1}
        with database.writing() as session:
            add_file(session, job, GROWTH, blob, len(content), **first)

    made = make_of(given, job.settings, job.seed, pulse.report, show).with_warnings(_mended_in_photo(database, job))
    pulse.report("preview", 0.0)
    trees = _packed(made.bundles)
    contents = {**trees, PREVIEW: encode_png(made.preview())}
    pulse.report("preview", 1.0)
    files = {name: (blobs.put(content), len(content)) for name, content in contents.items()}
    pulse.report("preview", 1.0)
    return {**made.report, "files": {name: len(content) for name, content in trees.items()}}, files


def _mended_in_photo(database: Database, job: ModelRow) -> list[dict[str, Any]]:
    """Look up what was mended in reading the photo, of which only the pixels are stored."""
    with database.reading() as session:
        row = None if job.photo is None else queries.photo(session, job.photo, deleted=True)
        return [] if row is None else row.warnings


def _packed(bundles: Mapping[str, Bundle]) -> dict[str, bytes]:
    """Give each bundle as one file: what is one already, else a ZIP."""
    return {
        name if len(bundle) == 1 else f"{name}.zip": next(iter(bundle.values())) if len(bundle) == 1 else zipped(bundle)
        for name, bundle in bundles.items()
    }


def _publish(database: Database, job: ModelRow, report: dict[str, Any], files: dict[str, tuple[str, int]]) -> None:
    with database.writing() as session:
        published = succeed(session, job, report, files)
        # Not published: it was to be stopped at the last moment, or another attempt has the job.
        canceled = not published and end(session, job, "canceled", None)
    log.info("job_succeeded" if published else "job_canceled" if canceled else "job_superseded")


def _end(database: Database, job: ModelRow, status: Any, error: dict[str, Any] | None) -> None:
    with database.writing() as session:
        ended = end(session, job, status, error)
    log.info(f"job_{status}" if ended else "job_superseded", code=error["code"] if error else None)
