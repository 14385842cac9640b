"""Work on several items at once, with results in their order."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

A = TypeVar("A")
B = TypeVar("B")

_THREADS = 2
"""Items that are worked on at once; OpenCV, numpy and COLMAP let other threads run meanwhile."""


def untold(fraction: float) -> None:
    """Tell nobody how far work is."""


def side_by_side(work: Callable[[A], B], items: Sequence[A], advanced: Callable[[float], None] = untold) -> list[B]:
    """Return what ``work`` returns for each item, in their order; ``advanced(fraction)`` is told how far it is.

    Each item is worked on by one thread, so that results do not depend on how many there are. An exception of either
    ends the work.
    """
    with ThreadPoolExecutor(_THREADS) as pool:
        futures = [pool.submit(work, item) for item in items]
        results = []
        try:
            for number, future in enumerate(futures, start=1):
                results.append(future.result())
                advanced(number / len(futures))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return results
