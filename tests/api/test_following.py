import asyncio
from collections.abc import Awaitable, Callable
from contextlib import AsyncExitStack, ExitStack

import pytest
from tests.rows import add_model

from treestroke.api import following
from treestroke.api.following import Follower, TooManyFollowers, Watcher
from treestroke.api.shared_redis import SharedRedis
from treestroke.api.stream_places import StreamPlaces
from treestroke.service import stored_models
from treestroke.service.principals import Principal
from treestroke.service.quotas import QuotaExceeded
from treestroke.service.stored_models import StoredModel
from treestroke.store.database import Database

ANN, BEN = (Principal(f"usr_{name}", "oaks", name, "member", credential=f"key_{name}") for name in ("ann", "ben"))
SECONDS = 60.0
"""Emergency exit of what is waited for."""


def follow(database: Database, places: int, story: Callable[[Watcher], Awaitable[None]], streams: int = 0) -> None:
    """Run a story in which models are followed."""

    async def run() -> None:
        watcher = Watcher(database, places, StreamPlaces(SharedRedis(""), streams))
        await asyncio.wait_for(story(watcher), 3 * SECONDS)

    asyncio.run(run())


async def news(follower: Follower) -> StoredModel | None:
    return await asyncio.wait_for(follower.next_change(), SECONDS)


def added(database: Database) -> StoredModel:
    return stored_models.find_model(database, add_model(database).id)


def test_a_change_wakes_those_who_follow_that_model_and_nobody_else(database: Database) -> None:
    first, second = added(database), added(database)

    async def story(watcher: Watcher) -> None:
        with ExitStack() as places:
            one, same, other = (places.enter_context(watcher.follow(seen)) for seen in (first, first, second))
            stored_models.change(database, first.row.id, {"name": "Oak"})
            for told in [await news(one), await news(same)]:
                assert told is not None
                assert told.row.name == "Oak"
            with pytest.raises(TimeoutError):
                await asyncio.wait_for(other.next_change(), 0.6)

    follow(database, 3, story)


def test_who_queues_is_told_a_new_place_and_who_comes_late_what_changed_since_it_looked(database: Database) -> None:
    first, second = added(database), added(database)
    assert second.queue_position == 2

    async def story(watcher: Watcher) -> None:
        with watcher.follow(second) as early:
            stored_models.cancel(database, first.row.id)
            told = await news(early)
            with watcher.follow(second) as late:  # it looked before the other left the queue
                assert [one and one.queue_position for one in (told, await news(late))] == [1, 1]

    follow(database, 2, story)


def test_a_place_is_free_again_when_its_request_is_over(database: Database) -> None:
    seen = added(database)

    async def story(watcher: Watcher) -> None:
        for _ in range(2):
            with watcher.follow(seen), pytest.raises(TooManyFollowers), watcher.follow(seen):
                pass

    follow(database, 1, story)


def test_whoever_follows_is_told_the_end_when_the_service_stops(database: Database) -> None:
    seen = added(database)

    async def story(watcher: Watcher) -> None:
        with watcher.follow(seen) as before:
            await asyncio.sleep(0)
            watcher.stop()
            assert await news(before) is None
        with watcher.follow(seen) as after:
            assert await news(after) is None

    follow(database, 1, story)


def test_whoever_follows_a_model_that_is_removed_is_told_the_end(database: Database) -> None:
    seen = added(database)

    async def story(watcher: Watcher) -> None:
        with watcher.follow(seen) as follower:
            with database.writing() as session:
                session.delete(session.merge(seen.row))
            assert await news(follower) is None

    follow(database, 1, story)


def test_a_person_has_a_few_streams_and_others_have_theirs(database: Database) -> None:
    seen = added(database)

    async def story(watcher: Watcher) -> None:
        async with AsyncExitStack() as places:
            for _ in range(3):
                await places.enter_async_context(watcher.stream(seen, ANN))
            with pytest.raises(QuotaExceeded, match="streams"):
                await places.enter_async_context(watcher.stream(seen, ANN))
            await places.enter_async_context(watcher.stream(seen, BEN))
            places.enter_context(watcher.follow(seen))  # who waits for an answer has no stream
            assert ((await watcher.streams_of(ANN)).used, (await watcher.streams_of(BEN)).used) == (3, 1)
        async with watcher.stream(seen, ANN):
            assert (await watcher.streams_of(ANN)).used == 1

    follow(database, 9, story, streams=3)


def test_streams_end_whose_key_was_revoked_whatever_else_happens_to_the_model(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen, asked = added(database), []

    def find_revoked(_: Database, credentials: set[str]) -> set[str]:
        asked.append(set(credentials))
        return {"key_ann"}

    async def story(watcher: Watcher) -> None:
        async with watcher.stream(seen, ANN) as revoked, watcher.stream(seen, BEN) as stays:
            while await news(revoked) is not None:
                pass
            stored_models.change(database, seen.id, {"name": "Oak"})
            assert await news(stays) is not None
            revoked.update(seen)
            assert await news(revoked) is None

    monkeypatch.setattr(following, "find_revoked", find_revoked)
    monkeypatch.setattr(following, "_OWNERS_SECONDS", 0.0)
    follow(database, 9, story)
    assert asked[0] == {"key_ann", "key_ben"}
