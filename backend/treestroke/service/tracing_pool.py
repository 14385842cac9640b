"""A small pool of processes for work that a user waits for: decoding photos and tracing.

Processes, because a graph cut holds Python's global lock all the time and because a decoder may crash: a process that
dies or takes too long is replaced without effect on the others. They are spawned, not forked: a fork server would start
them faster, but if it or its socket were lost, no more could be started.
"""

import multiprocessing
import os
import resource
import signal
import threading
from collections import OrderedDict
from collections.abc import Callable
from contextlib import ExitStack, suppress
from importlib import import_module
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from typing import Any, NamedTuple, ParamSpec, TypeVar

from prometheus_client import Counter

from treestroke.service.failures import ran_out_of_memory

P = ParamSpec("P")
T = TypeVar("T")

WAITING = 16
"""Calls that may wait or run at once."""
_REMEMBERED_KEYS = 64
"""Keys (photos) whose process is remembered."""
_START_SECONDS = 30.0
"""A process that is not ready after this time has failed to start."""
_IMPORTED = ("treestroke.service.tracer", "treestroke.service.model_request")
"""Modules that a process imports before it is ready, so that no call spends its time on them."""
REPLACED = Counter("treestroke_tracers_replaced", "Tracing processes that crashed or took too long.", ["why"])
for _why in ("slow", "crash"):
    REPLACED.labels(_why)  # the metric starts at 0 instead of being absent


class Overloaded(Exception):
    """Too many calls wait or run."""


class Crashed(Exception):
    """The process died during this call, or the call took too long."""


class CannotStart(Exception):
    """No process could be started for this call; the next call tries again."""


class TracingPool:
    """A pool of processes that cache the last photos they worked on: a photo's calls go to the same process.

    Parameters
    ----------
    count
        How many processes.
    seconds, memory_mb
        What a call, and a process, may take.
    waiting
        Calls that may wait or run at once; more are refused, so that no call waits long.
    """

    def __init__(self, count: int, seconds: float, memory_mb: int, waiting: int = WAITING) -> None:
        self._children = [_Child(seconds, memory_mb * 2**20) for _ in range(count)]
        self._waiting = waiting
        self._lock = threading.Lock()
        self._index_of: OrderedDict[str, int] = OrderedDict()
        self._busy = [0] * count

    def __call__(self, key: str, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Return what ``work`` returns in the process that last worked on ``key``; raise what it raises.

        Raises
        ------
        Overloaded
            Too many calls wait or run.
        Crashed
            The process died, exceeded the time limit (both: it is replaced) or ran out of memory.
        CannotStart
            No process is running, and none could be started.
        """
        index = self._enter(key)
        try:
            result: T = self._children[index].call(work, args, kwargs)
            return result
        finally:
            with self._lock:
                self._busy[index] -= 1

    def start(self) -> None:
        """Start all processes in the background, so that they are ready for their first calls."""
        for child in self._children:
            threading.Thread(target=child.start, name="tracer", daemon=True).start()

    @property
    def failure(self) -> str | None:
        """Why a process could not be started; None if none failed to start."""
        return next((child.failure for child in self._children if child.failure is not None), None)

    def close(self) -> None:
        """Kill all processes; none is started again."""
        for child in self._children:
            child.close()

    def _enter(self, key: str) -> int:
        """Return the index of the process for a key, and count the call; a new key goes to the least busy process."""
        with self._lock:
            if sum(self._busy) >= self._waiting:
                raise Overloaded("too many requests are being traced at the moment")
            index = self._index_of.pop(key, None)
            if index is None:
                load = [
                    (self._busy[i], sum(index == i for index in self._index_of.values()))
                    for i in range(len(self._busy))
                ]
                index = load.index(min(load))
            self._index_of[key] = index
            if len(self._index_of) > _REMEMBERED_KEYS:
                self._index_of.popitem(last=False)
            self._busy[index] += 1
            return index


class _Running(NamedTuple):
    """A process that is ready, and the connection to it."""

    process: SpawnProcess
    connection: Connection


class _Child:
    """A place of the pool: its process is started at the first call, and again whenever it has ended."""

    def __init__(self, seconds: float, memory: int) -> None:
        self._seconds, self._memory = seconds, memory
        self._lock = threading.Lock()
        self._running: _Running | None = None
        self._closed = threading.Event()
        self.failure: str | None = None
        """Why the last start failed; None if it succeeded."""

    def start(self) -> None:
        """Start the process if it does not run; if that fails, the next call tries again."""
        with self._lock, suppress(CannotStart, Crashed):
            self._ready()

    def call(self, work: Callable[..., Any], args: tuple[object, ...], kwargs: dict[str, object]) -> Any:
        """Return what ``work`` returns in the process, after the calls that already wait for it."""
        with self._lock:
            connection = self._ready()
            try:
                connection.send((work, args, kwargs))
                if not connection.poll(self._seconds):
                    raise self._ended("slow")
                result, error = connection.recv()
            except (EOFError, ConnectionError) as lost:
                raise self._ended("crash") from lost
        if isinstance(error, MemoryError):
            raise Crashed("memory") from error
        if error is not None:
            raise error
        return result

    def close(self) -> None:
        """Kill the process; it is not started again."""
        self._closed.set()
        running = self._running
        # A call that waits for the process sees its connection end; one that is replacing it kills it itself.
        if running is not None:
            with suppress(ValueError):
                running.process.kill()
                running.process.join()

    def _ready(self) -> Connection:
        """Return the connection to the process, started if it does not run."""
        if self._running is not None and not self._running.process.is_alive():
            self._ended("crash")
        if self._closed.is_set():
            raise Crashed("closed")
        if self._running is None:
            try:
                self._running, self.failure = _start(self._memory), None
            except CannotStart as error:
                self.failure = str(error)
                raise
            if self._closed.is_set():
                self.close()
        return self._running.connection

    def _ended(self, why: str) -> Crashed:
        """Kill the process, which the next call replaces, and return the error for the present call."""
        REPLACED.labels(why).inc()
        running, self._running = self._running, None
        if running is not None and not self._closed.is_set():
            running.connection.close()
            _kill(running.process)
        return Crashed(why)


def _start(memory: int) -> _Running:
    """Return a started process once it is ready; on failure nothing of it remains."""
    context = multiprocessing.get_context("spawn")
    with ExitStack() as undo:
        try:
            ours, theirs = context.Pipe()
            undo.callback(ours.close)
            with theirs:  # closed in this process, so that the other's end is noticed
                process = context.Process(target=_serve, args=(theirs, memory), daemon=True)
                process.start()
            undo.callback(_kill, process)
            if not ours.poll(_START_SECONDS):
                raise CannotStart(f"it was not ready within {_START_SECONDS:g} s")
            ours.recv()
        except OSError as error:
            raise CannotStart(os.strerror(error.errno) if error.errno else str(error)) from error
        except EOFError as error:
            raise CannotStart("it ended before it was ready") from error
        undo.pop_all()
    return _Running(process, ours)


def _kill(process: SpawnProcess) -> None:
    process.kill()
    process.join()
    process.close()


def _serve(connection: Connection, memory: int) -> None:
    """Do the work that arrives, call after call, until the parent's end of the connection is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is handled by the parent
    limit_memory(memory)
    for name in _IMPORTED:
        import_module(name)
    with suppress(EOFError, ConnectionError):
        connection.send(None)
        while True:
            work, args, kwargs = connection.recv()
            outcome: tuple[object, Exception | None]
            try:
                outcome = work(*args, **kwargs), None
            except Exception as error:  # noqa: BLE001 - any error is raised again in the parent
                outcome = None, MemoryError() if ran_out_of_memory(error) else error
            connection.send(outcome)


def limit_memory(size: int) -> None:
    """Limit this process's address space to ``size`` bytes, so that a bad photo fails one call and not the machine."""
    resource.setrlimit(resource.RLIMIT_AS, (size, size))
