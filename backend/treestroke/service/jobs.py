"""Grow one queued model: claim its row, hold its lease, make the tree, publish it or record why not."""

import json
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

import structlog
from sqlalchemy.exc import SQLAlchemyError

from treestroke.codec.archive import zipped
from treestroke.codec.image import encode_png
from treestroke.codec.inputs import Inputs, SourceName
from treestroke.codec.project import stored_inputs
from treestroke.codec.skeleton import plain_grown
from treestroke.core.errors import TreestrokeError
from treestroke.core.pipeline.grown_tree import LiveTree
from treestroke.service.engine_version import engine_version
from treestroke.service.failures import code_of, problem_of, problem_of_input
from treestroke.service.files import Bundle
from treestroke.service.loading import load_settings
from treestroke.service.model import Options, make_tree
from treestroke.service.progress_estimate import ProgressEstimate
from treestroke.store import queries
from treestroke.store.blobs import Blobs, Damaged
from treestroke.store.database import Database
from treestroke.store.leases import add_file, claim, end, heartbeat, succeed
from treestroke.store.tables import ModelPart, ModelRow

GLB, PREVIEW, GROWTH = "tree.glb", "preview.png", "growth.json"
_BEAT_SECONDS = 2.0
_LOOK_SECONDS = 0.5
log = structlog.get_logger()


@dataclass(frozen=True)
class Assignment:
    """A job for a worker: the model's id, a token of this attempt, the worker's id, and the time limit."""

    model: str
    token: str
    worker: str
    seconds: float


class Canceled(Exception):
    """The person has canceled the model."""


class Superseded(Exception):
    """Another attempt has the job by now."""


class TimeLimit(Exception):
    """The model takes longer than is allowed."""


class Heartbeat:
    """Renews a job's lease from a thread of its own, records its progress, and notices when it is to stop."""

    def __init__(self, database: Database, job: ModelRow, source: SourceName, seconds: float) -> None:
        self._database, self._job = database, job
        self._deadline = time.monotonic() + seconds
        self._estimate = ProgressEstimate(load_settings(job.settings), source)
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
            row = session.get(ModelRow, self._job.number)
            return row is None or row.cancel or row.attempt != self._job.attempt or row.status != "running"
        return False


def grow_model(database: Database, blobs: Blobs, assignment: Assignment) -> None:
    """Grow a model, unless another worker does or did, and publish it whole or not at all."""
    with database.writing() as session:
        job = claim(session, assignment.model, assignment.token, assignment.worker, engine_version())
        parts = {} if job is None else queries.parts(session, [job.id])[job.id]
    if job is None:
        log.info("job_message_ignored", job=assignment.model)
        return
    with structlog.contextvars.bound_contextvars(job=job.id, attempt=job.attempt):
        log.info("job_started")
        try:
            inputs = Inputs.of(parts)
            with Heartbeat(database, job, inputs.source, assignment.seconds) as heartbeat:
                report, files = _make(database, blobs, job, inputs, heartbeat)
            _publish(database, job, report, files)
        except Superseded:
            log.warning("job_superseded")
        except Canceled:
            _end(database, job, "canceled", None)
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


def _make(
    database: Database, blobs: Blobs, job: ModelRow, inputs: Inputs[ModelPart], heartbeat: Heartbeat
) -> tuple[dict[str, Any], dict[str, tuple[str, int]]]:
    """Make the tree and store its files, which are seen only once they are published; return report and files."""
    heartbeat.report("decode", 0.0)
    contents = stored_inputs({name: blobs.get(part.blob) for name, part in inputs.parts.items()})

    def show(grown: LiveTree) -> None:
        content = json.dumps(plain_grown(grown), separators=(",", ":")).encode()
        blob, first = blobs.put(content), {} if job.preview_seq else {"preview_seq": ModelRow.seq + 1}
        with database.writing() as session:
            add_file(session, job, GROWTH, blob, len(content), **first)

    made = make_tree(contents, Options.of(job.settings, job.seed), heartbeat.report, show)
    made = made.with_warnings(_mended_in_photo(database, job))
    heartbeat.report("preview", 0.0)
    trees = _packed(made.bundles)
    outputs = {**trees, PREVIEW: encode_png(made.preview())}
    heartbeat.report("preview", 1.0)
    files = {name: (blobs.put(content), len(content)) for name, content in outputs.items()}
    heartbeat.report("preview", 1.0)
    return {**made.report, "files": {name: len(content) for name, content in trees.items()}}, files


def _mended_in_photo(database: Database, job: ModelRow) -> list[dict[str, Any]]:
    """Return what was mended when the photo was read: its blob holds only the pixels."""
    with database.reading() as session:
        row = None if job.photo is None else queries.photo(session, job.photo, deleted=True)
        return [] if row is None else row.warnings


def _packed(bundles: Mapping[str, Bundle]) -> dict[str, bytes]:
    """Return each bundle as one file: the file itself where there is only one, else a ZIP of all."""
    return {
        name if len(bundle) == 1 else f"{name}.zip": next(iter(bundle.values())) if len(bundle) == 1 else zipped(bundle)
        for name, bundle in bundles.items()
    }


def _publish(database: Database, job: ModelRow, report: dict[str, Any], files: dict[str, tuple[str, int]]) -> None:
    with database.writing() as session:
        published = succeed(session, job, report, files)
        # Not published: it was canceled at the last moment, or another attempt has the job.
        canceled = not published and end(session, job, "canceled", None)
    log.info("job_succeeded" if published else "job_canceled" if canceled else "job_superseded")


def _end(database: Database, job: ModelRow, status: Any, error: dict[str, Any] | None) -> None:
    with database.writing() as session:
        ended = end(session, job, status, error)
    log.info(f"job_{status}" if ended else "job_superseded", code=error["code"] if error else None)
