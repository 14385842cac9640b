"""A worker for tests that is what `treestroke.worker` is, but for jobs whose name says what goes wrong in them.

Run it with `python -m tests.faults.poisoned_worker` beside a service; the product knows nothing of this.
"""

import ctypes
import os
import signal
import sys
import time
from typing import Any, NoReturn

import numpy as np

from treestroke import queue, worker
from treestroke.codec.inputs import Inputs
from treestroke.service import jobs
from treestroke.service.jobs import Heartbeat
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.tables import ModelPart, ModelRow

CHUNK = 64 * 2**20
GRACE_SECONDS = 2
"""The hard limit comes this long after the soft one, so that a test need not wait as long as people do."""
_make, _publish = jobs._make, jobs._publish


def _segfault(_: Heartbeat) -> NoReturn:
    ctypes.string_at(0)
    raise AssertionError


def _memory(_: Heartbeat) -> NoReturn:
    """Take addresses and write nothing there: they are what is limited, and writing 2 GB takes seconds."""
    taken = []
    while True:
        taken.append(np.empty(CHUNK, np.uint8))


def _loop(heartbeat: Heartbeat) -> NoReturn:
    while True:
        heartbeat.report("foliage", 0.5)
        time.sleep(0.01)


def _hang(_: Heartbeat) -> NoReturn:
    while True:
        time.sleep(1)


def _deaf(_: Heartbeat) -> NoReturn:
    """Hold Python's lock, so that nothing else in the process runs, as a library may that never comes back."""
    ctypes.PyDLL(None).sleep(10_000)
    raise AssertionError


def _slow(heartbeat: Heartbeat) -> None:
    for step in range(15):
        heartbeat.report("foliage", step / 15)
        time.sleep(0.2)


_POISONS: dict[str, Any] = {
    "segfault": _segfault,
    "memory": _memory,
    "loop": _loop,
    "hang": _hang,
    "deaf": _deaf,
    "slow": _slow,
}


def _make_or_break(
    database: Database, blobs: Blobs, job: ModelRow, inputs: Inputs[ModelPart], heartbeat: Heartbeat
) -> tuple[dict[str, Any], dict[str, tuple[str, int]]]:
    kind = job.name.partition(" ")[0]
    if kind == "instant":
        heartbeat.report("preview", 1.0)
        return _instant(blobs, job)
    if kind in _POISONS and not (job.attempt > 1 and "at first" in job.name):
        _POISONS[kind](heartbeat)
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


if __name__ == "__main__":
    jobs._make, jobs._publish = _make_or_break, _publish_or_die
    queue._GRACE_SECONDS = GRACE_SECONDS
    sys.exit(worker.main())
