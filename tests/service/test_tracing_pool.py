import multiprocessing
import os
import resource
import signal
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from tests.faults.processes import wait_for
from tests.promises import kept
from tests.service import pool_work as work

from treestroke.core.errors import PhotoError
from treestroke.service.tracing_pool import WAITING, CannotStart, Crashed, Overloaded, TracingPool

SECONDS = 60.0
"""Time limit of calls, which those that are to end well do not reach on a busy machine."""


@pytest.fixture(scope="module")
def tracers() -> Iterator[TracingPool]:
    pool = TracingPool(2, SECONDS, 1536)
    yield pool
    pool.close()


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_work_is_done_in_another_process_that_stays_with_its_key(tracers: TracingPool) -> None:
    first, again = tracers("a", work.process), tracers("a", work.process)
    assert first == again != os.getpid()
    assert len({tracers(f"key {at}", work.process) for at in range(8)}) == 2


@pytest.mark.parametrize("crash", [work.segfault, work.leave])
def test_a_process_that_dies_is_replaced(tracers: TracingPool, crash: object) -> None:
    before = tracers("b", work.process)
    with pytest.raises(Crashed):
        tracers("b", crash)  # type: ignore[arg-type]
    after = tracers("b", work.process)
    assert after != before
    assert not alive(before)


def test_a_process_that_hangs_is_ended_at_the_limit(tracers: TracingPool, monkeypatch: pytest.MonkeyPatch) -> None:
    before, limit_s = tracers("c", work.process), 0.5
    with monkeypatch.context() as short:
        for child in tracers._children:
            short.setattr(child, "_bounds", child._bounds._replace(seconds=limit_s))
        began = time.monotonic()
        with kept(limit_s + 3), pytest.raises(Crashed, match="slow"):
            tracers("c", work.hang)
        assert time.monotonic() - began >= limit_s
    assert tracers("c", work.process) != before
    assert not alive(before)


def test_a_neighbour_goes_on_while_a_process_dies(tracers: TracingPool) -> None:
    keys = [f"d{at}" for at in range(20)]
    homes = {key: tracers(key, work.process) for key in keys}
    doomed = keys[0]
    other = next(key for key in keys if homes[key] != homes[doomed])
    with ThreadPoolExecutor(2) as two:
        dying = two.submit(tracers, doomed, work.segfault)
        assert tracers(other, work.process) == homes[other]
        assert isinstance(dying.exception(), Crashed)


def test_a_process_that_is_killed_between_two_calls_is_replaced(tracers: TracingPool) -> None:
    before = tracers("e", work.process)
    os.kill(before, signal.SIGKILL)
    os.waitid(os.P_PID, before, os.WEXITED | os.WNOWAIT)
    assert tracers("e", work.process) not in (before, os.getpid())


def test_memory_is_bounded_and_the_process_lives_on(tracers: TracingPool) -> None:
    before = tracers("f", work.process)
    for devour in (work.devour, work.devour_pixels):
        with pytest.raises(Crashed, match="memory"):
            tracers("f", devour)
    assert tracers("f", work.process) == before


def test_errors_of_the_input_come_back_whole(tracers: TracingPool) -> None:
    with pytest.raises(PhotoError, match="no photo") as caught:
        tracers("g", work.refuse)
    assert (caught.value.code, caught.value.pointer) == ("photo_unreadable", "/photo")


def test_more_calls_than_may_wait_are_refused_and_then_taken_again(tracers: TracingPool, tmp_path: Path) -> None:
    over = tmp_path / "over"
    with ThreadPoolExecutor(WAITING) as many:
        waiting = [many.submit(tracers, f"h{at % 2}", work.wait_for_file, over) for at in range(WAITING)]
        try:
            wait_for(lambda: sum(tracers._busy) == WAITING, SECONDS, "all calls")
            with pytest.raises(Overloaded):
                tracers("i", work.process)
        finally:
            over.touch()
        assert {future.result() for future in waiting} == {1}
    assert tracers("i", work.process)


def test_a_pool_that_is_closed_leaves_no_process() -> None:
    pool = TracingPool(2, SECONDS, 1536)
    pids = {pool(f"key {at}", work.process) for at in range(4)}
    pool.close()
    assert len(pids) == 2
    assert not [pid for pid in pids if alive(pid)]


@contextmanager
def spare_descriptors(count: int) -> Iterator[None]:
    """Let this process open no more than so many files."""
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    free = os.open(os.devnull, os.O_RDONLY)
    os.close(free)
    resource.setrlimit(resource.RLIMIT_NOFILE, (free + count, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


def test_a_process_that_cannot_be_started_leaves_nothing_and_the_next_call_tries_again(tracers: TracingPool) -> None:
    tracers("j", work.process)  # Python's own tracker of resources runs from now on
    pool, failures = TracingPool(1, SECONDS, 1536), []
    open_before = os.listdir("/proc/self/fd")
    for spare in range(32):
        with spare_descriptors(spare), suppress(CannotStart):
            pool("a", work.process)
        failures.append(pool.failure)
        if pool.failure is None:
            break
        assert os.listdir("/proc/self/fd") == open_before
    assert failures[-1] is None
    assert len(failures) > 3
    assert set(failures[:-1]) == {"Too many open files"}
    pool.close()


def test_a_process_that_ends_before_it_is_ready_is_no_process() -> None:
    others, pool = set(multiprocessing.active_children()), TracingPool(1, SECONDS, 64)
    for _ in range(2):
        with pytest.raises(CannotStart, match="it ended before it was ready"):
            pool("a", work.process)
    assert set(multiprocessing.active_children()) == others


def test_all_processes_are_started_before_they_are_asked_for_anything() -> None:
    others, pool = set(multiprocessing.active_children()), TracingPool(2, SECONDS, 1536)
    pool.start()
    wait_for(lambda: len(set(multiprocessing.active_children()) - others) == 2, SECONDS, "two processes")
    started = set(multiprocessing.active_children()) - others
    assert {pool(f"key {at}", work.process) for at in range(4)} == {child.pid for child in started}
    pool.close()
