"""Places for streams of events: counted by all web processes together, and by each alone while Redis is away."""

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from contextlib import AsyncExitStack

import pytest
from tests.faults.redis_server import RedisServer, need_redis

from treestroke.api import stream_places
from treestroke.api.shared_redis import SharedRedis
from treestroke.api.stream_places import StreamPlaces
from treestroke.service.quotas import QuotaExceeded

SECONDS = 60.0
"""Emergency exit of what is waited for."""


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RedisServer]:
    need_redis()
    server = RedisServer(tmp_path_factory.mktemp("places") / "redis")
    yield server
    server.kill()


@pytest.fixture
def redis(server: RedisServer) -> RedisServer:
    server.empty()
    return server


class Process(StreamPlaces):
    """The places of one web process, and the streams that it has."""

    def __init__(self, url: str, limit: int) -> None:
        self.redis, self.streams = SharedRedis(url), AsyncExitStack()
        super().__init__(self.redis, limit)

    async def take(self, times: int, person: str = "ann") -> int:
        """Open streams, and count those that are not refused."""
        opened = 0
        for _ in range(times):
            try:
                await self.streams.enter_async_context(self.taken(person))
            except QuotaExceeded:
                continue
            opened += 1
        return opened

    async def open(self, person: str = "ann") -> int:
        return (await self.used(person)).used


def running(url: str, story: Callable[..., Awaitable[None]], processes: int = 1, limit: int = 3) -> None:
    """Run a story with so many web processes."""

    async def run() -> None:
        all_of_them = [Process(url, limit) for _ in range(processes)]
        try:
            await asyncio.wait_for(story(*all_of_them), 3 * SECONDS)
        finally:
            for each in all_of_them:
                await each.streams.aclose()
                await each.redis.close()

    asyncio.run(run())


async def until(condition: Callable[[], Awaitable[bool]]) -> None:
    async with asyncio.timeout(SECONDS):
        while not await condition():
            await asyncio.sleep(0.05)


def test_web_processes_count_a_persons_streams_together(redis: RedisServer) -> None:
    async def story(first: Process, second: Process) -> None:
        assert await first.take(2) == 2
        assert await second.take(3) == 1
        assert await second.take(5, "ben") == 3
        assert [await each.open() for each in (first, second)] == [3, 3]
        await first.streams.aclose()
        await until(lambda: _is(second, 1))
        assert await second.take(5) == 2

    running(redis.url, story, processes=2)


async def _is(process: Process, number: int) -> bool:
    return await process.open() == number


def test_a_stream_whose_request_is_canceled_frees_its_place(redis: RedisServer) -> None:
    async def story(process: Process) -> None:
        async def stream() -> None:
            async with process.taken("ann"):
                await asyncio.sleep(SECONDS)

        request = asyncio.create_task(stream())
        await until(lambda: _is(process, 1))
        request.cancel()
        await until(lambda: _is(process, 0))

    running(redis.url, story)


def test_places_of_a_process_that_is_gone_are_free_after_a_while_and_others_stay_taken(
    redis: RedisServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def story(gone: Process, stays: Process) -> None:
        assert (await gone.take(1), await stays.take(1)) == (1, 1)
        while await stays.open() == 2:
            await stays.renew()
            await asyncio.sleep(0.05)
        assert await stays.take(5) == 2

    monkeypatch.setattr(stream_places, "_HELD_SECONDS", 2)
    running(redis.url, story, processes=2)


def test_an_emptied_redis_is_told_again_which_streams_are_open(redis: RedisServer) -> None:
    async def story(first: Process, second: Process) -> None:
        assert await first.take(3) == 3
        redis.empty()
        await first.renew()
        assert await second.take(1) == 0

    running(redis.url, story, processes=2)


def test_while_redis_is_away_each_process_counts_its_own(redis: RedisServer) -> None:
    async def story(first: Process, second: Process) -> None:
        redis.kill()
        assert (await first.take(4), await second.take(1)) == (3, 1)
        assert (await first.open(), await second.open()) == (3, 1)
        redis.start()
        await until(lambda: _answers(first, second))
        await first.renew()
        assert await second.take(1) == 0

    running(redis.url, story, processes=2)


async def _answers(*processes: Process) -> bool:
    return all(each.redis.answers for each in processes)


def test_without_a_limit_nothing_is_asked_and_there_is_any_number() -> None:
    async def story(process: Process) -> None:
        assert await process.take(9) == 9
        assert await process.open() == 9

    running("redis://127.0.0.1:1/0", story, limit=0)
