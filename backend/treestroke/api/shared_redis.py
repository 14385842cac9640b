"""The Redis that all web processes share, as their requests ask it: none waits for one that is away."""

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from contextvars import Context
from typing import TypeVar

import structlog
from redis.asyncio import BlockingConnectionPool, Redis
from redis.exceptions import RedisError

CONNECTIONS = 8
_SECONDS = 0.25
"""A Redis that has not answered within this time is away."""
_PROBE_SECONDS = 1.0
"""How often it is tried while it is away."""
_PROBE = "treestroke-probe"
_AWAY = (RedisError, OSError, TimeoutError)
Answer = TypeVar("Answer")
log = structlog.get_logger()


class SharedRedis:
    """A Redis, or none where ``url`` is empty. While it is away it is tried beside the requests, until it answers."""

    def __init__(self, url: str) -> None:
        self.url = url
        self.pool = _pool(url) if url else None
        self._client = Redis(connection_pool=self.pool) if self.pool else None
        self._probing: asyncio.Task[None] | None = None
        self._telling: set[asyncio.Task[object]] = set()

    @property
    def answers(self) -> bool:
        """Whether there is one, and it is not away."""
        return self._client is not None and self._probing is None

    async def ask(self, question: Callable[[Redis], Awaitable[Answer]]) -> Answer | None:
        """Return the answer to a question; None where there is no Redis, or it is away."""
        if (redis := self._client) is None or self._probing is not None:
            return None
        try:
            async with asyncio.timeout(_SECONDS):
                return await question(redis)
        except _AWAY as error:
            if self._probing is None:
                log.warning("redis_away", error=str(error) or type(error).__name__)
                self._probing = asyncio.create_task(self._probe(redis), context=Context())  # it outlives the request
            return None

    def tell(self, question: Callable[[Redis], Awaitable[object]]) -> None:
        """Ask in a task of its own, whose answer nobody needs: the request it is for may be over, or canceled."""
        telling = asyncio.create_task(self.ask(question), context=Context())
        self._telling.add(telling)  # asyncio itself keeps no hold of a task
        telling.add_done_callback(self._telling.discard)

    async def close(self) -> None:
        """Close the connections, after what is being told."""
        await asyncio.gather(*self._telling)
        if self._probing is not None:
            self._probing.cancel()
            with suppress(asyncio.CancelledError):
                await self._probing
        if self.pool is not None:
            with suppress(RedisError, OSError):
                await self.pool.disconnect()

    async def _probe(self, redis: Redis) -> None:
        while True:
            await asyncio.sleep(_PROBE_SECONDS)
            with suppress(*_AWAY):
                async with asyncio.timeout(_SECONDS):
                    await redis.set(_PROBE, 1, ex=1)  # a full one answers, but takes nothing
                break
        log.info("redis_back")
        self._probing = None


def _pool(url: str) -> BlockingConnectionPool:
    return BlockingConnectionPool.from_url(
        url,
        max_connections=CONNECTIONS,
        timeout=_SECONDS,
        socket_timeout=_SECONDS,
        socket_connect_timeout=_SECONDS,
    )
