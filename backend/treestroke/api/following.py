"""Followers of models: one query, four times a second, serves all event streams of this process."""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import structlog
from fastapi.concurrency import run_in_threadpool
from sqlalchemy.exc import SQLAlchemyError

from treestroke.service.stored_models import StoredModel, Version, find_changed
from treestroke.store.database import Database

_POLL_SECONDS = 0.25
log = structlog.get_logger()


class TooManyFollowers(Exception):
    """The limit of requests that follow models at once is reached."""


class Follower:
    """A request that waits for changes of a model."""

    def __init__(self, model: StoredModel) -> None:
        self.model, self.version = model.row.id, model.version
        self._latest: StoredModel | None = model
        self._changed = asyncio.Event()

    async def next_change(self) -> StoredModel | None:
        """Wait until the model has changed and return it; None if there will be no more changes."""
        await self._changed.wait()
        self._changed.clear()
        return self._latest

    def update(self, model: StoredModel | None) -> None:
        """Wake the request if the model has changed; None ends its wait for good."""
        if model is None or model.version != self.version:
            self.version = model.version if model else self.version
            self._latest = model
            self._changed.set()


class Watcher:
    """Polls the database for the models that are followed, while there are any, and wakes their followers."""

    def __init__(self, database: Database, places: int) -> None:
        self._database, self.places = database, places
        self._followers: set[Follower] = set()
        self._stopped = asyncio.Event()
        self._polling: asyncio.Task[None] | None = None

    @contextmanager
    def follow(self, model: StoredModel) -> Iterator[Follower]:
        """Follow a model from a known state on, until the context ends.

        Raises
        ------
        TooManyFollowers
            All places are taken.
        """
        if len(self._followers) >= self.places:
            raise TooManyFollowers
        follower = Follower(model)
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
        versions: dict[str, Version | None] = {}
        for follower in followers:
            same = versions.get(follower.model, follower.version) == follower.version
            versions[follower.model] = (
                follower.version if same else None
            )  # followers at different states: always report
        try:
            changed = await run_in_threadpool(find_changed, self._database, versions)
        except SQLAlchemyError as error:
            log.warning("poll_failed", error=str(error))
            return
        for follower in followers:
            if follower.model in changed:
                follower.update(changed[follower.model])
