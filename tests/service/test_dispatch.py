"""Workers that are gone, as whoever started them says."""

from tests.rows import add_model, find

from treestroke.service.dispatch import say_alive, say_gone
from treestroke.service.failures import problem_of
from treestroke.store.database import Database
from treestroke.store.tables import Worker


def held_by(database: Database, worker: str, attempt: int = 1) -> str:
    say_alive(database, worker, 1)
    return add_model(database, status="running", attempt=attempt, worker=worker, claim="token").id


def test_jobs_of_a_run_that_is_over_queue_again_at_once_and_nobody_else_s(database: Database) -> None:
    over, other = held_by(database, "run-1"), held_by(database, "run-2")
    say_gone(database, "run-1", problem_of("worker_lost"))
    assert [find(database, id).status for id in (over, other)] == ["queued", "running"]
    with database.reading() as session:
        assert [worker.id for worker in session.query(Worker)] == ["run-2"]


def test_a_job_whose_workers_died_three_times_fails(database: Database) -> None:
    id = held_by(database, "run-1", attempt=3)
    say_gone(database, "run-1", problem_of("worker_lost"))
    row = find(database, id)
    assert (row.status, row.error and row.error["code"]) == ("failed", "worker_lost")
