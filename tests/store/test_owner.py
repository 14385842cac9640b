"""Tables with an owner of their own: the service's user may add to the audit and read it, and no more."""

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from psycopg import sql
from sqlalchemy import text
from sqlalchemy.exc import ProgrammingError
from tests.postgres import PostgresServer
from tests.rows import add_model

from treestroke.store.audit import record
from treestroke.store.data_folder import DataFolderError
from treestroke.store.database import Database
from treestroke.store.queries import mark_deleted
from treestroke.store.scope import Scope
from treestroke.store.tables import ModelRow

OAKS = Scope("oaks", "usr_ann")


@pytest.fixture
def service_url(postgres: PostgresServer, postgres_url: str) -> str:
    """The URL of an empty database as a user who may only connect."""
    name = "only-connects"
    if not postgres.execute(sql.SQL("SELECT FROM pg_roles WHERE rolname = {}").format(name)):
        postgres.execute(sql.SQL("CREATE ROLE {} LOGIN").format(sql.Identifier(name)))
    return postgres_url.replace("postgres@", f"{name}@")


@pytest.fixture
def owned(tmp_path: Path, service_url: str, postgres_url: str) -> Iterator[Database]:
    """A database of the service's user, whose tables the owner has made."""
    with closing(Database(tmp_path, service_url, postgres_url)) as owner:
        owner.migrate()
    with closing(Database(tmp_path, service_url)) as database:
        yield database.of(OAKS)


def test_the_service_s_user_works_without_being_the_owner(owned: Database) -> None:
    assert owned.current()
    owned.migrate()
    model = add_model(owned)
    with owned.writing() as session:
        assert mark_deleted(session, ModelRow, model.id)
    with owned.reading() as session:
        assert session.execute(text("SELECT action FROM audit")).scalars().all() == ["model.deleted"]


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE audit SET who = NULL",
        "DELETE FROM audit",
        "TRUNCATE audit",
        "DROP TABLE audit",
        "ALTER TABLE audit ADD COLUMN more text",
        "UPDATE alembic_version SET version_num = '0001'",
        "CREATE TABLE other (id integer)",
    ],
)
def test_what_would_change_the_audit_is_refused(owned: Database, statement: str) -> None:
    with owned.writing() as session:
        record(session, "key.made", "key_1")
    with pytest.raises(ProgrammingError, match=r"permission denied|must be owner"), owned.writing() as session:
        session.execute(text(statement))


def test_tables_of_another_user_are_not_migrated(owned: Database, postgres: PostgresServer, postgres_url: str) -> None:
    postgres.execute(sql.SQL("UPDATE alembic_version SET version_num = '0015'"), postgres_url)
    with pytest.raises(DataFolderError, match="run `treestroke migrate` with TREESTROKE_OWNER_DATABASE_URL"):
        owned.migrate()


def test_a_user_who_may_make_no_tables_makes_none(tmp_path: Path, service_url: str) -> None:
    with (
        closing(Database(tmp_path, service_url)) as database,
        pytest.raises(DataFolderError, match="treestroke migrate"),
    ):
        database.migrate()


def test_the_owner_is_another_user(tmp_path: Path, postgres_url: str) -> None:
    same = Database(tmp_path, postgres_url, postgres_url)
    with closing(same), pytest.raises(DataFolderError, match="the service's own user"):
        same.migrate()


def test_granting_again_changes_nothing(tmp_path: Path, owned: Database, service_url: str, postgres_url: str) -> None:
    with closing(Database(tmp_path, service_url, postgres_url)) as owner:
        owner.migrate(again=True)
    add_model(owned)
