"""How the pipeline runs: its libraries on one thread, with the seconds of each stage measured."""

import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import cv2
from threadpoolctl import threadpool_limits

from treestroke.core.progress import Report


class Stopwatch:
    """A progress report that adds the time between calls to the current stage, and forwards the calls."""

    def __init__(self, report: Report, clock: Callable[[], float] = time.perf_counter) -> None:
        self.seconds: defaultdict[str, float] = defaultdict(float)
        self._report = report
        self._clock = clock
        self._stage = ""
        self._since = clock()

    def __call__(self, stage: str, fraction: float) -> None:
        """Add the time since the last call to the current stage, then continue with ``stage``."""
        self._add_time(stage)
        self._report(stage, fraction)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Measure a stage that does not report progress itself."""
        self(name, 0.0)
        yield
        self(name, 1.0)

    def _add_time(self, stage: str) -> None:
        now = self._clock()
        if self._stage:
            self.seconds[self._stage] += now - self._since
        self._stage, self._since = stage, now


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit BLAS, OpenMP and OpenCV to one thread each: sums keep their order."""
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        with threadpool_limits(limits=1):
            yield
    finally:
        cv2.setNumThreads(before)
