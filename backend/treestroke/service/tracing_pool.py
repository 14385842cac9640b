"""A small pool of processes for what must answer at once: decoding photos and tracing.

They are processes because a graph cut holds Python's lock for a whole cut and because a decoder may crash: a child
that dies or takes too long is replaced, and its neighbours never notice. Each is started from nothing but the program
itself: a server that forks them would start faster, and once it or its socket is gone there would be no more of them.
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
"""Calls that may wait or run at once; more are refused, so that none waits long."""
_REMEMBERED = 64
"""Photos whose child is remembered."""
_START_SECONDS = 30.0
"""A child that is not ready within this never will be."""
_IMPORTED = ("treestroke.service.tracer", "treestroke.service.model_request")
"""What a child imports before it is ready: the time for a call is for the call."""
REPLACED = Counter("treestroke_tracers_replaced", "Tracing processes that crashed or took too long.", ["why"])
for _why in ("slow", "crash"):
    REPLACED.labels(_why)  # from the beginning on there is a figure, 0


class Overloaded(Exception):
    """More wait than may."""


class Crashed(Exception):
    """The child died or took too long over this call."""


class CannotStart(Exception):
    """No child could be started for this call; the next call tries again."""


class TracingPool:
    """Processes that each keep what they know of the last photos they saw: a photo goes where it was."""

    def __init__(self, count: int, seconds: float, memory_mb: int) -> None:
        self._children = [_Child(seconds, memory_mb * 2**20) for _ in range(count)]
        self._lock = threading.Lock()
        self._homes: OrderedDict[str, int] = OrderedDict()
        self._busy = [0] * count

    def __call__(self, key: str, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Do a piece of work in the child that knows ``key``, and wait for it.

        Raises
        ------
        Overloaded
            Too many calls wait.
        Crashed
            The child died or took longer than the limit and is replaced, or it ran out of memory.
        CannotStart
            There is no child, and none could be started.
        """
        at = self._enter(key)
        try:
            done: T = self._children[at].do(work, args, kwargs)
            return done
        finally:
            with self._lock:
                self._busy[at] -= 1

    def start(self) -> None:
        """Start all children in the background, so that their first calls find them ready."""
        for child in self._children:
            threading.Thread(target=child.start, name="tracer", daemon=True).start()

    @property
    def failure(self) -> str | None:
        """Why a child could not be started; None where each that was to be started was."""
        return next((child.failure for child in self._children if child.failure is not None), None)

    def close(self) -> None:
        """End all children at once, for good."""
        for child in self._children:
            child.close()

    def _enter(self, key: str) -> int:
        with self._lock:
            if sum(self._busy) >= WAITING:
                raise Overloaded("too much is being traced at the moment")
            at = self._homes.pop(key, None)
            if at is None:
                load = [
                    (self._busy[i], sum(home == i for home in self._homes.values())) for i in range(len(self._busy))
                ]
                at = load.index(min(load))
            self._homes[key] = at
            if len(self._homes) > _REMEMBERED:
                self._homes.popitem(last=False)
            self._busy[at] += 1
            return at


class _Running(NamedTuple):
    """A process that has said it is ready, and the line to it."""

    process: SpawnProcess
    line: Connection


class _Child:
    """One process; started at its first call and whenever it is gone."""

    def __init__(self, seconds: float, memory: int) -> None:
        self._seconds, self._memory = seconds, memory
        self._turn = threading.Lock()
        self._running: _Running | None = None
        self._closed = threading.Event()
        self.failure: str | None = None
        """Why the last start failed."""

    def start(self) -> None:
        """Start the process where it does not run; one that cannot be started is for the next call to start."""
        with self._turn, suppress(CannotStart, Crashed):
            self._ready()

    def do(self, work: Callable[..., Any], args: tuple[object, ...], kwargs: dict[str, object]) -> Any:
        """Have the child do a piece of work, after those that wait already."""
        with self._turn:
            line = self._ready()
            try:
                line.send((work, args, kwargs))
                if not line.poll(self._seconds):
                    raise self._replaced("slow")
                found, error = line.recv()
            except (EOFError, ConnectionError) as gone:
                raise self._replaced("crash") from gone
        if isinstance(error, MemoryError):
            raise Crashed("memory") from error
        if error is not None:
            raise error
        return found

    def close(self) -> None:
        """End the child, whatever it does."""
        self._closed.set()
        running = self._running
        # A call that waits for it notices the end of the line; one that just replaces it ends it itself.
        if running is not None:
            with suppress(ValueError):
                running.process.kill()
                running.process.join()

    def _ready(self) -> Connection:
        if self._running is not None and not self._running.process.is_alive():
            self._replaced("crash")
        if self._closed.is_set():
            raise Crashed("closed")
        if self._running is None:
            try:
                self._running, self.failure = _started(self._memory), None
            except CannotStart as error:
                self.failure = str(error)
                raise
            if self._closed.is_set():
                self.close()
        return self._running.line

    def _replaced(self, why: str) -> Crashed:
        """End the child; the next call starts another."""
        REPLACED.labels(why).inc()
        running, self._running = self._running, None
        if running is not None and not self._closed.is_set():
            running.line.close()
            _end(running.process)
        return Crashed(why)


def _started(memory: int) -> _Running:
    """Start a process and wait until it is ready; where it does not get there nothing is left of it."""
    context = multiprocessing.get_context("spawn")
    with ExitStack() as undo:
        try:
            line, theirs = context.Pipe()
            undo.callback(line.close)
            with theirs:  # closed here, so that its end is noticed
                process = context.Process(target=_serve, args=(theirs, memory), daemon=True)
                process.start()
            undo.callback(_end, process)
            if not line.poll(_START_SECONDS):
                raise CannotStart(f"it was not ready within {_START_SECONDS:g} s")
            line.recv()
        except OSError as error:
            raise CannotStart(os.strerror(error.errno) if error.errno else str(error)) from error
        except EOFError as error:
            raise CannotStart("it ended before it was ready") from error
        undo.pop_all()
    return _Running(process, line)


def _end(process: SpawnProcess) -> None:
    process.kill()
    process.join()
    process.close()


def _serve(line: Connection, memory: int) -> None:
    """Work, call after call, until nobody is at the other end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is for the parent
    limit_memory(memory)
    for name in _IMPORTED:
        import_module(name)
    with suppress(EOFError, ConnectionError):
        line.send(None)
        while True:
            work, args, kwargs = line.recv()
            answer: tuple[object, Exception | None]
            try:
                answer = work(*args, **kwargs), None
            except Exception as error:  # noqa: BLE001 - the caller has it, whatever it is
                answer = None, MemoryError() if ran_out_of_memory(error) else error
            line.send(answer)


def limit_memory(size: int) -> None:
    """Let this process have no more address space than ``size`` bytes: a bad photo ends one call, not the machine."""
    resource.setrlimit(resource.RLIMIT_AS, (size, size))
