"""Followers of models and captures: one poll, four times a second, serves all event streams of this process."""

import asyncio
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any, Generic, TypeVar

import structlog
from fastapi.concurrency import run_in_threadpool
from sqlalchemy.exc import SQLAlchemyError

from treestroke.service import captures, stored_models
from treestroke.service.captures import StoredCapture
from treestroke.service.stored_models import StoredModel
from treestroke.store.database import Database

_POLL_SECONDS = 0.25
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
    """A request that waits for changes of a model or a capture."""

    def __init__(self, known: Followed) -> None:
        self.kind: type[StoredModel | StoredCapture] = type(known)
        self.id = known.id
        self.version: object = known.version
        self._latest: Followed | None = known
        self._changed = asyncio.Event()

    async def next_change(self) -> Followed | None:
        """Wait until what is followed has changed and return it; None if there will be no more changes."""
        await self._changed.wait()
        self._changed.clear()
        return self._latest

    def update(self, now: Followed | None) -> None:
        """Wake the request if what it follows has changed; None ends its wait for good."""
        if now is None or now.version != self.version:
            self.version = now.version if now else self.version
            self._latest = now
            self._changed.set()


class Watcher:
    """Polls the database for what is followed, while there is anything, and wakes the followers."""

    def __init__(self, database: Database, places: int) -> None:
        self._database, self.places = database, places
        self._followers: set[Follower[Any]] = set()
        self._stopped = asyncio.Event()
        self._polling: asyncio.Task[None] | None = None

    @contextmanager
    def follow(self, known: Followed) -> Iterator[Follower[Followed]]:
        """Follow a model or a capture from a known state on, until the context ends.

        Raises
        ------
        TooManyFollowers
            All places are taken.
        """
        if len(self._followers) >= self.places:
            raise TooManyFollowers
        follower = Follower(known)
        self._followers.add(follower)
        if self._polling is None:
            self._polling = asyncio.create_task(self._run())
        try:
            yield follower
        finally:
            self._followers.discard(follower)

    def stop(self) -> None:
        """End the wait of all followers."""
        self._stopped.set()

    async def _run(self) -> None:
        try:
            while self._followers and not self._stopped.is_set():
                with suppress(TimeoutError):
                    await asyncio.wait_for(self._stopped.wait(), _POLL_SECONDS)
                await self._poll()
        finally:
            self._polling = None
            for follower in self._followers:
                follower.update(None)

    async def _poll(self) -> None:
        followers = list(self._followers)
        versions: dict[type[Any], dict[str, Any]] = defaultdict(dict)
        for follower in followers:
            known = versions[follower.kind]
            same = known.get(follower.id, follower.version) == follower.version
            known[follower.id] = follower.version if same else None  # followers at different states: always report
        try:
            for kind, known in versions.items():
                changed = await run_in_threadpool(_CHANGES[kind], self._database, known)
                for follower in followers:
                    if follower.kind is kind and follower.id in changed:
                        follower.update(changed[follower.id])
        except SQLAlchemyError as error:
            log.warning("poll_failed", error=str(error))
