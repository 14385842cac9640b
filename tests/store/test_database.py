import os
import shutil
import sqlite3
import subprocess
import sys
import threading
import time
from contextlib import closing, suppress
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from sqlalchemy import create_engine, delete, inspect, select
from sqlalchemy.exc import OperationalError
from tests.postgres import SQLITE_ONLY
from tests.promises import kept
from tests.rows import add_model, find
from tests.running import BACKEND

from treestroke.service.failures import code_of
from treestroke.store.database import Database
from treestroke.store.scope import LOCAL
from treestroke.store.tables import File, ModelPart, ModelRow, PhotoRow, Replay, Table, Worker


@pytest.fixture
def empty_url(database_kind: str, request: pytest.FixtureRequest) -> str:
    """The URL of a Postgres without tables; nothing for SQLite."""
    return request.getfixturevalue("postgres_url") if database_kind == "postgres" else ""


def test_the_tables_are_made_from_nothing(tmp_path: Path, empty_url: str) -> None:
    database = Database(tmp_path, empty_url).of(LOCAL)
    assert not database.current()
    database.check()
    database.migrate()
    assert database.current()
    database.check()
    assert database.fault() == ""
    with database.reading() as session:
        assert set(Table.metadata.tables) < set(inspect(session.connection()).get_table_names())
    database.close()


def test_migrating_twice_changes_nothing(database: Database) -> None:
    row = add_model(database)
    database.migrate()
    assert find(database, row.id).number == row.number


def test_processes_may_migrate_at_once(tmp_path: Path, empty_url: str) -> None:
    code = "import sys; from treestroke.store.database import *; Database(Path(sys.argv[1]), sys.argv[2]).migrate()"
    environment = {**os.environ, "PYTHONPATH": str(BACKEND)}
    command = [sys.executable, "-c", code, str(tmp_path), empty_url]
    processes = [subprocess.Popen(command, env=environment) for _ in range(3)]
    assert [process.wait(300) for process in processes] == [0, 0, 0]
    database = Database(tmp_path, empty_url).of(LOCAL)
    assert database.current()
    database.close()


def test_the_migrations_make_the_tables_that_the_program_knows(database: Database) -> None:
    compared = {"compare_type": True, "compare_server_default": not database.url}  # Postgres cannot compare JSON
    with database.reading() as session:
        context = MigrationContext.configure(session.connection(), opts=compared)
        assert compare_metadata(context, Table.metadata) == []


def test_a_folder_of_the_program_before_is_brought_up_to_date_with_all_its_rows(tmp_path: Path) -> None:
    database = Database(tmp_path).of(LOCAL)
    at_revision(database, "0004")
    with closing(sqlite3.connect(database.path)) as plain:
        plain.execute(
            "INSERT INTO models (id, name, settings, seed, engine, fingerprint, status, phase_fraction, progress, seq,"
            " attempt, beat, created, deleted) VALUES"
            " ('mdl_1', 'Oak', '{}', 7, 'treestroke 0.1.0', 'f', 'succeeded', 0, 1, 1, 1, 0, 5.0, 6.0)"
        )
        plain.execute(
            "INSERT INTO photos (id, sha256, width, height, blob, created) VALUES ('pho_1', 's', 2, 3, 'b', 5.0)"
        )
        plain.execute("INSERT INTO replays (key, fingerprint, model, created) VALUES ('k', 'f', 'mdl_1', 5.0)")
        plain.commit()
    database.migrate()
    assert database.current()
    row = find(database, "mdl_1")
    assert (row.name, row.deleted, row.seen) == ("Oak", 6.0, None)
    with database.reading() as session:
        assert [(photo.id, photo.width, photo.seen) for photo in session.scalars(select(PhotoRow))] == [
            ("pho_1", 2, None)
        ]
        assert [(replay.key, replay.seen) for replay in session.scalars(select(Replay))] == [("k", None)]
    database.close()


def at_revision(database: Database, revision: str) -> None:
    """Make the tables as an older program had them."""
    settings = Config()
    settings.set_main_option("script_location", "treestroke.store:migrations")
    engine = create_engine(f"sqlite:///{database.path}")
    with engine.connect() as connection:
        settings.attributes["connection"] = connection
        command.upgrade(settings, revision)
    engine.dispose()


def test_what_an_older_program_kept_outlives_the_newer_tables(tmp_path: Path) -> None:
    database = Database(tmp_path).of(LOCAL)
    at_revision(database, "0002")
    assert not database.current()
    with closing(sqlite3.connect(database.path)) as plain:
        columns = (
            "id, name, photo, photo_blob, strokes_blob, settings, seed, engine, fingerprint, status,"
            "phase_fraction, progress, seq, attempt, beat, created"
        )
        values = "'mdl_1', 'Oak', 'pho_1', 'a', 'b', '{}', 7, 'treestroke', 'f', 'succeeded', 0, 1, 1, 1, 0, 5.0"
        plain.execute(f"INSERT INTO models ({columns}) VALUES ({values})")
        plain.execute("INSERT INTO files VALUES ('mdl_1', 'tree.glb', 'c', 4)")
        plain.commit()
    database.migrate()
    assert database.current()
    row = find(database, "mdl_1")
    assert (row.name, row.photo) == ("Oak", "pho_1")
    with database.reading() as session:
        assert [(part.name, part.blob, part.media_type) for part in session.scalars(select(ModelPart))] == [
            ("photo", "a", "image/png"),
            ("strokes", "b", "application/json"),
        ]
        assert [(file.name, file.blob) for file in session.scalars(select(File))] == [("tree.glb", "c")]
    with database.writing() as session:  # and parts and files are still removed with their model
        session.execute(delete(ModelRow))
        assert session.scalars(select(File)).all() == session.scalars(select(ModelPart)).all() == []
    database.close()


def test_a_failure_takes_everything_back(database: Database) -> None:
    row = add_model(database)
    with suppress(ZeroDivisionError), database.writing() as session:
        session.get_one(ModelRow, row.number).name = "changed"
        session.flush()
        raise ZeroDivisionError
    assert find(database, row.id).name == ""


def test_writers_take_turns_and_none_is_lost(database: Database) -> None:
    row = add_model(database)
    others = [Database(database.path.parent, database.url).of(LOCAL) for _ in range(2)]

    def count(one: Database) -> None:
        for _ in range(50):
            with one.writing() as session:
                found = session.get_one(ModelRow, row.number, with_for_update=True)
                found.seq = found.seq + 1

    threads = [threading.Thread(target=count, args=(one,)) for one in others for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert find(database, row.id).seq == 1 + 4 * 50
    for one in others:
        one.close()


def test_readers_see_one_state_while_another_writes(database: Database) -> None:
    row = add_model(database)
    with database.reading() as reading:
        before = reading.scalars(select(ModelRow.name)).all()
        with database.writing() as writing:
            writing.get_one(ModelRow, row.number).name = "changed"
        assert reading.scalars(select(ModelRow.name)).all() == before == [""]
    assert find(database, row.id).name == "changed"


def test_a_reader_does_not_wait_for_a_writer(database: Database) -> None:
    row = add_model(database)
    with database.writing() as writing:
        writing.add(Worker(id="w", slots=1, beat=1))
        writing.flush()
        with kept(1.0):
            assert find(database, row.id).id == row.id


@SQLITE_ONLY  # on Postgres writers wait only for rows
def test_readers_do_not_wait_for_twenty_writers(database: Database) -> None:
    """Each of them once held one of the connections that readers need."""
    row, barrier = add_model(database), threading.Barrier(21)

    def write(at: int) -> None:
        barrier.wait()
        with database.writing() as session:
            session.add(Worker(id=str(at), slots=1, beat=1))

    writers = [threading.Thread(target=write, args=(at,)) for at in range(20)]
    with database.writing():
        for writer in writers:
            writer.start()
        barrier.wait()
        time.sleep(0.2)  # by now they stand in line
        for _ in range(30):
            assert find(database, row.id).id == row.id
        with database.reading() as session:
            assert session.scalars(select(Worker)).all() == []  # nobody has written: all of them still wait
    for writer in writers:
        writer.join()
    with database.reading() as session:
        assert len(session.scalars(select(Worker)).all()) == 20


@SQLITE_ONLY  # a connection to Postgres is one file
def test_many_readers_and_writers_have_few_files_open(database: Database) -> None:
    row, before = add_model(database), len(os.listdir("/proc/self/fd"))
    most = [before]

    def ask() -> None:
        for _ in range(4):
            find(database, row.id)
            with database.writing() as session:
                session.get_one(ModelRow, row.number).seq += 1
            most.append(len(os.listdir("/proc/self/fd")))

    threads = [threading.Thread(target=ask) for _ in range(40)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert find(database, row.id).seq == 1 + 40 * 4
    assert max(most) - before < 30


@SQLITE_ONLY  # on Postgres others may write meanwhile
def test_a_writer_that_waits_too_long_says_so(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("treestroke.store.sqlite._BUSY_SECONDS", 0.05)
    with database.writing(), pytest.raises(OperationalError, match="database is locked"), database.writing():
        pass
    add_model(database)  # and the next one has its turn


@SQLITE_ONLY  # on Postgres others may write meanwhile
def test_a_writer_has_the_database_from_its_first_word_on(database: Database) -> None:
    with database.writing() as first:
        first.scalars(select(ModelRow)).all()  # it only reads, and still nobody else may write
        with closing(sqlite3.connect(database.path, timeout=0.05)) as second, pytest.raises(sqlite3.OperationalError):
            second.execute("BEGIN IMMEDIATE")


@SQLITE_ONLY  # Postgres does so unless its operator says otherwise
def test_what_is_committed_survives_a_power_cut(database: Database) -> None:
    with database.reading() as session:
        pragmas = {
            name: session.connection().exec_driver_sql(f"PRAGMA {name}").scalar()
            for name in ("journal_mode", "synchronous", "foreign_keys")
        }
    assert pragmas == {"journal_mode": "wal", "synchronous": 2, "foreign_keys": 1}


def test_only_migrating_makes_the_file(tmp_path: Path) -> None:
    database = Database(tmp_path).of(LOCAL)
    for use in (database.reading, database.writing, database.autocommitting):
        with pytest.raises(OperationalError) as refused, use() as session:
            session.scalars(select(ModelRow)).all()
        assert code_of(refused.value) == "database_unavailable"
    assert not database.current()
    assert list(tmp_path.iterdir()) == []
    database.migrate()
    add_model(database)
    database.close()


@pytest.mark.parametrize("name", ["with spaces", "a?b#c%20d", "für;uri=false&mode=ro"])
def test_the_folder_may_have_any_name(tmp_path: Path, name: str) -> None:
    (tmp_path / name).mkdir()
    database = Database(tmp_path / name).of(LOCAL)
    database.migrate()
    row = add_model(database)
    assert find(database, row.id).id == row.id
    database.close()
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert [path.name for path in (tmp_path / name).iterdir()] == ["treestroke.sqlite3"]


@SQLITE_ONLY  # which is a file
@pytest.mark.parametrize("replaced", [False, True])
def test_a_database_whose_file_is_removed_or_replaced_takes_nothing_until_it_is_opened_anew(
    database: Database, replaced: bool
) -> None:
    row = add_model(database)
    kept = database.path.with_name("kept")
    shutil.copy(database.path, kept)
    database.path.rename(database.path.with_name("away"))
    if replaced:
        kept.rename(database.path)
    for use in (database.reading, database.writing, database.autocommitting):
        with pytest.raises(OperationalError) as refused, use() as session:
            session.scalars(select(ModelRow)).all()
        assert code_of(refused.value) == "database_unavailable"
    assert database.path.exists() == replaced
    database.path.with_name("away").rename(database.path)
    assert find(database, row.id).id == row.id


def test_a_database_that_cannot_be_opened_says_so(tmp_path: Path) -> None:
    with pytest.raises(OperationalError):
        Database(tmp_path / "missing").migrate()


def test_a_hold_is_seen_by_all_until_it_ends(database: Database) -> None:
    other = Database(database.path.parent, database.url).of(LOCAL)
    with database.hold(), database.hold():
        assert database.held()
        assert other.held()
        add_model(other)  # and nobody else is kept from anything
    assert not database.held()
    assert not other.held()
    other.close()


def test_a_session_within_a_connection_s_transaction_is_taken_back_with_it(database: Database) -> None:
    with suppress(ZeroDivisionError), database.migrating() as connection:
        with database.within(connection) as session:
            session.add(Worker(id="w", slots=1, beat=1))
            session.commit()
        raise ZeroDivisionError
    with database.reading() as session:
        assert session.get(Worker, "w") is None
