import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.accounts import SECRET
from tests.postgres import KINDS
from tests.running import BACKEND

from treestroke.cli import main
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.scope import LOCAL, SERVICE


def database_in(folder: Path, url: str = "") -> Database:
    """Give a database with tables, in a private data folder."""
    folder.mkdir(mode=0o700)
    database = Database(folder, url).of(LOCAL)
    database.migrate()
    return database


def test_a_backup_is_written_and_restored_without_a_word(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    database = database_in(tmp_path / "data")
    open_blobs(database, tmp_path / "data").of(LOCAL).put(b"of nothing")
    database.close()
    assert main(["backup", str(tmp_path / "backup"), "--data", str(tmp_path / "data")]) == 0
    assert (tmp_path / "backup").stat().st_mode & 0o077 == 0
    assert main(["restore", str(tmp_path / "backup"), "--verify", "--data", str(tmp_path / "new")]) == 0
    assert capsys.readouterr() == ("", "")
    assert Database(tmp_path / "new").current()


def test_what_cannot_be_restored_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["restore", str(tmp_path / "none"), "--data", str(tmp_path / "new")]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith(
        "none: there is no whole backup in it; name the folder of one that `treestroke backup` finished"
    )


def test_a_database_that_does_not_answer_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("TREESTROKE_DATABASE_URL", f"postgresql:{'//'}postgres@127.0.0.1:1/none")
    assert main(["backup", str(tmp_path / "backup"), "--data", str(tmp_path / "data")]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "backup: the backup was not finished (" in line
    assert "mend that and run it again" in line


def test_an_interrupted_backup_says_that_it_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    database_in(tmp_path / "data").close()
    monkeypatch.setattr("treestroke.service.backup.dump", interrupted)
    assert main(["backup", str(tmp_path / "backup"), "--data", str(tmp_path / "data")]) == 130
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith("backup: the backup was not finished (interrupted); run it again")


@pytest.mark.parametrize("kind", KINDS)
def test_every_command_refuses_a_newer_database_in_one_line(
    kind: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    url = request.getfixturevalue("postgres_url") if kind == "postgres" else ""
    database = database_in(tmp_path / "data", url)
    with database.of(SERVICE).writing() as session:
        session.connection().exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    database.close()
    environment = {**os.environ, "PYTHONPATH": str(BACKEND), "TREESTROKE_DATABASE_URL": url}
    environment |= {"TREESTROKE_SECRET": SECRET, "TREESTROKE_PORT": "0"}
    commands = [["serve"], ["worker"], ["backup", str(tmp_path / "backup")], *([["keys", "list"]] if url else [])]
    for command in commands:
        whole = [sys.executable, "-m", "treestroke", *command, "--data", str(tmp_path / "data")]
        done = subprocess.run(whole, env=environment, capture_output=True, text=True, timeout=300)
        (line,) = done.stderr.splitlines()
        assert done.returncode == 1, command
        assert "a newer treestroke made this database (its version is 9999" in line, command
        assert "install that treestroke again" in line, command
