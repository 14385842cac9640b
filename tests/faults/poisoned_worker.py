"""A worker for tests that is what `treestroke.worker` is, but for jobs whose name says what happens to them.

The first word of a name is one of `_POISONS`, for the first attempt alone with "at first"; a name with "instant" stands
for small files instead of a tree. `tests.faults.poisoned_serve` runs it; the product knows nothing of this.
"""

import ctypes
import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from celery import signals
from celery.worker.consumer import Consumer
from tests.faults.held import released

from treestroke import queue, worker
from treestroke.codec.inputs import Inputs
from treestroke.service import jobs
from treestroke.service.attempts import Heartbeat
from treestroke.settings import Settings
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.tables import AnyJob, ModelPart, ModelRow

CHUNK = 64 * 2**20
DEAF_LOOKS = 2
"""A worker that falls deaf ends after so few looks."""
GRACE_SECONDS = 2
"""The hard limit comes this long after the soft one, so that a test need not wait as long as people do."""
LIMITED = ("loop", "hang", "deaf")
"""Jobs that run into the service's limit, which a test sets low."""
PATIENT_SECONDS = 600.0
"""The limit of all others: they must end well on a busy machine too."""
_make, _publish = jobs._make, jobs._publish


def _segfault(*_: object) -> NoReturn:
    ctypes.string_at(0)
    raise AssertionError


def _memory(*_: object) -> NoReturn:
    """Take addresses and write nothing there: they are what is limited, and writing 2 GB takes seconds."""
    taken = []
    while True:
        taken.append(np.empty(CHUNK, np.uint8))


def _loop(heartbeat: Heartbeat, *_: object) -> NoReturn:
    while True:
        heartbeat.report("foliage", 0.5)
        time.sleep(0.01)


def _hang(*_: object) -> NoReturn:
    while True:
        time.sleep(1)


def _deaf(*_: object) -> NoReturn:
    """Hold Python's lock, so that nothing else in the process runs, as a library may that never comes back."""
    ctypes.PyDLL(None).sleep(10_000)
    raise AssertionError


def _held(heartbeat: Heartbeat, release: Path) -> None:
    """Be under way until the test has seen what it wants to see."""
    while not release.exists():
        heartbeat.report("foliage", 0.5)
        time.sleep(0.01)


_POISONS: dict[str, Callable[[Heartbeat, Path], None]] = {
    "segfault": _segfault,
    "memory": _memory,
    "loop": _loop,
    "hang": _hang,
    "deaf": _deaf,
    "held": _held,
}


def _make_or_break(
    database: Database, blobs: Blobs, job: ModelRow, inputs: Inputs[ModelPart], heartbeat: Heartbeat
) -> tuple[dict[str, Any], dict[str, tuple[str, int]]]:
    words = job.name.split()
    if words and words[0] in _POISONS and not (job.attempt > 1 and "at first" in job.name):
        _POISONS[words[0]](heartbeat, released(database.path.parent, job.id))
    if "instant" in words:
        heartbeat.report("preview", 1.0)
        return _instant(blobs, job)
    return _make(database, blobs, job, inputs, heartbeat)


def _instant(blobs: Blobs, job: ModelRow) -> tuple[dict[str, Any], dict[str, tuple[str, int]]]:
    """Make three small files instead of a tree: for what is not about trees, and is tried a hundred times."""
    content = job.id.encode()
    files = {name: (blobs.put(content + name.encode()), len(content)) for name in (jobs.GLB, jobs.PREVIEW, jobs.GROWTH)}
    return {"score": {}}, files


def _publish_or_die(
    database: Database, job: ModelRow, report: dict[str, Any], files: dict[str, tuple[str, int]]
) -> None:
    first = job.attempt == 1
    if first and job.name == "dies before the commit":
        os.kill(os.getpid(), signal.SIGKILL)
    _publish(database, job, report, files)
    if first and job.name == "dies after the commit":
        os.kill(os.getpid(), signal.SIGKILL)


def _patient_seconds(settings: Settings, job: AnyJob) -> float:
    return settings.model_seconds if isinstance(job, ModelRow) and job.name in LIMITED else PATIENT_SECONDS


@signals.worker_ready.connect(weak=False)
def _obey(sender: Consumer, **_: object) -> None:
    """Take no message any more once SIGUSR2 comes, as happened to workers whose connection was lost and made again."""

    def fall_deaf(*_: object) -> None:
        queue._DEAF_LOOKS = DEAF_LOOKS
        sender.task_consumer.cancel()

    signal.signal(signal.SIGUSR2, fall_deaf)


if __name__ == "__main__":
    jobs._make, jobs._publish, worker.seconds_of = _make_or_break, _publish_or_die, _patient_seconds
    queue._GRACE_SECONDS = GRACE_SECONDS
    sys.exit(worker.main())
