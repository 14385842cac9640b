"""Followers of models and captures: one poll, four times a second, serves all event streams of this process.

A person has a few streams at most where the service is shared, and they end soon after the key or the session is
revoked that they were opened with.
"""

import asyncio
import time
from collections import defaultdict
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager, suppress
from contextvars import Context
from typing import Any, Generic, TypeVar

import structlog
from fastapi.concurrency import run_in_threadpool
from sqlalchemy.exc import SQLAlchemyError

from treestroke.api.stream_places import StreamPlaces
from treestroke.service import captures, stored_models
from treestroke.service.accounts import find_revoked
from treestroke.service.captures import StoredCapture
from treestroke.service.principals import Principal
from treestroke.service.quotas import Used
from treestroke.service.stored_models import StoredModel
from treestroke.store.database import Database

_POLL_SECONDS = 0.25
_OWNERS_SECONDS = 10.0
"""How often streams are ended whose key or session was revoked, and the places of the others held on to."""
Followed = TypeVar("Followed", StoredModel, StoredCapture)
Changes = Callable[[Database, Mapping[str, Any]], Mapping[str, StoredModel | StoredCapture | None]]
_CHANGES: dict[type[StoredModel | StoredCapture], Changes] = {
    StoredModel: stored_models.find_changed,
    StoredCapture: captures.find_changed,
}
log = structlog.get_logger()


class TooManyFollowers(Exception):
    """The limit of requests that follow at once is reached."""


class Follower(Generic[Followed]):
    """A request that waits for changes of a model or a capture; a stream of events is somebody's (``principal``)."""

    def __init__(self, known: Followed, principal: Principal | None = None) -> None:
        self.principal = principal
        self.kind: type[StoredModel | StoredCapture] = type(known)
        self.id = known.id
        self.version: object = known.version
        self._latest: Followed | None = known
        self._changed, self._ended = asyncio.Event(), False

    async def next_change(self) -> Followed | None:
        """Wait until what is followed has changed and return it; None if there will be no more changes."""
        await self._changed.wait()
        self._changed.clear()
        return None if self._ended else self._latest

    def update(self, now: Followed) -> None:
        """Wake the request if what it follows has changed."""
        if now.version != self.version:
            self.version, self._latest = now.version, now
            self._changed.set()

    def end(self) -> None:
        """End the request's wait for good."""
        self._ended = True
        self._changed.set()


class Watcher:
    """Polls the database for what is followed, while there is anything, and wakes the followers.

    At most ``places`` requests follow at once.
    """

    def __init__(self, database: Database, places: int, streams: StreamPlaces) -> None:
        self._database, self.places, self._streams = database, places, streams
        self._saw_owners = time.monotonic()
        self._followers: set[Follower[Any]] = set()
        self._stopped = asyncio.Event()
        self._polling: asyncio.Task[None] | None = None

    @asynccontextmanager
    async def stream(self, known: Followed, principal: Principal) -> AsyncIterator[Follower[Followed]]:
        """Follow for a person's stream of events, as `follow` does.

        Raises
        ------
        TooManyFollowers
            All places are taken.
        QuotaExceeded
            That person has as many streams as one may have.
        """
        async with self._streams.taken(principal.id):
            with self.follow(known, principal) as follower:
                yield follower

    @contextmanager
    def follow(self, known: Followed, principal: Principal | None = None) -> Iterator[Follower[Followed]]:
        """Follow a model or a capture from a known state on, until the context ends.

        Raises
        ------
        TooManyFollowers
            All places are taken.
        """
        if len(self._followers) >= self.places:
            raise TooManyFollowers
        follower = Follower(known, principal)
        self._followers.add(follower)
        if self._polling is None:
            self._polling = asyncio.create_task(self._run(), context=Context())  # it outlives the request
        try:
            yield follower
        finally:
            self._followers.discard(follower)

    async def streams_of(self, principal: Principal) -> Used:
        """Return how many streams somebody has."""
        return await self._streams.used(principal.id)

    def stop(self) -> None:
        """End the wait of all followers."""
        self._stopped.set()

    async def _run(self) -> None:
        try:
            while self._followers and not self._stopped.is_set():
                with suppress(TimeoutError):
                    await asyncio.wait_for(self._stopped.wait(), _POLL_SECONDS)
                await _try(self._poll)
                if time.monotonic() - self._saw_owners >= _OWNERS_SECONDS:
                    self._saw_owners = time.monotonic()
                    await _try(self.end_revoked)
                    await self._streams.renew()
        finally:
            self._polling = None
            for follower in self._followers:
                follower.end()

    async def end_revoked(self) -> None:
        """End the streams whose key or session was revoked."""
        owned = [(follower, follower.principal.credential) for follower in self._followers if follower.principal]
        if credentials := {credential for _, credential in owned if credential}:
            revoked = await run_in_threadpool(find_revoked, self._database, credentials)
            for follower, credential in owned:
                if credential in revoked:
                    follower.end()

    async def _poll(self) -> None:
        followers = list(self._followers)
        versions: dict[type[Any], dict[str, Any]] = defaultdict(dict)
        for follower in followers:
            known = versions[follower.kind]
            same = known.get(follower.id, follower.version) == follower.version
            known[follower.id] = follower.version if same else None  # followers at different states: always report
        for kind, known in versions.items():
            changed = await run_in_threadpool(_CHANGES[kind], self._database, known)
            for follower in followers:
                if follower.kind is kind and follower.id in changed:
                    now = changed[follower.id]
                    follower.end() if now is None else follower.update(now)


async def _try(step: Callable[[], Awaitable[None]]) -> None:
    """Take a step; where the database is away, the next one comes soon."""
    try:
        await step()
    except SQLAlchemyError as error:
        log.warning("poll_failed", error=str(error))
