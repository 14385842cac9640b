"""Models that are followed: one look at the database, four times a second, serves all streams of this process."""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import structlog
from fastapi.concurrency import run_in_threadpool
from sqlalchemy.exc import SQLAlchemyError

from treestroke.service.stored_models import StoredModel, Version, find_changed
from treestroke.store.database import Database

_LOOK_SECONDS = 0.25
log = structlog.get_logger()


class TooManyFollowers(Exception):
    """As many requests follow models as may at once."""


class Follower:
    """One request that follows a model, from what it saw of it on."""

    def __init__(self, seen: StoredModel) -> None:
        self.model, self.version = seen.row.id, seen.version
        self._latest: StoredModel | None = seen
        self._news = asyncio.Event()

    async def next_change(self) -> StoredModel | None:
        """Wait until the model looks different, and give it; None where nothing more comes."""
        await self._news.wait()
        self._news.clear()
        return self._latest

    def tell(self, seen: StoredModel | None) -> None:
        """Wake the request where this is news to it; None is the end."""
        if seen is None or seen.version != self.version:
            self.version = seen.version if seen else self.version
            self._latest = seen
            self._news.set()


class Watcher:
    """Looks at the models that are followed, as long as any is, and wakes those whose model has changed."""

    def __init__(self, database: Database, places: int) -> None:
        self._database, self.places = database, places
        self._followers: set[Follower] = set()
        self._stopped = asyncio.Event()
        self._looking: asyncio.Task[None] | None = None

    @contextmanager
    def follow(self, seen: StoredModel) -> Iterator[Follower]:
        """Follow a model on, from what was seen of it.

        Raises
        ------
        TooManyFollowers
            All places are taken.
        """
        if len(self._followers) >= self.places:
            raise TooManyFollowers
        follower = Follower(seen)
        self._followers.add(follower)
        if self._looking is None:
            self._looking = asyncio.create_task(self._run())
        try:
            yield follower
        finally:
            self._followers.discard(follower)

    def stop(self) -> None:
        """End everything that is followed."""
        self._stopped.set()

    async def _run(self) -> None:
        try:
            while self._followers and not self._stopped.is_set():
                with suppress(TimeoutError):
                    await asyncio.wait_for(self._stopped.wait(), _LOOK_SECONDS)
                await self._look()
        finally:
            self._looking = None
            for follower in self._followers:
                follower.tell(None)

    async def _look(self) -> None:
        followers = list(self._followers)
        versions: dict[str, Version | None] = {}
        for one in followers:
            versions[one.model] = one.version if versions.get(one.model, one.version) == one.version else None
        try:
            changed = await run_in_threadpool(find_changed, self._database, versions)
        except SQLAlchemyError as error:
            log.warning("look_failed", error=str(error))
            return
        for one in followers:
            if one.model in changed:
                one.tell(changed[one.model])
