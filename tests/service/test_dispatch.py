"""Workers that are gone, as another one of their host finds them."""

from tests.rows import add_model, find

from treestroke.service.dispatch import bury_dead, say_alive
from treestroke.store.database import Database
from treestroke.store.tables import Worker


def held_by(database: Database, worker: str, attempt: int = 1) -> str:
    say_alive(database, worker, 1)
    return add_model(database, status="running", attempt=attempt, worker=worker, claim="token").id


def test_jobs_of_dead_workers_of_this_host_queue_again_at_once(database: Database) -> None:
    dead, alive, elsewhere = (held_by(database, name) for name in ("here/7/a", "here/8/b", "there/7/c"))
    bury_dead(database, "here", lambda process: process == 8)
    assert [find(database, id).status for id in (dead, alive, elsewhere)] == ["queued", "running", "running"]
    with database.reading() as session:
        assert {worker.id for worker in session.query(Worker)} == {"here/8/b", "there/7/c"}


def test_a_job_whose_workers_died_three_times_fails(database: Database) -> None:
    id = held_by(database, "here/7/a", attempt=3)
    bury_dead(database, "here", lambda _: False)
    row = find(database, id)
    assert (row.status, row.error and row.error["code"]) == ("failed", "worker_lost")


def test_a_host_s_name_may_have_strokes_of_its_own(database: Database) -> None:
    id = held_by(database, "a/b/7/x")
    bury_dead(database, "a/b", lambda _: False)
    assert find(database, id).status == "queued"
