"""A small pool of processes for what must answer at once: decoding photos and tracing.

They are processes because a graph cut holds Python's lock for a whole cut and because a decoder may crash: a child
that dies or takes too long is replaced, and its neighbours never notice.
"""

import multiprocessing
import resource
import threading
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future
from typing import ParamSpec, TypeVar

from pebble import ProcessExpired, ProcessPool
from prometheus_client import Counter

P = ParamSpec("P")
T = TypeVar("T")

WAITING = 16
"""Calls that may wait or run at once; more are refused, so that none waits long."""
_REMEMBERED = 64
"""Photos whose child is remembered."""
REPLACED = Counter("treestroke_tracers_replaced", "Tracing processes that crashed or took too long.", ["why"])


class Overloaded(Exception):
    """More calls wait than the pool takes."""


class Crashed(Exception):
    """The child died or took too long over this call."""


class Tracers:
    """Processes that each keep what they know of the last photos they saw: a photo goes where it was."""

    def __init__(self, count: int, seconds: float, memory_mb: int) -> None:
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(["treestroke.service.tracing"])
        limit = (memory_mb * 2**20,)
        self._pools = [
            ProcessPool(max_workers=1, context=context, initializer=limit_memory, initargs=limit) for _ in range(count)
        ]
        self._seconds = seconds
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
            The child died or took longer than the limit; it is being replaced.
        """
        at = self._enter(key)
        try:
            future: Future[T] = self._pools[at].schedule(work, args=args, kwargs=kwargs, timeout=self._seconds)
            return future.result()
        except (ProcessExpired, TimeoutError) as error:
            why = "slow" if isinstance(error, TimeoutError) else "crash"
            REPLACED.labels(why).inc()
            raise Crashed(why) from error
        finally:
            with self._lock:
                self._busy[at] -= 1

    def close(self) -> None:
        """Stop all children at once."""
        for pool in self._pools:
            pool.stop()  # type: ignore[no-untyped-call]
        for pool in self._pools:
            pool.join()

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


def limit_memory(size: int) -> None:
    """Let this process have no more address space than ``size`` bytes: a bad photo ends one call, not the machine."""
    resource.setrlimit(resource.RLIMIT_AS, (size, size))
