"""The launcher of web process and worker."""

import os
import subprocess
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from unittest.mock import patch

import pytest
from tests.hosted import SECRET
from tests.postgres import KINDS
from tests.running import serving

from treestroke.cli import main
from treestroke.serve import Child
from treestroke.store.database import Database


@pytest.fixture(autouse=True)
def _own_environment() -> Iterator[None]:
    """Undo what a command that runs in this process sets."""
    with patch.dict("os.environ"):
        yield


def test_a_data_folder_is_one_launcher_s(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with serving(tmp_path / "data", workers=0, tracers=1):
        for path in (tmp_path / "data").glob("*lock*"):
            path.unlink()
        assert main(["serve", "--data", str(tmp_path / "data"), "--port", "0"]) == 2
        assert "another `treestroke serve` uses this data folder; stop it, or name another" in capsys.readouterr().err
    assert (tmp_path / "data").stat().st_mode & 0o077 == 0


def test_a_data_folder_that_was_open_is_closed_before_it_is_served(tmp_path: Path) -> None:
    data = tmp_path / "data"
    data.mkdir(0o755)
    with serving(data, workers=0, tracers=1):
        assert [path for path in (data, *data.rglob("*")) if path.stat().st_mode & 0o077] == []


@pytest.mark.parametrize("command", ["serve", "worker"])
def test_a_folder_of_other_things_is_not_served(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    tmp_path.chmod(0o755)
    (tmp_path / "letter.txt").write_bytes(b"")
    assert main([command, "--data", str(tmp_path), *(["--port", "0"] if command == "serve" else [])]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"treestroke: {tmp_path}: other users of this machine can read it")
    assert [path.name for path in tmp_path.iterdir()] == ["letter.txt"]


@pytest.mark.parametrize("database_kind", KINDS)
@pytest.mark.parametrize("command", ["serve", "worker", "doctor"])
def test_a_newer_database_is_one_line_and_nothing_is_started(
    database: Database, capfd: pytest.CaptureFixture[str], command: str
) -> None:
    folder = database.path.parent
    os.environ |= {"TREESTROKE_DATABASE_URL": database.url, "TREESTROKE_SECRET": SECRET}
    folder.chmod(0o700)
    with database.writing() as session:
        session.connection().exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    database.close()
    assert main([command, "--data", str(folder), *(["--port", "0"] if command == "serve" else [])]) == 1
    told = capfd.readouterr()
    lines = [line for line in told.err.splitlines() if not line.startswith("{")]
    assert len(lines) == 1, told.err
    assert "a newer treestroke made this database" in (told.out if command == "doctor" else lines[0])
    assert not (folder / "tmp").exists()


def test_a_postgres_that_is_away_is_one_line_that_tells_no_password(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    url = f"postgresql:{'//'}ann:secret@127.0.0.1:1/trees"
    os.environ |= {"TREESTROKE_DATABASE_URL": url, "TREESTROKE_SECRET": SECRET}
    assert main(["serve", "--data", str(tmp_path / "data"), "--port", "0"]) == 1
    (line,) = capfd.readouterr().err.splitlines()
    assert line.startswith(f"treestroke: postgresql:{'//'}ann:***@127.0.0.1:1/trees: Postgres cannot be used (")
    assert line.endswith("; start Postgres, or correct TREESTROKE_DATABASE_URL")
    assert "secret" not in line


@pytest.mark.parametrize("command", ["serve", "worker", "doctor"])
def test_a_lost_database_is_one_line_and_nothing_is_started_or_made(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], command: str
) -> None:
    tmp_path.chmod(0o700)
    blob = tmp_path / "blobs" / "ab" / f"ab{62 * '0'}"
    blob.parent.mkdir(parents=True)
    blob.write_bytes(b"tree")
    before = sorted(tmp_path.rglob("*"))
    assert main([command, "--data", str(tmp_path), *(["--port", "0"] if command == "serve" else [])]) == 1
    told = capfd.readouterr()
    lines = [line for line in told.err.splitlines() if not line.startswith("{")]
    assert len(lines) == 1, told.err
    assert "treestroke.sqlite3: the database is lost or empty" in (told.out if command == "doctor" else lines[0])
    assert sorted(tmp_path.rglob("*")) == before


def test_a_process_that_gives_up_at_once_is_started_ever_more_slowly(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    clock = [1000.0]
    monkeypatch.setattr("treestroke.serve.time.monotonic", lambda: clock[0])
    child = Child("no.such.module", {"PATH": ""})
    starts: list[float] = []
    for _ in range(200):
        before = child._process
        child.keep_running()
        if child._process is not None and child._process is not before:
            starts.append(clock[0])
            subprocess.Popen.wait(child._process)
        clock[0] += 0.1
    assert child._process is None or child._process.communicate() == (None, None)
    gaps = [round(later - earlier, 1) for earlier, later in pairwise(starts)]
    assert gaps == sorted(gaps)
    assert gaps[0] < 0.5 < 6 < gaps[-1]
    assert "started again" in capfd.readouterr().err
