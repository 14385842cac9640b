"""A function in a process of its own, bounded in time and memory: libraries in C may crash or take too long."""

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any, Literal, NamedTuple, TypeVar

import cv2

from treestroke.core.progress import Report

T = TypeVar("T")
Work = Callable[..., T]


class Bounds(NamedTuple):
    """What a process may take: seconds, and bytes of address space."""

    seconds: float
    memory: int


class ChildEnded(Exception):
    """The process ended before it had a result: it was too slow, ran out of memory, or died."""

    def __init__(self, why: Literal["slow", "memory", "crash"]) -> None:
        super().__init__(why)
        self.why = why


class _Result(NamedTuple):
    """What the function returned, or the exception that it raised."""

    value: Any
    error: Exception | None = None


def call_in_child(work: str, arguments: tuple[Any, ...], bounds: Bounds, report: Report) -> Any:
    """Return what a function returns in a process of its own, which is ended whatever happens.

    ``work`` is ``module:function``, which takes the arguments and then a `Report`. An exception that ``report`` raises
    ends the work; with this process the other one ends too.

    Raises
    ------
    Exception
        Whatever the function raises.
    ChildEnded
        The process took too long, ran out of memory or died.
    """
    ours, theirs = Pipe()
    with ours:
        with theirs:  # closed in this process, so that the other's end is noticed
            process = _start(theirs.fileno(), work, bounds.memory)
        try:
            return _result(ours, arguments, bounds.seconds, report)
        except (EOFError, ConnectionError) as lost:
            raise ChildEnded("crash") from lost
        finally:
            process.kill()
            process.wait()


def _start(pipe: int, work: str, memory: int) -> "subprocess.Popen[bytes]":
    """Start the other process at the end of a pipe, a file's number.

    `multiprocessing` would run the caller's own script there once more, which must be written for that.
    """
    code = f"from treestroke.engines.child import serve; serve({pipe}, {work!r}, {memory})"
    paths = os.pathsep.join(path or os.curdir for path in sys.path)
    environment = {**os.environ, "PYTHONPATH": paths}
    return subprocess.Popen([sys.executable, "-P", "-c", code], pass_fds=(pipe,), env=environment)


def _result(connection: Connection, arguments: tuple[Any, ...], seconds: float, report: Report) -> Any:
    """Return what the process at the other end finds."""
    deadline = time.monotonic() + seconds
    connection.send(arguments)
    while connection.poll(max(deadline - time.monotonic(), 0.0)):
        message = connection.recv()
        if not isinstance(message, _Result):
            report(*message)
        elif isinstance(message.error, MemoryError):
            raise ChildEnded("memory") from message.error
        elif message.error is not None:
            raise message.error
        else:
            return message.value
    raise ChildEnded("slow")


def serve(pipe: int, work: str, memory: int) -> None:
    """Call a function, in at most so many bytes of memory, with the arguments that arrive by a pipe, a file's number.

    A report fails, and ends this process, once the parent is gone.
    """
    connection: Connection[Any, Any] = Connection(pipe)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is handled by the parent
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    memory = memory if most == resource.RLIM_INFINITY else min(memory, most)  # a worker's own limit holds here, too
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    module, _, name = work.partition(":")
    function: Work[Any] = getattr(import_module(module), name)
    with suppress(EOFError, ConnectionError):
        try:
            arguments = connection.recv()
            outcome = _Result(function(*arguments, lambda stage, fraction: connection.send((stage, fraction))))
        except ConnectionError:
            raise
        except Exception as error:  # noqa: BLE001 - any error is raised again in the parent
            short = isinstance(error, cv2.error) and error.code == cv2.Error.StsNoMem
            outcome = _Result(None, MemoryError() if short else error)
        connection.send(outcome)
