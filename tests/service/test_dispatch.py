"""Workers that are gone, as whoever started them says."""

import threading
import time
from collections.abc import Iterator

import pytest
from sqlalchemy import text
from tests.faults.processes import wait_for
from tests.rows import add_capture, add_model, add_solve, find

from treestroke.queue import GROW, SOLVE
from treestroke.service.dispatch import (
    Dispatcher,
    StallDetector,
    holds_jobs,
    queue_figures,
    record_heartbeat,
    remove_worker,
)
from treestroke.service.failures import problem_of
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.tables import SolveRow, Worker


def held_by(database: Database, worker: str, attempt: int = 1) -> str:
    record_heartbeat(database, worker, 1)
    return add_model(database, status="running", attempt=attempt, worker=worker, claim="token").id


def test_a_counter_stalls_only_while_it_is_watched(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr("treestroke.service.dispatch.time.monotonic", lambda: now[0])
    detector, seen = StallDetector[str](), []
    for now[0] in (0.0, 0.5, 60.0, 60.5, 62.0, 64.0, 66.0, 68.0):  # in between, the database was away for a minute
        seen.append(detector.stalled([("stuck", 1)], 10.0))
    assert seen == [*[set()] * 7, {"stuck"}]


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
    made = Dispatcher(database, open_blobs(database, database.path.parent), lambda task, id: sent.append(id), 0)
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


def test_kinds_of_jobs_take_turns_and_each_is_sent_by_its_task(database: Database) -> None:
    told: list[tuple[str, str]] = []
    dispatcher = Dispatcher(
        database, open_blobs(database, database.path.parent), lambda *message: told.append(message), 0
    )
    models = [add_model(database).id for _ in range(5)]
    solves = [add_solve(database, add_capture(database).id).id for _ in range(2)]
    record_heartbeat(database, "worker", 3)
    add_model(database, status="running")
    dispatcher.dispatch()
    turns = [models[0], solves[0], models[1], solves[1], models[2]]
    assert told == [(SOLVE if id in solves else GROW, id) for id in turns]


def test_solves_of_a_worker_that_is_gone_queue_again(database: Database) -> None:
    record_heartbeat(database, "run-1", 1)
    solve = add_solve(database, add_capture(database).id, status="running", attempt=1, worker="run-1", claim="token")
    assert holds_jobs(database, "run-1")
    remove_worker(database, "run-1", problem_of("worker_lost"))
    assert not holds_jobs(database, "run-1")
    with database.reading() as session:
        assert session.get(SolveRow, solve.number).status == "queued"  # type: ignore[union-attr]


def test_the_figures_tell_both_kinds_and_the_oldest_of_all(database: Database) -> None:
    add_model(database)
    capture = add_capture(database).id
    add_solve(database, capture, created=time.time() - 50)
    add_solve(database, capture, status="running")
    figures = {name: value for name, (_, value) in queue_figures(database).items()}
    assert (figures["models_queued"], figures["solves_queued"], figures["solves_running"]) == (1, 1, 1)
    assert 50 <= figures["queue_age_seconds"] < 500


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
