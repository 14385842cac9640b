"""What only a Postgres can do: go away, run out of connections, and have rows that others hold."""

import threading
from collections.abc import Iterator
from pathlib import Path

import psycopg
import pytest
from psycopg import sql
from sqlalchemy import select, text
from sqlalchemy.exc import DBAPIError, SQLAlchemyError
from tests.postgres import PostgresServer
from tests.rows import add_capture, add_model, find

from treestroke.service.failures import code_of
from treestroke.store import queries
from treestroke.store.data_folder import DataFolderError
from treestroke.store.database import Database
from treestroke.store.scope import LOCAL
from treestroke.store.tables import CapturePhoto, CaptureRow, ModelRow


@pytest.fixture
def database_kind() -> str:
    return "postgres"


@pytest.fixture
def impatient(database: Database, monkeypatch: pytest.MonkeyPatch) -> Iterator[Database]:
    """The same database by other connections, on which nothing waits for long."""
    limits = dict.fromkeys(("lock_timeout", "idle_in_transaction_session_timeout"), "100ms")
    monkeypatch.setattr("treestroke.store.postgres._LIMITS", limits)
    monkeypatch.setattr("treestroke.store.postgres._CONNECTIONS", 2)
    monkeypatch.setattr("treestroke.store.postgres._POOL_SECONDS", 0.1)
    other = Database(database.path.parent, database.url).of(LOCAL)
    yield other
    other.close()


def failure(database: Database) -> str:
    """Give the code of the failure to read."""
    with pytest.raises(SQLAlchemyError) as failed, database.reading() as session:
        session.scalars(select(ModelRow)).all()
    return code_of(failed.value)


def test_a_server_that_is_away_is_found_again_by_the_same_database(
    database: Database, postgres: PostgresServer
) -> None:
    row = add_model(database)
    postgres.stop()
    try:
        for use in (database.reading, database.writing, database.autocommitting):
            with pytest.raises(SQLAlchemyError) as failed, use() as session:
                session.scalars(select(ModelRow)).all()
            assert code_of(failed.value) == "database_unavailable"
    finally:
        postgres.start()
    assert find(database, row.id).number == row.number


def test_a_connection_that_the_server_ends_in_the_middle_is_a_database_that_is_away(
    database: Database, postgres: PostgresServer
) -> None:
    with database.reading() as session:
        number = session.connection().execute(text("SELECT pg_backend_pid()")).scalar()
        postgres.execute(sql.SQL("SELECT pg_terminate_backend({})").format(number))
        with pytest.raises(SQLAlchemyError) as failed:
            session.scalars(select(ModelRow)).all()
    assert code_of(failed.value) == "database_unavailable"


def test_a_database_that_is_not_there_is_away(tmp_path: Path, postgres: PostgresServer) -> None:
    assert failure(Database(tmp_path, postgres.url("nowhere")).of(LOCAL)) == "database_unavailable"


def test_a_text_that_postgres_cannot_keep_is_the_sender_s_mistake(database: Database) -> None:
    with pytest.raises(SQLAlchemyError) as failed:
        find(database, "mdl_\0")
    assert code_of(failed.value) == "text_unusable"


def test_without_a_free_connection_the_database_is_busy(impatient: Database) -> None:
    with impatient.reading(), impatient.writing():
        assert failure(impatient) == "database_busy"
    assert impatient.current()


def test_a_row_that_another_holds_is_waited_for_and_then_the_database_is_busy(
    database: Database, impatient: Database
) -> None:
    row = add_model(database)
    with database.writing() as session:
        queries.lock(session, ModelRow, row.id)
        with pytest.raises(SQLAlchemyError) as failed, impatient.writing() as other:
            queries.lock(other, ModelRow, row.id)
    assert code_of(failed.value) == "database_busy"


def test_who_stands_still_in_a_transaction_loses_its_rows(database: Database, impatient: Database) -> None:
    row = add_model(database)
    with impatient.autocommitting() as stopped:
        stopped.execute(text("BEGIN"))
        queries.lock(stopped, ModelRow, row.id)
        with database.writing() as session:  # which waits until the server has ended the other one
            queries.lock(session, ModelRow, row.id)
        with pytest.raises(SQLAlchemyError) as failed:
            stopped.scalars(select(ModelRow)).all()
    assert code_of(failed.value) in ("database_busy", "database_unavailable")


def test_of_two_that_wait_for_each_other_one_is_told_that_the_database_is_busy(database: Database) -> None:
    rows, barrier, codes = [add_model(database) for _ in range(2)], threading.Barrier(2), list[str]()

    def lock(first: ModelRow, second: ModelRow) -> None:
        try:
            with database.writing() as session:
                queries.lock(session, ModelRow, first.id)
                barrier.wait()
                queries.lock(session, ModelRow, second.id)
        except SQLAlchemyError as error:
            codes.append(code_of(error))

    threads = [threading.Thread(target=lock, args=order) for order in (rows, rows[::-1])]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert codes == ["database_busy"]


def test_what_reads_cannot_write(database: Database) -> None:
    row = add_model(database)
    with database.reading() as session:
        session.get_one(ModelRow, row.number).name = "changed"
        with pytest.raises(SQLAlchemyError, match="read-only"):
            session.flush()


def test_photos_stand_in_one_order_whatever_language_the_database_has(tmp_path: Path, postgres: PostgresServer) -> None:
    postgres.execute(sql.SQL("CREATE DATABASE english TEMPLATE template0 LOCALE_PROVIDER icu ICU_LOCALE 'en'"))
    database = Database(tmp_path, postgres.url("english")).of(LOCAL)
    database.migrate()
    capture = add_capture(database, [digit * 64 for digit in "012"])
    with database.writing() as session:
        for photo, name in zip(session.scalars(select(CapturePhoto)), ("b", "C", "a"), strict=True):
            photo.name = name
    with database.reading() as session:
        names = [photo.name for photo in queries.capture_photos(session, [capture.id])[capture.id]]
        assert session.get(CaptureRow, capture.number) is not None
    database.close()
    assert names == ["C", "a", "b"]


def test_files_of_another_database_are_not_taken_for_leftovers(tmp_path: Path, postgres_url: str) -> None:
    (tmp_path / "blobs").mkdir()
    (tmp_path / "blobs" / "left").touch()
    database = Database(tmp_path, postgres_url.replace("postgres@", "postgres:secret@"))
    with pytest.raises(DataFolderError, match="the database is lost or empty") as refused:
        database.check()
    assert "secret" not in str(refused.value)
    database.close()


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (psycopg.errors.DiskFull, "storage_full"),
        (psycopg.errors.SerializationFailure, "database_busy"),
        (psycopg.errors.QueryCanceled, "database_busy"),
        (psycopg.errors.TooManyConnections, "database_busy"),
        (psycopg.errors.AdminShutdown, "database_unavailable"),
        (psycopg.errors.CannotConnectNow, "database_unavailable"),
        (psycopg.errors.ReadOnlySqlTransaction, "database_unavailable"),
        (psycopg.errors.DataCorrupted, "storage_broken"),
        (psycopg.errors.UndefinedTable, "engine_error"),
    ],
)
def test_what_the_server_says_has_a_name_each(error: type[psycopg.Error], code: str) -> None:
    assert code_of(DBAPIError("SELECT", None, error())) == code
