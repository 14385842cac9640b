"""Counts requests by rate and by who sends them: in Redis, and in memory while it is away."""

import asyncio
import math
import time
from contextlib import suppress
from contextvars import Context
from dataclasses import dataclass
from typing import Any

import structlog
from limits import RateLimitItemPerSecond
from limits.aio.storage import MemoryStorage, RedisStorage
from limits.aio.strategies import SlidingWindowCounterRateLimiter
from redis.asyncio import BlockingConnectionPool
from redis.exceptions import RedisError

REDIS_CONNECTIONS = 8
_REDIS_SECONDS = 0.25
"""A Redis that has not counted a request within this time is away."""
_PROBE_SECONDS = 1.0
"""How often it is tried while it is away."""
_PREFIX = "treestroke-rates"
log = structlog.get_logger()


@dataclass(frozen=True)
class Rate:
    """So many requests may be sent in so many seconds."""

    name: str
    requests: int
    seconds: int


_PROBES = Rate("probes", 1000, 1)


class RateLimited(Exception):
    """A person, or an address without a key, has sent as many requests as it may for now."""

    def __init__(self, standing: "Standing") -> None:
        super().__init__(standing.rate.name)
        self.standing = standing


@dataclass(frozen=True)
class Standing:
    """How many requests of a rate are left, and in how many seconds there will be one more."""

    rate: Rate
    remaining: int
    more_in_s: int

    @property
    def headers(self) -> dict[str, str]:
        """The header fields of draft-ietf-httpapi-ratelimit-headers-10."""
        name = self.rate.name
        return {
            "RateLimit-Policy": f'"{name}";q={self.rate.requests};w={self.rate.seconds}',
            "RateLimit": f'"{name}";r={self.remaining};t={self.more_in_s}',
        }


class RequestCounts:
    """Counts requests in a Redis that all web processes share, and in this process's memory while it is away.

    No request waits for a Redis that is away: it is tried beside the requests, and counts again once it does.
    """

    def __init__(self, redis_url: str) -> None:
        self._own = SlidingWindowCounterRateLimiter(MemoryStorage())
        self._pool: BlockingConnectionPool | None = None
        self._shared: SlidingWindowCounterRateLimiter | None = None
        self._probing: asyncio.Task[None] | None = None
        if redis_url:
            self._pool = BlockingConnectionPool.from_url(
                redis_url,
                max_connections=REDIS_CONNECTIONS,
                timeout=_REDIS_SECONDS,
                socket_timeout=_REDIS_SECONDS,
                socket_connect_timeout=_REDIS_SECONDS,
            )
            options: dict[str, Any] = {"connection_pool": self._pool}
            storage = RedisStorage(redis_url, implementation="redispy", key_prefix=_PREFIX, **options)
            self._shared = SlidingWindowCounterRateLimiter(storage)

    async def take(self, rate: Rate, who: str) -> Standing:
        """Count a request.

        Raises
        ------
        RateLimited
            It is one too many.
        """
        taken, standing = await self._ask(rate, who, counts=True)
        if not taken:
            raise RateLimited(standing)
        return standing

    async def standing(self, rate: Rate, who: str) -> Standing:
        """Return how many requests are left, without counting one."""
        return (await self._ask(rate, who, counts=False))[1]

    @property
    def shared(self) -> bool:
        """Whether requests are counted in Redis at the moment."""
        return self._shared is not None and self._probing is None

    async def close(self) -> None:
        """Close the connections."""
        if self._probing is not None:
            self._probing.cancel()
            with suppress(asyncio.CancelledError):
                await self._probing
        if self._pool is not None:
            with suppress(RedisError, OSError):
                await self._pool.disconnect()

    async def _ask(self, rate: Rate, who: str, counts: bool) -> tuple[bool, Standing]:
        if self._shared is not None and self._probing is None:
            try:
                async with asyncio.timeout(_REDIS_SECONDS):
                    return await _count(self._shared, rate, who, counts)
            except (RedisError, OSError, TimeoutError) as error:
                self._leave(self._shared, error)
        return await _count(self._own, rate, who, counts)

    def _leave(self, shared: SlidingWindowCounterRateLimiter, error: Exception) -> None:
        """Count in memory from now on, until the Redis counts again."""
        if self._probing is None:
            log.warning("rates_in_memory", error=str(error) or type(error).__name__)
            self._probing = asyncio.create_task(self._probe(shared), context=Context())  # it outlives the request

    async def _probe(self, shared: SlidingWindowCounterRateLimiter) -> None:
        while True:
            await asyncio.sleep(_PROBE_SECONDS)
            with suppress(RedisError, OSError, TimeoutError):
                async with asyncio.timeout(_REDIS_SECONDS):
                    await _count(shared, _PROBES, "", counts=True)  # a full one answers, but does not count
                break
        log.info("rates_in_redis")
        self._probing = None


async def _count(limiter: SlidingWindowCounterRateLimiter, rate: Rate, who: str, counts: bool) -> tuple[bool, Standing]:
    item = RateLimitItemPerSecond(rate.requests, rate.seconds)
    taken = await limiter.hit(item, rate.name, who) if counts else True
    more_at, remaining = await limiter.get_window_stats(item, rate.name, who)
    return taken, Standing(rate, remaining, max(math.ceil(more_at - time.time()), 1))
