"""Workers that are gone, as whoever started them says."""

import threading
import time
from pathlib import Path

import pytest
from sqlalchemy import text
from tests.faults.processes import wait_for
from tests.postgres import PostgresServer
from tests.rows import Messages, add_capture, add_model, add_solve, find

from treestroke.service.dispatch import (
    Dispatcher,
    StallDetector,
    holds_jobs,
    queue_figures,
    record_heartbeat,
    remove_worker,
)
from treestroke.service.engine_version import engine_version
from treestroke.service.failures import problem_of
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.scope import SERVICE, Scope
from treestroke.store.tables import SolveRow, Worker


def held_by(database: Database, worker: str, attempt: int = 1) -> str:
    record_heartbeat(database, worker, 1, "treestroke")
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
def messages() -> Messages:
    return Messages()


@pytest.fixture
def dispatcher(database: Database, messages: Messages) -> Dispatcher:
    made = Dispatcher(database.of(SERVICE), open_blobs(database, database.path.parent), messages, 0, most_running=2)
    made.lead()
    return made


def test_a_row_that_cannot_be_read_keeps_no_other_job_from_its_worker(
    database: Database, dispatcher: Dispatcher, messages: Messages
) -> None:
    broken = held_by(database, "run-1")
    with database.writing() as session:
        session.execute(text("UPDATE models SET settings = '{' WHERE id = :id"), {"id": broken})
    add_model(database)
    dispatcher.start()
    wait_for(lambda: messages.sent, 60, "a message for the job that waits")
    assert [thread.name for thread in threading.enumerate()].count("dispatcher") == 1
    dispatcher.stop()
    assert messages.sent == 1


def test_messages_fill_all_slots_and_one_more_each_and_no_more_than_jobs_wait(
    database: Database, dispatcher: Dispatcher, messages: Messages
) -> None:
    record_heartbeat(database, "run-1", 2, "treestroke")
    own = [database.of(Scope(team, "ann")) for team in ("oaks", "elms", "ashes")]
    add_model(own[0])
    add_solve(own[1], add_capture(own[1]).id)
    dispatcher.dispatch()
    assert messages.sent == 2
    for team in own:
        for _ in range(5):
            add_model(team)
    add_model(own[0], status="running")
    dispatcher.dispatch()
    assert messages.waiting() == 3  # of four hands, one of which is busy
    messages.taken += 1  # and was lost on its way
    dispatcher.dispatch()
    assert messages.waiting() == 3


@pytest.mark.parametrize("worker", [None, "another engine"])
def test_nothing_is_said_of_jobs_that_no_worker_may_take(
    database: Database, dispatcher: Dispatcher, messages: Messages, worker: str | None
) -> None:
    if worker is not None:
        record_heartbeat(database, "run-1", 2, worker)
    add_model(database)
    dispatcher.dispatch()
    assert messages.sent == 0


def test_a_team_that_has_as_many_jobs_under_way_as_it_may_gets_no_messages(
    database: Database, dispatcher: Dispatcher, messages: Messages
) -> None:
    record_heartbeat(database, "run-1", 4, "treestroke")
    for status in ("running", "queued", "queued"):
        add_model(database, status=status)
    dispatcher.dispatch()
    assert messages.sent == 1


def test_jobs_of_an_engine_that_nobody_has_any_more_are_done_by_another(
    database: Database, dispatcher: Dispatcher, monkeypatch: pytest.MonkeyPatch
) -> None:
    record_heartbeat(database, "run-1", 1, "old but alive")
    ids = {engine: add_model(database, engine=engine).id for engine in ("gone", "old but alive")}
    running = add_model(database, engine="gone", status="running").id
    dispatcher.take_over()
    assert find(database, ids["gone"]).engine == "gone"  # its worker may be about to start
    monkeypatch.setattr("treestroke.service.dispatch.LEASE_SECONDS", 0.0)
    dispatcher.take_over()
    engines = [find(database, id).engine for id in (*ids.values(), running)]
    assert engines == [engine_version(), "old but alive", "gone"]


def test_a_broker_that_does_not_answer_is_asked_again_later(
    database: Database, dispatcher: Dispatcher, messages: Messages, monkeypatch: pytest.MonkeyPatch
) -> None:
    record_heartbeat(database, "run-1", 1, "treestroke")
    add_model(database)
    with monkeypatch.context() as away:
        away.setattr(messages, "waiting", lambda: 1 / 0)
        dispatcher.dispatch()
        assert not dispatcher.broker_accepts
    dispatcher.dispatch()
    assert messages.sent == 0
    monkeypatch.setattr(dispatcher, "_no_messages_until", 0.0)
    dispatcher.dispatch()
    assert (messages.sent, dispatcher.broker_accepts) == (1, True)


def test_solves_of_a_worker_that_is_gone_queue_again(database: Database) -> None:
    record_heartbeat(database, "run-1", 1, "treestroke")
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
    dispatcher.stop()


def test_of_two_dispatchers_on_one_database_the_second_stands_by(
    postgres: PostgresServer, tmp_path: Path, messages: Messages
) -> None:
    database = Database(tmp_path, postgres.fresh_with_tables()).of(SERVICE)
    record_heartbeat(database, "run-1", 1, "treestroke")
    add_model(database.of(Scope("oaks", "ann")), parts={})
    first, second = (Dispatcher(database, open_blobs(database, tmp_path), messages, 0) for _ in range(2))
    first.lead()
    second.start()
    wait_for(lambda: second.state == "standby", 60, "the second's state")
    second.dispatch()
    assert messages.sent == 0
    first.dispatch()
    assert messages.sent == 1
    first._leadership.release()  # as where its process ends
    wait_for(lambda: second.state == "ok", 60, "the second's lead")
    second.stop()
    database.close()
