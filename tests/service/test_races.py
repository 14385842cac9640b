"""What several ask for in the same moment, on SQLite and on Postgres."""

import json
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from threading import Barrier
from typing import TypeVar

import pytest
from sqlalchemy import func, select
from sqlalchemy.exc import SQLAlchemyError
from tests.api import drawn, sketched
from tests.postgres import KINDS
from tests.rows import add_capture, add_model, find

from treestroke.service import captures, model_request, stored_models
from treestroke.service.failures import code_of
from treestroke.service.model_request import ModelOrder
from treestroke.service.photos import NotFound, Resources
from treestroke.service.stored_models import KeyReused
from treestroke.service.tracing_pool import Overloaded
from treestroke.store.database import Database
from treestroke.store.leases import take_back
from treestroke.store.tables import CapturePhoto, ModelRow, SolveRow, Table

Answer = TypeVar("Answer")
LOST = {"code": "worker_lost", "detail": "lost", "retryable": True}


@pytest.fixture(params=KINDS)
def database_kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def at_once(ask: Callable[[], Answer], *others: Callable[[], Answer], times: int = 1) -> list[Answer]:
    """Ask in the same moment from as many threads; give the answers."""
    asked = (ask, *others) * times
    barrier = Barrier(len(asked))

    def wait_and(ask: Callable[[], Answer]) -> Answer:
        barrier.wait()
        return patient(ask)

    with ThreadPoolExecutor(len(asked)) as threads:
        return list(threads.map(wait_and, asked))


def patient(ask: Callable[[], Answer]) -> Answer:
    """Ask again where the service says that it is busy, as its clients do."""
    while True:
        try:
            return ask()
        except (Overloaded, SQLAlchemyError) as error:
            if isinstance(error, SQLAlchemyError) and code_of(error) != "database_busy":
                raise
        time.sleep(0.05)


def count(database: Database, table: type[Table]) -> int:
    with database.reading() as session:
        return session.scalar(select(func.count()).select_from(table)) or 0


def order(seed: int = 0) -> ModelOrder:
    return model_request.read_order(json.dumps(sketched.request(seed=seed)).encode())


def test_twenty_requests_with_one_key_are_one_model_and_twenty_equal_answers(resources: Resources) -> None:
    found = at_once(lambda: stored_models.accept_model(resources, order(), "key"), times=20)
    assert len({model.id for model in found}) == 1
    assert {(model.row.status, model.row.seq, len(model.parts)) for model in found} == {("queued", 1, 2)}
    assert count(resources.database, ModelRow) == 1


def test_of_different_requests_with_one_key_one_is_taken(resources: Resources) -> None:
    def ask(seed: int) -> str | None:
        try:
            return stored_models.accept_model(resources, order(seed), "key").id
        except KeyReused:
            return None

    found = at_once(*(partial(ask, seed) for seed in range(6)))
    assert sorted(id is None for id in found) == [False, *[True] * 5]
    assert count(resources.database, ModelRow) == 1


def test_a_key_whose_model_was_removed_gets_one_model_row(resources: Resources) -> None:
    first = stored_models.accept_model(resources, order(), "key").id
    with resources.database.writing() as session:
        session.query(ModelRow).delete()
    found = at_once(lambda: stored_models.accept_model(resources, order(), "key").id, times=8)
    assert len(set(found)) == 1
    assert found[0] != first


def test_a_photo_that_is_sent_eight_times_at_once_is_one_of_its_capture(resources: Resources) -> None:
    capture, content = captures.make_capture(resources.database, b"").id, drawn.encoded()
    found = at_once(lambda: captures.add_photo(resources, capture, "a.png", content), times=8)
    assert len({photo.id for photo, _ in found}) == 1
    assert [added for _, added in found].count(True) == 1
    assert count(resources.database, CapturePhoto) == 1


def test_photos_of_one_name_get_names_of_their_own(resources: Resources) -> None:
    capture = captures.make_capture(resources.database, b"").id
    sent = [partial(captures.add_photo, resources, capture, "a.png", drawn.encoded(seed=seed)) for seed in range(4)]
    assert len({photo.name for photo, _ in at_once(*sent)}) == 4


def test_a_capture_that_is_solved_eight_times_at_once_is_solved_once(resources: Resources) -> None:
    capture = add_capture(resources.database, [f"{number}" * 64 for number in range(5)]).id
    found = at_once(lambda: captures.solve(resources, capture), times=8)
    assert len({one.solve and one.solve.id for one in found}) == 1
    assert count(resources.database, SolveRow) == 1


def test_deleting_and_restoring_at_once_leave_one_of_both(database: Database) -> None:
    row = add_model(database)
    stored_models.delete(database, row.id)
    deleted = partial(_tried, partial(stored_models.delete, database, row.id))
    at_once(deleted, partial(_tried, partial(stored_models.restore, database, row.id)), times=4)
    after = find(database, row.id)
    assert (after.deleted is None) or (after.seen is None)
    assert stored_models.restore(database, row.id).row.deleted is None


def _tried(change: Callable[[], object]) -> None:
    with suppress(NotFound):  # it was deleted a moment before
        change()


@pytest.mark.parametrize("round_", range(5))
def test_a_model_that_is_stopped_while_its_worker_is_lost_does_not_go_on(database: Database, round_: int) -> None:
    job = add_model(database, status="running", attempt=1, claim="t", worker="w")

    def lose() -> None:
        with database.writing() as session:
            take_back(session, job, LOST)

    at_once(lambda: stored_models.cancel(database, job.id), lose)
    row = find(database, job.id)
    assert (row.status, row.cancel) in (("canceled", False), ("canceled", True))
