"""Counts requests by rate and by who sends them: in Redis, and in memory while it is away."""

import math
import time
from dataclasses import dataclass
from typing import Any

from limits import RateLimitItemPerSecond
from limits.aio.storage import MemoryStorage, RedisStorage
from limits.aio.strategies import SlidingWindowCounterRateLimiter

from treestroke.api.shared_redis import SharedRedis

_PREFIX = "treestroke-rates"


@dataclass(frozen=True)
class Rate:
    """So many requests may be sent in so many seconds."""

    name: str
    requests: int
    seconds: int


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
    """Counts requests in the Redis that all web processes share, and in this process's memory while it is away."""

    def __init__(self, redis: SharedRedis) -> None:
        self._redis = redis
        self._own = SlidingWindowCounterRateLimiter(MemoryStorage())
        self._shared: SlidingWindowCounterRateLimiter | None = None
        if redis.pool is not None:
            options: dict[str, Any] = {"connection_pool": redis.pool}
            storage = RedisStorage(redis.url, implementation="redispy", key_prefix=_PREFIX, **options)
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

    async def _ask(self, rate: Rate, who: str, counts: bool) -> tuple[bool, Standing]:
        if (shared := self._shared) is not None:
            answer = await self._redis.ask(lambda _: _count(shared, rate, who, counts))
            if answer is not None:
                return answer
        return await _count(self._own, rate, who, counts)


async def _count(limiter: SlidingWindowCounterRateLimiter, rate: Rate, who: str, counts: bool) -> tuple[bool, Standing]:
    item = RateLimitItemPerSecond(rate.requests, rate.seconds)
    taken = await limiter.hit(item, rate.name, who) if counts else True
    more_at, remaining = await limiter.get_window_stats(item, rate.name, who)
    return taken, Standing(rate, remaining, max(math.ceil(more_at - time.time()), 1))
