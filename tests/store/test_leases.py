import threading
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from tests.rows import add_capture, add_model, add_solve, claim, find

from treestroke.store import leases
from treestroke.store.database import Database
from treestroke.store.queries import files
from treestroke.store.scope import LOCAL
from treestroke.store.tables import TERMINAL, ModelRow, SolveRow

LOST = {"code": "worker_lost", "detail": "lost", "retryable": True}
GONE = {"code": "engine_error", "detail": "broke", "retryable": False}
GLB = {"tree.glb": ("c" * 64, 7)}


def claimed(database: Database, token: str = "t", worker: str = "w") -> ModelRow | None:
    """Claim the model that is next."""
    with database.writing() as session:
        job = leases.claim_next(session, leases.Holder(token, worker, "treestroke"))
    assert not isinstance(job, SolveRow)
    return job


def again(database: Database) -> Database:
    """Open the same database once more, by connections of its own."""
    return Database(database.path.parent, database.url).of(LOCAL)


def changed(database: Database, change: Callable[..., Any], *arguments: Any, **values: Any) -> Any:
    with database.writing() as session:
        return change(session, *arguments, **values)


def canceled(database: Database, id: str) -> None:
    with database.writing() as session:
        leases.cancel(session, ModelRow, ModelRow.id == id)


def started(database: Database, **values: Any) -> ModelRow:
    """Give a model under way, as its worker holds it."""
    return claim(database, add_model(database, **values))


def taken_over(database: Database) -> tuple[ModelRow, ModelRow]:
    """Give the same job as a stale worker and as the present one hold it."""
    stale = started(database)
    assert changed(database, leases.take_back, stale, LOST)
    return stale, claim(database, stale, "u", "other")


def seen(database: Database, id: str) -> tuple[str, int, int]:
    row = find(database, id)
    return row.status, row.attempt, row.seq


def test_a_claim_begins_an_attempt_afresh(database: Database) -> None:
    row = add_model(database, phase="grow", phase_fraction=0.5, progress=0.4, attempt=1)
    job = claim(database, row, "token", "worker")
    assert (job.status, job.attempt, job.claim, job.worker) == ("running", 2, "token", "worker")
    assert job.engine == row.engine
    assert (job.phase, job.phase_fraction, job.progress) == (None, 0.0, 0.0)
    assert (job.beat, job.seq, job.started is None) == (row.beat + 1, row.seq + 1, False)


@pytest.mark.parametrize("status", ["running", *TERMINAL])
def test_only_a_queued_job_is_claimed(database: Database, status: str) -> None:
    row = add_model(database, status=status)
    assert claimed(database) is None
    assert seen(database, row.id) == (status, 0, 1)


def test_eight_workers_claim_each_of_fifty_jobs_once(database: Database) -> None:
    ids = [add_model(database).id for _ in range(50)]
    barrier, wins = threading.Barrier(8), Counter[str]()

    def work(at: int) -> None:
        own = again(database)
        barrier.wait()
        while (job := claimed(own, f"t{at}", f"w{at}")) is not None:
            wins[job.id] += 1
        own.close()

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(work, range(8)))
    assert wins == dict.fromkeys(ids, 1)
    assert {find(database, id).attempt for id in ids} == {1}


def test_a_beat_keeps_the_lease_and_tells_the_progress(database: Database) -> None:
    job = started(database)
    assert changed(database, leases.heartbeat, job, "grow", 0.5, 0.3) is False
    row = find(database, job.id)
    assert (row.beat, row.seq, row.phase, row.phase_fraction, row.progress) == (
        job.beat + 1,
        job.seq + 1,
        "grow",
        0.5,
        0.3,
    )


def test_a_beat_hears_that_it_is_to_stop(database: Database) -> None:
    job = started(database)
    canceled(database, job.id)
    assert changed(database, leases.heartbeat, job, "grow", 0.5, 0.3) is True


STALE: dict[str, tuple[Callable[..., Any], tuple[Any, ...], Any]] = {
    "beat": (leases.heartbeat, ("grow", 0.5, 0.3), None),
    "add a file": (leases.add_file, ("tree.glb", "c" * 64, 7), False),
    "succeed": (leases.succeed, ({"report": 1}, GLB), False),
    "fail": (leases.end, ("failed", GONE), False),
    "cancel": (leases.end, ("canceled", None), False),
    "be lost": (leases.take_back, (LOST,), False),
}


@pytest.mark.parametrize("name", STALE)
def test_a_stale_attempt_changes_nothing(database: Database, name: str) -> None:
    change, arguments, wanted = STALE[name]
    stale, now = taken_over(database)
    assert changed(database, change, stale, *arguments) is wanted
    row = find(database, now.id)
    assert (row.status, row.attempt, row.beat, row.seq, row.claim) == ("running", 2, now.beat, now.seq, "u")
    with database.reading() as session:
        assert files(session, [now.id])[now.id] == {}


@pytest.mark.parametrize("name", STALE)
@pytest.mark.parametrize("status", TERMINAL)
def test_a_job_that_is_over_stays_as_it_is(database: Database, name: str, status: Any) -> None:
    change, arguments, wanted = STALE[name]
    job = started(database)
    if status == "succeeded":
        assert changed(database, leases.succeed, job, {"report": 0}, {})
    else:
        assert changed(database, leases.end, job, status, None)
    before = seen(database, job.id)
    assert changed(database, change, job, *arguments) is wanted
    canceled(database, job.id)
    assert seen(database, job.id) == before
    assert before[0] == status


def test_a_success_publishes_report_and_files_together(database: Database) -> None:
    job = started(database)
    assert changed(database, leases.succeed, job, {"report": 1}, GLB)
    row = find(database, job.id)
    assert (row.status, row.progress, row.report) == ("succeeded", 1.0, {"report": 1})
    assert (row.claim, row.worker, row.phase, row.finished is None) == (None, None, None, False)
    with database.reading() as session:
        assert {name: (one.blob, one.bytes) for name, one in files(session, [job.id])[job.id].items()} == GLB


def test_a_file_is_added_while_a_job_is_under_way_and_may_be_replaced(database: Database) -> None:
    job = started(database)
    for size in (5, 6):
        assert changed(database, leases.add_file, job, "growth.json", "d" * 64, size, preview_seq=9)
    assert find(database, job.id).preview_seq == 9
    with database.reading() as session:
        assert files(session, [job.id])[job.id]["growth.json"].bytes == 6


def test_a_lost_job_queues_again_until_its_attempts_are_used_up(database: Database) -> None:
    id = add_model(database).id
    statuses = []
    for _ in range(leases.MAX_ATTEMPTS):
        job = claimed(database)
        assert job is not None
        assert changed(database, leases.take_back, job, LOST)
        statuses.append(find(database, id).status)
    assert statuses == ["queued", "queued", "failed"]
    assert (find(database, id).error, find(database, id).attempt) == (LOST, 3)
    assert claimed(database) is None


def test_a_job_that_has_beaten_since_is_not_lost(database: Database) -> None:
    job = started(database)
    changed(database, leases.heartbeat, job, "grow", 0.5, 0.3)
    assert changed(database, leases.take_back, job, LOST) is False
    assert find(database, job.id).status == "running"


def test_a_lost_job_that_was_to_be_stopped_is_canceled(database: Database) -> None:
    job = started(database)
    canceled(database, job.id)
    assert changed(database, leases.take_back, find(database, job.id), LOST)
    assert find(database, job.id).status == "canceled"


def test_a_cancel_just_before_a_job_is_taken_back_is_not_forgotten(database: Database) -> None:
    job = started(database)  # as the dispatcher read it
    canceled(database, job.id)
    assert changed(database, leases.take_back, job, LOST)
    assert find(database, job.id).status == "canceled"


def test_a_queued_job_is_canceled_at_once(database: Database) -> None:
    row = add_model(database)
    canceled(database, row.id)
    assert find(database, row.id).status == "canceled"
    assert claimed(database) is None


def test_a_job_that_is_to_be_stopped_cannot_succeed(database: Database) -> None:
    job = started(database)
    canceled(database, job.id)
    assert changed(database, leases.succeed, job, {}, GLB) is False
    assert changed(database, leases.end, job, "canceled", None) is True
    with database.reading() as session:
        assert files(session, [job.id])[job.id] == {}


def test_a_cancel_after_the_success_comes_too_late(database: Database) -> None:
    job = started(database)
    assert changed(database, leases.succeed, job, {}, GLB)
    canceled(database, job.id)
    assert find(database, job.id).status == "succeeded"


@pytest.mark.parametrize("round_", range(10))
def test_cancel_and_success_at_once_end_in_one_of_both(database: Database, round_: int) -> None:
    job, barrier, other = started(database), threading.Barrier(2), again(database)
    results = []

    def publish() -> None:
        barrier.wait()
        with other.writing() as session:
            results.append(leases.succeed(session, job, {}, GLB) or leases.end(session, job, "canceled", None))

    thread = threading.Thread(target=publish)
    thread.start()
    barrier.wait()
    canceled(database, job.id)
    thread.join()
    other.close()
    row = find(database, job.id)
    with database.reading() as session:
        assert (row.status, set(files(session, [job.id])[job.id])) in (("succeeded", set(GLB)), ("canceled", set()))
    assert results == [True]


def test_a_solve_is_held_by_the_same_lease(database: Database) -> None:
    row = add_solve(database, add_capture(database).id)
    lost = claim(database, row)
    assert changed(database, leases.heartbeat, lost, "mapping", 0.5, 0.7) is False
    assert changed(database, leases.take_back, lost, LOST) is False  # it has beaten since
    with database.reading() as session:
        beaten = session.get(SolveRow, row.number)
    assert changed(database, leases.take_back, beaten, LOST)
    now = claim(database, row)
    assert now.attempt == 2
    assert changed(database, leases.complete, lost, structure="a" * 64) is False
    assert changed(database, leases.complete, now, structure="b" * 64) is True
    with database.reading() as session:
        over = session.get(SolveRow, row.number)
    assert over is not None
    assert (over.status, over.structure, over.progress, over.claim) == ("succeeded", "b" * 64, 1.0, None)


def test_only_the_chosen_jobs_of_one_table_are_canceled(database: Database) -> None:
    model, captures = add_model(database), [add_capture(database).id for _ in range(2)]
    solves = [add_solve(database, capture) for capture in captures]
    with database.writing() as session:
        leases.cancel(session, SolveRow, SolveRow.capture == captures[0])
    with database.reading() as session:
        assert [session.get(SolveRow, solve.number).status for solve in solves] == ["canceled", "queued"]  # type: ignore[union-attr]
    assert find(database, model.id).status == "queued"
