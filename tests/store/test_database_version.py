import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from alembic.script import ScriptDirectory

from treestroke.store.data_folder import DataFolderError, check_version, known_revisions
from treestroke.store.database import Database, _migrations
from treestroke.store.objects import FolderObjects
from treestroke.store.scope import LOCAL


def test_the_known_versions_are_those_of_the_migrations() -> None:
    scripts = ScriptDirectory.from_config(_migrations())
    assert known_revisions() == {script.revision for script in scripts.walk_revisions()}
    assert max(known_revisions()) == scripts.get_current_head()


def test_no_database_a_bare_one_and_one_of_ours_are_well(tmp_path: Path) -> None:
    check_version(tmp_path)
    with closing(sqlite3.connect(tmp_path / "treestroke.sqlite3")) as bare:
        bare.execute("CREATE TABLE other (id)")
    check_version(tmp_path)
    database = Database(tmp_path).of(LOCAL)
    database.migrate()
    check_version(tmp_path)
    database.close()


@pytest.mark.parametrize("left", [None, "", "CREATE TABLE other (id)"])
def test_a_database_that_is_lost_or_empty_beside_files_is_refused(tmp_path: Path, left: str | None) -> None:
    if left is not None:
        with closing(sqlite3.connect(tmp_path / "treestroke.sqlite3")) as bare:
            bare.execute(left)
        (tmp_path / "treestroke.sqlite3").touch()
    check_version(tmp_path)  # no file yet
    FolderObjects(tmp_path).put("local", "ab" * 32, b"tree")
    with pytest.raises(
        DataFolderError, match=r"lost or empty.*; restore it from a copy, or move the folder 'blobs' away"
    ):
        check_version(tmp_path)
    (tmp_path / "blobs").rename(tmp_path / "kept")
    check_version(tmp_path)


def test_a_newer_database_is_refused_in_one_line_that_says_how_to_mend_it(database: Database) -> None:
    with database.writing() as session:
        session.connection().exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    with pytest.raises(DataFolderError, match=r"^\S+: a newer treestroke made this database .*9999.*; install .*$"):
        database.check()


def test_a_file_that_is_no_database_is_refused(tmp_path: Path) -> None:
    (tmp_path / "treestroke.sqlite3").write_bytes(b"no database at all" * 1000)
    with pytest.raises(DataFolderError, match=r"cannot be read \(file is not a database\); restore it from a copy"):
        check_version(tmp_path)
