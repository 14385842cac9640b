"""A small pool of processes for what must answer at once: decoding photos and tracing.

They are processes because a graph cut holds Python's lock for a whole cut and because a decoder may crash: a child
that dies or takes too long is replaced, and its neighbours never notice.
"""

import multiprocessing
import resource
import signal
import threading
from collections import OrderedDict
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext, ForkServerProcess
from typing import Any, ParamSpec, TypeVar

from prometheus_client import Counter

from treestroke.service.failures import ran_out_of_memory

P = ParamSpec("P")
T = TypeVar("T")

WAITING = 16
"""Calls that may wait or run at once; more are refused, so that none waits long."""
_REMEMBERED = 64
"""Photos whose child is remembered."""
REPLACED = Counter("treestroke_tracers_replaced", "Tracing processes that crashed or took too long.", ["why"])
for _why in ("slow", "crash"):
    REPLACED.labels(_why)  # from the beginning on there is a figure, 0


class Overloaded(Exception):
    """More calls wait than the pool takes."""


class Crashed(Exception):
    """The child died or took too long over this call."""


class Tracers:
    """Processes that each keep what they know of the last photos they saw: a photo goes where it was."""

    def __init__(self, count: int, seconds: float, memory_mb: int) -> None:
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(["treestroke.service.tracing", "treestroke.service.wishes"])
        self._children = [_Child(context, seconds, memory_mb * 2**20) for _ in range(count)]
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
        """
        at = self._enter(key)
        try:
            done: T = self._children[at].do(work, args, kwargs)
            return done
        finally:
            with self._lock:
                self._busy[at] -= 1

    def close(self) -> None:
        """End all children at once, for good."""
        for child in self._children:
            child.close()

    def _enter(self, key: str) -> int:
        with self._lock:
            if sum(self._busy) >= WAITING:
                raise Overloaded
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


class _Child:
    """One process, and the line to it; started at its first call and whenever it is gone."""

    def __init__(self, context: ForkServerContext, seconds: float, memory: int) -> None:
        self._context, self._seconds, self._memory = context, seconds, memory
        self._turn = threading.Lock()
        self._process: ForkServerProcess | None = None
        self._line: Connection | None = None
        self._closed = False

    def do(self, work: Callable[..., Any], args: tuple[object, ...], kwargs: dict[str, object]) -> Any:
        """Have the child do a piece of work, after those that wait already."""
        with self._turn:
            try:
                line = self._ready()
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
        self._closed = True
        if self._process is not None:
            self._process.kill()
            self._process.join()
        # A call that waits for it notices the end of the line.

    def _ready(self) -> Connection:
        if self._closed:
            raise Crashed("closed")
        if self._process is not None and not self._process.is_alive():
            self._replaced("crash")
        if self._line is None:
            self._line, theirs = self._context.Pipe()
            self._process = self._context.Process(target=_serve, args=(theirs, self._memory), daemon=True)
            self._process.start()
            theirs.close()  # so that its end is noticed here
            self._line.recv()  # it is ready: its time for the work begins now
        return self._line

    def _replaced(self, why: str) -> Crashed:
        """End the child; the next call starts another."""
        REPLACED.labels(why).inc()
        if self._process is not None and self._line is not None:
            self._process.kill()
            self._process.join()
            self._line.close()
        self._process = self._line = None
        return Crashed(why)


def _serve(line: Connection, memory: int) -> None:
    """Work, call after call, until nobody is at the other end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is for the parent
    limit_memory(memory)
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
