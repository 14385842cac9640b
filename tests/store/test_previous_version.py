"""Programs of the version before go on beside newer tables: while some are upgraded, others still write."""

from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import Column, Connection, MetaData, Table, inspect
from tests.rows import find, model_row

from treestroke.store.data_folder import known_revisions
from treestroke.store.database import Database, upgrade
from treestroke.store.scope import LOCAL

FIRST = "0011"
"""The first revision whose program could run beside another."""


@pytest.fixture
def untouched(tmp_path: Path, database_kind: str, request: pytest.FixtureRequest) -> Database:
    """A database without tables."""
    return Database(tmp_path, request.getfixturevalue("postgres_url") if database_kind == "postgres" else "").of(LOCAL)


def columns(connection: Connection) -> dict[tuple[str, str], Any]:
    """Give what is known of every column, by table and name."""
    inspector = inspect(connection)
    tables = inspector.get_table_names()
    return {(table, told["name"]): told for table in tables for told in inspector.get_columns(table)}


def test_each_migration_leaves_what_the_program_before_reads_and_writes(untouched: Database) -> None:
    revisions = [revision for revision in sorted(known_revisions()) if revision > FIRST]
    assert revisions
    with untouched.migrating() as connection:
        upgrade(connection, FIRST)
        before = columns(connection)
        for revision in revisions:
            upgrade(connection, revision)
            after = columns(connection)
            assert before.keys() - after.keys() == set(), revision
            tables = {table for table, _ in before}
            new = {name: told for name, told in after.items() if name not in before and name[0] in tables}
            needed = {name for name, told in new.items() if not told["nullable"] and told["default"] is None}
            assert needed == set(), revision
            before = after
    untouched.close()


def test_the_program_before_still_writes_its_rows(untouched: Database) -> None:
    revisions = sorted(known_revisions())
    row = model_row(engine="older")
    with untouched.migrating() as connection:
        upgrade(connection, revisions[-2])
        known = {name for table, name in columns(connection) if table == "models"}
        upgrade(connection)
        values = {name: value for name in known if (value := getattr(row, name)) is not None}
        table = Table("models", MetaData(), *(Column(name, row.__table__.c[name].type) for name in values))
        connection.execute(table.insert(), [values])
    found = find(untouched, row.id)
    assert (found.engine, found.status, found.team) == ("older", "queued", "local")
    untouched.close()
