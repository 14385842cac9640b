import json
from pathlib import Path

import pytest
from sqlalchemy import Connection, text
from tests.postgres import KINDS
from tests.rows import add_capture, add_model, add_solve, photo_row

from treestroke.core.progress import silent
from treestroke.store.database import Database, upgrade
from treestroke.store.scope import LOCAL, Scope
from treestroke.store.table_rows import LEFT_OUT, dump, fill, read
from treestroke.store.tables import BlobRow, Replay, Table, UploadRow, Worker

WRITABLE = {"VARCHAR", "TEXT", "INTEGER", "BIGINT", "FLOAT", "BOOLEAN", "JSON"}
"""Types whose values are the same in JSON."""


@pytest.fixture(params=KINDS)
def other(request: pytest.FixtureRequest, tmp_path: Path) -> Database:
    """A database without tables, of either kind."""
    url = request.getfixturevalue("postgres_url") if request.param == "postgres" else ""
    (tmp_path / "other").mkdir()
    return Database(tmp_path / "other", url)


def filled(database: Database) -> None:
    """Write rows of many kinds."""
    settings = {"height": 14.1, "files": ["obj"], "name": "für \u2028 'x'"}
    model = add_model(database, settings=settings, tags=["a"], error=None, report={"n": [1e-300, 2**60, None]})
    add_model(database.of(Scope("oaks", "usr_ann")), status="running", attempt=2, seed=2**62, preview_seq=3)
    add_solve(database, add_capture(database, ["c" * 64, "d" * 64]).id)
    with database.writing() as session:
        session.add(Replay(key="k" * 255, fingerprint="f", model=model.id, created=0.1 + 0.2))
        session.add(Worker(id="w", slots=1, beat=1))
        session.add(UploadRow(id="upl_1", name="", created=0.0))
        for name in ("a" * 64, "e" * 64):
            session.add(BlobRow(team="local", sha256=name, bytes=5, created=0.0))


def written(database: Database, folder: Path) -> dict[str, list[str]]:
    """Dump all rows; give the lines by table, sorted."""
    folder.mkdir()
    with database.copying() as connection:
        dump(connection, folder, silent)
    return {path.stem: sorted(path.read_text().splitlines()) for path in folder.iterdir()}


def test_all_rows_come_back_whatever_database_they_go_to(database: Database, other: Database, tmp_path: Path) -> None:
    filled(database)
    before = written(database, tmp_path / "before")
    with other.migrating() as connection:
        upgrade(connection)
        counts = fill(connection, tmp_path / "before", before, silent)
    assert counts == {name: len(lines) for name, lines in before.items()}
    assert written(other, tmp_path / "after") == before
    assert before.keys() == Table.metadata.tables.keys() - LEFT_OUT
    other.close()


def test_numbers_go_on_after_the_greatest(database: Database, other: Database, tmp_path: Path) -> None:
    rows = [add_model(database) for _ in range(3)]
    names = written(database, tmp_path / "before")
    with other.migrating() as connection:
        upgrade(connection)
        fill(connection, tmp_path / "before", names, silent)
    assert add_model(other.of(LOCAL)).number == rows[-1].number + 1
    other.close()


def test_nothing_is_not_null_in_json(database: Database, other: Database, tmp_path: Path) -> None:
    add_model(database, error=None)
    names = written(database, tmp_path / "before")
    with other.migrating() as connection:
        upgrade(connection)
        fill(connection, tmp_path / "before", names, silent)
        assert connection.scalar(text("SELECT count(*) FROM models WHERE error IS NULL")) == 1
    other.close()


def test_blobs_that_no_row_refers_to_stay_behind(database: Database, tmp_path: Path) -> None:
    filled(database)
    written(database, tmp_path / "rows")
    assert [row["sha256"] for row in read(tmp_path / "rows", "blobs")] == ["a" * 64]


def test_a_snapshot_is_of_one_moment(database: Database, tmp_path: Path) -> None:
    add_model(database)
    with database.copying() as connection:
        assert count(connection) == 1
        add_model(database)
        (tmp_path / "rows").mkdir()
        assert dump(connection, tmp_path / "rows", silent)["models"].rows == 1


def count(connection: Connection) -> int:
    return connection.scalar(text("SELECT count(*) FROM models")) or 0


def test_many_rows_are_written_in_pieces(database: Database, tmp_path: Path) -> None:
    with database.writing() as session:
        session.add_all(photo_row("a" * 64, 5) for _ in range(501))
    assert len(written(database, tmp_path / "rows")["photos"]) == 501
    assert json.loads((tmp_path / "rows" / "photos.jsonl").read_text().splitlines()[500])["bytes"] == 5


def test_every_column_is_of_a_type_that_json_keeps() -> None:
    kinds = {str(column.type).partition("(")[0] for table in Table.metadata.tables.values() for column in table.columns}
    assert kinds <= WRITABLE
