import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path
from typing import NamedTuple

import hypothesis
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy import delete, select, update
from tests.plans import planned, scans
from tests.postgres import PostgresServer
from tests.rows import add_capture, add_model, add_solve, claim, model_row

from treestroke.store import leases
from treestroke.store.database import Database
from treestroke.store.scope import SERVICE, Scope
from treestroke.store.tables import AnyJob, ModelRow, Turn
from treestroke.store.turns import wait_for_turn

ENGINE = "treestroke"
HOLDER = leases.Holder("t", "w", ENGINE)


@pytest.fixture
def database(database: Database) -> Database:
    """The database, as the service itself sees it."""
    return database.of(SERVICE)


def claimed(database: Database, most_running: int = 0) -> AnyJob | None:
    with database.writing() as session:
        return leases.claim_next(session, HOLDER, most_running)


def all_claimed(database: Database, most_running: int = 0) -> list[AnyJob]:
    return list(iter(lambda: claimed(database, most_running), None))


def ask(database: Database, team: str, maker: str = "usr_1", **values: object) -> ModelRow:
    return add_model(database.of(Scope(team, maker)), parts={}, **values)


def ask_for(database: Database, number: int, team: str) -> None:
    with database.writing() as session:
        session.add_all(model_row(team=team, maker="usr_1") for _ in range(number))


def test_teams_take_turns_and_then_the_people_of_each(database: Database) -> None:
    asked = [("oaks", "ann")] * 4 + [("oaks", "ben")] * 2 + [("elms", "eve")] * 2
    for team, maker in asked:
        ask(database, team, maker)
    assert [(job.team, job.maker, job.number) for job in all_claimed(database)] == [
        ("elms", "eve", 7),
        ("oaks", "ann", 1),
        ("elms", "eve", 8),
        ("oaks", "ben", 5),
        ("oaks", "ann", 2),
        ("oaks", "ben", 6),
        ("oaks", "ann", 3),
        ("oaks", "ann", 4),
    ]


def test_whoever_comes_late_is_served_before_those_who_were_served_meanwhile(database: Database) -> None:
    ask_for(database, 100, "oaks")
    for _ in range(10):
        claimed(database)
    late = ask(database, "elms")
    assert claim(database, late).team == "elms"


def test_models_and_solves_of_a_person_take_turns(database: Database) -> None:
    own = database.of(Scope("oaks", "ann"))
    for _ in range(4):
        add_model(own)
    for _ in range(2):
        add_solve(own, add_capture(own).id)
    kinds = ["M" if isinstance(job, ModelRow) else "S" for job in all_claimed(database)]
    assert kinds == ["M", "S", "M", "S", "M", "M"]


def test_a_worker_takes_jobs_of_its_own_engine_alone(database: Database) -> None:
    old, new = ask(database, "oaks", engine="treestroke 1"), ask(database, "oaks")
    assert [job.id for job in all_claimed(database)] == [new.id]
    with database.writing() as session:
        leases.change_engine(session, "treestroke 1", ENGINE)
    taken_over = claimed(database)
    assert taken_over is not None
    assert (taken_over.id, taken_over.engine, taken_over.seq) == (old.id, ENGINE, 3)  # viewers are shown both changes


def test_a_team_has_no_more_jobs_under_way_than_it_may(database: Database) -> None:
    for team in ("oaks", "oaks", "oaks", "elms"):
        ask(database, team)
    under_way = all_claimed(database, most_running=2)
    assert [job.team for job in under_way] == ["elms", "oaks", "oaks"]
    with database.writing() as session:
        assert leases.end(session, under_way[1], "canceled", None)
    assert [job.team for job in all_claimed(database, most_running=2)] == ["oaks"]


def test_turns_outlast_the_jobs_that_were_served(database: Database) -> None:
    for _ in range(2):
        ask(database, "elms")
    assert claimed(database) is not None
    with database.writing() as session:
        session.execute(delete(ModelRow).where(ModelRow.status == "running"))
    late = ask(database, "oaks")
    assert claim(database, late).team == "oaks"


class Order(NamedTuple):
    """A job of a person asked for, or the next one claimed where there is no team."""

    team: str
    maker: str


orders = st.lists(
    st.one_of(
        st.builds(Order, st.sampled_from(["a", "b", "c"]), st.sampled_from(["x", "y"])),
        st.just(Order("", "")),
    ),
    max_size=40,
)


@hypothesis.settings(max_examples=25)
@given(orders=orders)
def test_of_those_who_wait_whoever_was_served_longest_ago_is_next(orders: list[Order], opened: Database) -> None:
    served: dict[tuple[str, ...], int] = {}
    waiting: list[tuple[str, str, int]] = []
    with opened.writing() as session:
        for turn, (team, maker) in enumerate([*orders, *[Order("", "")] * len(orders)], 1):
            if team:
                row = model_row(team=team, maker=maker)
                session.add(row)
                session.flush()
                waiting.append((team, maker, row.number))
                continue
            job, first = leases.claim_next(session, HOLDER), next_of(waiting, served)
            assert (None if job is None else (job.team, job.maker, job.number)) == first
            if first is not None:
                waiting.remove(first)
                served[first[:1]] = served[first[:2]] = turn
        assert waiting == []
        session.rollback()


def next_of(waiting: list[tuple[str, str, int]], served: dict[tuple[str, ...], int]) -> tuple[str, str, int] | None:
    """Give the next job, by the turns in which teams, and people of teams, were served last."""

    def place(job: tuple[str, str, int]) -> tuple[int, str, int, str, int]:
        return served.get(job[:1], 0), job[0], served.get(job[:2], 0), *job[1:]

    return min(waiting, key=place, default=None)


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Database]:
    """A database on SQLite that tests leave as it was."""
    database = Database(tmp_path_factory.mktemp("turns")).of(SERVICE)
    database.migrate()
    yield database
    database.close()


def test_no_job_of_a_team_with_a_hundred_begins_between_another_s_request_and_its_beginning(
    database: Database,
) -> None:
    ask_for(database, 100, "oaks")
    late = ask(database, "elms", status="canceled")
    under_way, served = threading.Barrier(3), threading.Event()

    def work(_: int) -> None:
        assert claimed(database) is not None
        under_way.wait()
        while not served.is_set():
            job = claimed(database)
            assert job is not None
            if job.team == "elms":
                served.set()

    with ThreadPoolExecutor(2) as pool:
        workers = pool.map(work, range(2))
        under_way.wait()
        with database.writing() as session:
            before = wait_for_turn(session).last
            session.execute(update(ModelRow).where(ModelRow.id == late.id).values(status="queued"))
        list(workers)
    with database.reading() as session:
        assert session.scalars(select(Turn.last).where(Turn.team == "elms")).all() == [before + 1]


def test_a_claim_passes_over_a_row_that_somebody_else_changes(postgres_database: Database) -> None:
    first, second = ask(postgres_database, "oaks"), ask(postgres_database, "oaks")
    with postgres_database.writing() as session:
        session.execute(select(ModelRow.id).where(ModelRow.id == first.id).with_for_update())
        assert claim(postgres_database, second).id == second.id
    assert claim(postgres_database, first).id == first.id


def test_claims_follow_each_other(postgres_database: Database) -> None:
    """Whoever claims at the same time waits, so that it knows whom the other one serves."""
    for team in ("oaks", "oaks", "elms"):
        ask(postgres_database, team)
    with ThreadPoolExecutor(1) as pool:
        with postgres_database.writing() as session:
            first = leases.claim_next(session, HOLDER)
            other = pool.submit(claimed, postgres_database)
            with pytest.raises(TimeoutError):
                other.result(0.2)
        second = other.result(60)
    assert [job and job.team for job in (first, second)] == ["elms", "oaks"]


@pytest.fixture
def postgres_database(postgres: PostgresServer, tmp_path: Path) -> Iterator[Database]:
    database = Database(tmp_path, postgres.fresh_with_tables()).of(SERVICE)
    yield database
    database.close()


def test_a_claim_reads_few_rows_however_many_there_are(opened: Database) -> None:
    few, many = steps_of_claim(opened, 10), steps_of_claim(opened, 1000)
    assert many < 1.5 * few
    with planned() as plans, opened.writing() as session:
        leases.claim_next(session, HOLDER)
        session.rollback()
    assert scans(plans) == []


def steps_of_claim(database: Database, number: int) -> int:
    """Count the steps of SQLite's machine for a claim beside so many queued and finished jobs of each of two people."""
    steps = count()
    with database.writing() as session:
        for maker in ("x", "y"):
            session.add_all(model_row(team="oaks", maker=maker) for _ in range(number))
            session.add_all(model_row(team="oaks", maker=maker, status="succeeded") for _ in range(number))
        session.flush()
        connection = session.connection().connection.driver_connection
        assert connection is not None
        connection.set_progress_handler(lambda: next(steps) < 0, 1)
        assert leases.claim_next(session, HOLDER) is not None
        connection.set_progress_handler(None, 0)
        session.rollback()
    return next(steps)
