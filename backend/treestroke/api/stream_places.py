"""Places for streams of events, of which each person has a few: counted in Redis for all web processes together."""

from collections import defaultdict
from collections.abc import AsyncIterator, Collection
from contextlib import asynccontextmanager
from itertools import count
from uuid import uuid4

from redis.asyncio import Redis

from treestroke.api.shared_redis import SharedRedis
from treestroke.service.quotas import STREAMS, QuotaExceeded, Used

STREAMS_A_PERSON = 3
"""Where persons are told apart."""
_HELD_SECONDS = 45
"""How long a place stays taken whose web process does not say any more that it is."""
_RETRY_SECONDS = 10.0
_PREFIX = "treestroke-streams/"
_HOLD = """
local now = tonumber(redis.call('TIME')[1])
redis.call('ZREMRANGEBYSCORE', KEYS[1], '-inf', now)
if ARGV[2] ~= '' and redis.call('ZCARD', KEYS[1]) >= tonumber(ARGV[2]) then return 0 end
for at = 3, #ARGV do redis.call('ZADD', KEYS[1], now + ARGV[1], ARGV[at]) end
redis.call('EXPIRE', KEYS[1], ARGV[1])
return 1
"""
"""A sorted set has the places that a person has taken, by when they are free again; by the clock of Redis."""


class StreamPlaces:
    """Places for streams of each person, ``limit`` in all web processes; 0: any number.

    While Redis is away this process counts its own streams alone, and says afterwards which of them are open.
    """

    def __init__(self, redis: SharedRedis, limit: int) -> None:
        self._redis, self._limit = redis, limit
        self._own: defaultdict[str, set[str]] = defaultdict(set)
        self._process, self._numbers = uuid4().hex, count()

    @asynccontextmanager
    async def taken(self, person: str) -> AsyncIterator[None]:
        """Hold a place of a person until the context ends.

        Raises
        ------
        QuotaExceeded
            There is none left.
        """
        if self._limit and len(self._own[person]) >= self._limit:
            raise QuotaExceeded(STREAMS, self._limit, _RETRY_SECONDS)
        place = f"{self._process}-{next(self._numbers)}"
        self._own[person].add(place)
        try:
            if self._limit and await self._hold(person, [place], self._limit) is False:
                raise QuotaExceeded(STREAMS, self._limit, _RETRY_SECONDS)
            yield
        finally:
            self._own[person].discard(place)
            if not self._own[person]:
                del self._own[person]
            if self._limit:
                self._redis.tell(lambda redis: redis.zrem(_PREFIX + person, place))

    async def used(self, person: str) -> Used:
        """Return how many streams a person has; without a limit, in this process."""
        own = len(self._own.get(person, ()))
        if not self._limit:
            return Used(STREAMS, 0, own)
        return Used(STREAMS, self._limit, await self._redis.ask(lambda redis: _count(redis, person)) or own)

    async def renew(self) -> None:
        """Say that this process's streams are still open; it is soon enough every ten seconds."""
        if self._limit:
            for person, places in list(self._own.items()):
                await self._hold(person, list(places))

    async def _hold(self, person: str, places: Collection[str], limit: int | None = None) -> bool | None:
        """Hold places unless a person has as many as ``limit``; None while Redis is away."""

        async def hold(redis: Redis) -> bool:
            given = _HELD_SECONDS, "" if limit is None else limit, *places
            return bool(await redis.eval(_HOLD, 1, _PREFIX + person, *given))

        return await self._redis.ask(hold)


async def _count(redis: Redis, person: str) -> int:
    seconds, _ = await redis.time()
    return int(await redis.zcount(_PREFIX + person, f"({seconds}", "+inf"))
