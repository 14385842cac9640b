"""A service that is upgraded while jobs wait and are under way: none of them fails."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from sqlalchemy import Column, MetaData, Table, inspect, select, text
from tests.faults.harness import PATIENCE_SECONDS, QUICK, small_tree
from tests.faults.processes import wait_for
from tests.hosted import SECRET
from tests.postgres import KINDS
from tests.running import serving

from treestroke.core.progress import silent
from treestroke.store.database import Database, upgrade
from treestroke.store.scope import SERVICE
from treestroke.store.table_rows import dump, read
from treestroke.store.tables import TERMINAL, ModelRow

OLDER = "0012"
GONE = "UPDATE models SET status = 'running', attempt = 1, beat = 7, claim = 'c', worker = 'gone' WHERE number = 1"


@pytest.fixture
def older(request: pytest.FixtureRequest, tmp_path: Path, database_kind: str) -> Iterator[Database]:
    """A database of an older program: one job was under way, one waits, and one waits for the older engine."""
    data, rows = tmp_path / "data", tmp_path / "rows"
    queue_models(data, 3)
    rows.mkdir()
    source = Database(data)
    with source.copying() as connection:
        dump(connection, rows, silent)
    source.close()
    (data / "treestroke.sqlite3").unlink()
    made = Database(data, request.getfixturevalue("postgres_url") if database_kind == "postgres" else "").of(SERVICE)
    fill_older(made, rows)
    yield made
    made.close()


@pytest.fixture(params=KINDS)
def database_kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def queue_models(data: Path, number: int) -> None:
    """Have a service accept models, and stop it before it grows any."""
    with serving(data, workers=0, tracers=1) as url, httpx.Client(base_url=url, timeout=PATIENCE_SECONDS) as client:
        photo = client.post("/v1/photos", files={"file": small_tree()[0]}).json()["id"]
        wanted = {"photo": photo, "strokes": small_tree()[1], "settings": QUICK}
        for seed in range(number):
            assert client.post("/v1/models", json={**wanted, "seed": seed}).status_code == 202


def fill_older(database: Database, rows: Path) -> None:
    """Write rows into tables of the older revision, as far as it has their columns."""
    with database.migrating() as connection:
        upgrade(connection, OLDER)
        inspector = inspect(connection)
        for name in ("blobs", "photos", "models", "model_parts"):
            known, types = inspector.get_columns(name), ModelRow.metadata.tables[name].c
            table = Table(name, MetaData(), *(Column(one["name"], types[one["name"]].type) for one in known))
            for row in read(rows, name):
                connection.execute(table.insert(), {key: value for key, value in row.items() if key in table.c})
        connection.execute(text(GONE))
        connection.execute(text("UPDATE models SET engine = 'treestroke 0.0 older' WHERE number = 3"))


def test_no_job_fails_when_the_tables_are_brought_up_to_date(older: Database, tmp_path: Path) -> None:
    """Takes over 20 s: nothing is known of the worker that is gone, and of the older engine, for 10 s each."""

    def told() -> list[tuple[str, int]]:
        with older.reading() as session:
            found = select(ModelRow.status, ModelRow.attempt).order_by(ModelRow.number)
            return [(status, attempt) for status, attempt in session.execute(found)]

    with serving(tmp_path / "data", workers=1, tracers=1, database_url=older.url, secret=SECRET):
        assert older.current()
        wait_for(lambda: all(status in TERMINAL for status, _ in told()), PATIENCE_SECONDS, "the end of all jobs")
    assert told() == [("succeeded", 2), ("succeeded", 1), ("succeeded", 1)]
