"""Requests are counted in Redis, by all web processes together, and in memory while it is away."""

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path

import pytest
from tests.faults.redis_server import RedisServer, need_redis

from treestroke.api.request_counts import Rate, RateLimited, RequestCounts, Standing
from treestroke.api.shared_redis import SharedRedis

SECONDS = 60.0
"""Emergency exit of what is waited for."""
RATE = Rate("calls", 3, 600)
"""A window that no test is as slow as."""


class Process(RequestCounts):
    """The counts of one web process."""

    def __init__(self, url: str) -> None:
        self.redis = SharedRedis(url)
        super().__init__(self.redis)


@pytest.fixture(scope="module")
def redis(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RedisServer]:
    need_redis()
    server = RedisServer(tmp_path_factory.mktemp("counts") / "redis")
    yield server
    server.kill()


def counting(url: str, *stories: Callable[..., Awaitable[None]], processes: int = 1) -> None:
    """Run a story with counts of so many web processes."""

    async def run() -> None:
        counts = [Process(url) for _ in range(processes)]
        try:
            for story in stories:
                await asyncio.wait_for(story(*counts), 3 * SECONDS)
        finally:
            for each in counts:
                await each.redis.close()

    asyncio.run(run())


async def taken(counts: Process, who: str, times: int) -> int:
    """Send requests, and count those that are answered."""
    answered = 0
    for _ in range(times):
        try:
            await counts.take(RATE, who)
        except RateLimited:
            continue
        answered += 1
    return answered


async def until(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(SECONDS):
        while not condition():
            await asyncio.sleep(0.05)


def test_beyond_its_rate_a_person_is_refused_and_told_when_to_ask_again() -> None:
    async def story(counts: Process) -> None:
        left = [(await counts.take(RATE, "ann")).remaining for _ in range(3)]
        assert left == [2, 1, 0]
        with pytest.raises(RateLimited) as refused:
            await counts.take(RATE, "ann")
        assert 1 <= refused.value.standing.more_in_s <= 600
        assert await taken(counts, "ben", 5) == 3

    counting("", story)


def test_looking_at_what_is_left_takes_none_of_it() -> None:
    async def story(counts: Process) -> None:
        assert [(await counts.standing(RATE, "ann")).remaining for _ in range(5)] == [3] * 5
        assert await taken(counts, "ann", 5) == 3

    counting("", story)


def test_the_headers_are_those_of_the_draft() -> None:
    assert Standing(Rate("traces", 10, 1), 7, 1).headers == {
        "RateLimit-Policy": '"traces";q=10;w=1',
        "RateLimit": '"traces";r=7;t=1',
    }


def test_web_processes_count_together(redis: RedisServer) -> None:
    async def story(first: Process, second: Process) -> None:
        assert await taken(first, "ann", 2) == 2
        assert await taken(second, "ann", 3) == 1
        assert first.redis.answers
        assert second.redis.answers

    redis.empty()
    counting(redis.url, story, processes=2)


def test_more_requests_than_connections_are_counted(redis: RedisServer) -> None:
    async def story(counts: Process) -> None:
        many = Rate("many", 300, 600)
        left = await asyncio.gather(*(counts.take(many, "ann") for _ in range(100)))
        assert len(left) == 100

    redis.empty()
    counting(redis.url, story)


def test_while_redis_is_killed_requests_are_counted_in_memory_and_afterwards_in_redis_again(redis: RedisServer) -> None:
    async def story(counts: Process) -> None:
        assert await taken(counts, "ann", 1) == 1
        redis.kill()
        assert await taken(counts, "ann", 5) == 3
        assert not counts.redis.answers
        redis.start()
        await until(lambda: counts.redis.answers)
        assert await taken(counts, "cleo", 5) == 3

    redis.empty()
    counting(redis.url, story)


def test_a_frozen_redis_is_waited_for_once_and_not_by_each_request(redis: RedisServer) -> None:
    async def story(counts: Process) -> None:
        redis.freeze()
        try:
            assert await taken(counts, "ann", 1) == 1
            assert not counts.redis.answers
            assert await taken(counts, "ann", 1000) == 2  # if each waited, the emergency exit would be taken
        finally:
            redis.thaw()
        await until(lambda: counts.redis.answers)

    redis.empty()
    counting(redis.url, story)


def test_a_full_redis_counts_as_away(redis: RedisServer) -> None:
    async def story(counts: Process) -> None:
        redis.limit_memory(1)
        try:
            assert await taken(counts, "ann", 5) == 3
            assert not counts.redis.answers
        finally:
            redis.limit_memory(0)
        await until(lambda: counts.redis.answers)

    redis.empty()
    counting(redis.url, story)


def test_no_redis_from_the_start_is_no_error(tmp_path: Path) -> None:
    async def story(counts: Process) -> None:
        assert await taken(counts, "ann", 5) == 3

    counting("redis://127.0.0.1:1/0", story)
