"""Workers that are gone, as whoever started them says."""

import threading
from collections.abc import Iterator

import pytest
from sqlalchemy import text
from tests.faults.processes import wait_for
from tests.rows import add_model, find

from treestroke.service.dispatch import Dispatcher, record_heartbeat, remove_worker
from treestroke.service.failures import problem_of
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.tables import Worker


def held_by(database: Database, worker: str, attempt: int = 1) -> str:
    record_heartbeat(database, worker, 1)
    return add_model(database, status="running", attempt=attempt, worker=worker, claim="token").id


def test_jobs_of_a_run_that_is_over_queue_again_at_once_and_nobody_else_s(database: Database) -> None:
    over, other = held_by(database, "run-1"), held_by(database, "run-2")
    remove_worker(database, "run-1", problem_of("worker_lost"))
    assert [find(database, id).status for id in (over, other)] == ["queued", "running"]
    with database.reading() as session:
        assert [worker.id for worker in session.query(Worker)] == ["run-2"]


def test_a_job_whose_workers_died_three_times_fails(database: Database) -> None:
    id = held_by(database, "run-1", attempt=3)
    remove_worker(database, "run-1", problem_of("worker_lost"))
    row = find(database, id)
    assert (row.status, row.error and row.error["code"]) == ("failed", "worker_lost")


@pytest.fixture
def sent() -> list[str]:
    return []


@pytest.fixture
def dispatcher(database: Database, sent: list[str]) -> Iterator[Dispatcher]:
    made = Dispatcher(database, Blobs(database.path.parent), sent.append, 0)
    yield made
    made.stop()


def test_a_row_that_cannot_be_read_keeps_no_other_job_from_its_worker(
    database: Database, dispatcher: Dispatcher, sent: list[str]
) -> None:
    broken = held_by(database, "run-1")
    with database.writing() as session:
        session.execute(text("UPDATE models SET settings = '{' WHERE id = :id"), {"id": broken})
    waiting = add_model(database).id
    dispatcher.start()
    wait_for(lambda: waiting in sent, 60, "a message for the job that waits")
    assert sent == [waiting]
    assert [thread.name for thread in threading.enumerate()].count("dispatcher") == 1


def test_a_dispatcher_says_that_it_has_stopped(dispatcher: Dispatcher) -> None:
    assert dispatcher.state.startswith("has stopped")
    dispatcher.start()
    assert dispatcher.state == "ok"
    dispatcher.stop()
    assert dispatcher.state.startswith("has stopped")


def test_a_dispatcher_that_fails_again_and_again_says_so(
    database: Database, dispatcher: Dispatcher, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("treestroke.service.dispatch._OVERDUE_SECONDS", 1.0)
    with database.writing() as session:
        session.execute(text("DROP TABLE workers"))
    dispatcher.start()
    wait_for(lambda: "has finished no round for 1 s" in dispatcher.state, 60, "a state that says so", 0.1)
