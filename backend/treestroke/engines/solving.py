"""Structure from motion in a process of its own, bounded in time and memory: COLMAP may crash or take too long.

This process does not import pycolmap: its zlib would stand in for OpenCV's where it comes first, and PNG files break.
"""

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any, Literal, NamedTuple

import cv2

from treestroke.core.capture import CapturedPhoto, Structure
from treestroke.core.progress import Report, silent


class SolveBounds(NamedTuple):
    """What a solve may take: seconds, and bytes of address space."""

    seconds: float
    memory: int


class SolveEnded(Exception):
    """The process ended before it had a result.

    Attributes
    ----------
    why
        It took too long (``slow``), ran out of memory (``memory``) or died (``crash``).
    """

    def __init__(self, why: Literal["slow", "memory", "crash"]) -> None:
        super().__init__(
            {
                "slow": "finding the cameras took too long; give fewer photos",
                "memory": "finding the cameras ran out of memory; give fewer photos",
                "crash": "the process that finds the cameras died",
            }[why]
        )
        self.why = why


def solve_in_process(photos: Sequence[CapturedPhoto], bounds: SolveBounds, report: Report = silent) -> Structure:
    """Do what `treestroke.engines.structure.solve` does in a process of its own, and end it whatever happens.

    An exception that ``report`` raises ends the work; with this process the other one ends too.

    Raises
    ------
    CaptureError
        As `solve` does.
    SolveEnded
        The process took too long, ran out of memory or died.
    """
    ours, theirs = Pipe()
    with ours:
        with theirs:  # closed in this process, so that the other's end is noticed
            process = _start(theirs.fileno(), bounds.memory)
        try:
            return _result(ours, photos, bounds.seconds, report)
        except (EOFError, ConnectionError) as lost:
            raise SolveEnded("crash") from lost
        finally:
            process.kill()
            process.wait()


def _start(pipe: int, memory: int) -> "subprocess.Popen[bytes]":
    """Start the other process at the end of a pipe, a file's number.

    `multiprocessing` would run the caller's own script there once more, which must be written for that.
    """
    code = f"from treestroke.engines.solving import work; work({pipe}, {memory})"
    paths = os.pathsep.join(path or os.curdir for path in sys.path)
    environment = {**os.environ, "PYTHONPATH": paths}
    return subprocess.Popen([sys.executable, "-P", "-c", code], pass_fds=(pipe,), env=environment)


def _result(connection: Connection, photos: Sequence[CapturedPhoto], seconds: float, report: Report) -> Structure:
    """Return what the process at the other end finds."""
    deadline = time.monotonic() + seconds
    connection.send(photos)
    while connection.poll(max(deadline - time.monotonic(), 0.0)):
        message = connection.recv()
        if isinstance(message, Structure):
            return message
        if isinstance(message, MemoryError):
            raise SolveEnded("memory") from message
        if isinstance(message, Exception):
            raise message
        report(*message)
    raise SolveEnded("slow")


def work(pipe: int, memory: int) -> None:
    """Solve, in at most so many bytes of memory, the photos that arrive by a pipe, a file's number.

    A report fails, and ends this process, once the parent is gone.
    """
    connection: Connection[Any, Any] = Connection(pipe)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is handled by the parent
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    memory = memory if most == resource.RLIM_INFINITY else min(memory, most)  # a worker's own limit holds here, too
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    from treestroke.engines.structure import solve

    with suppress(EOFError, ConnectionError):
        outcome: Structure | Exception
        try:
            outcome = solve(connection.recv(), lambda stage, fraction: connection.send((stage, fraction)))
        except ConnectionError:
            raise
        except Exception as error:  # noqa: BLE001 - any error is raised again in the parent
            short = isinstance(error, cv2.error) and error.code == cv2.Error.StsNoMem
            outcome = MemoryError() if short else error
        connection.send(outcome)
