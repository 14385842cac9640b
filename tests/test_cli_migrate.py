from contextlib import closing
from pathlib import Path

import pytest

from treestroke.cli import main
from treestroke.store.database import Database


def test_tables_are_made_and_brought_up_to_date(
    tmp_path: Path, postgres_url: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("TREESTROKE_DATA", str(tmp_path))
    monkeypatch.setenv("TREESTROKE_DATABASE_URL", postgres_url)
    for _ in range(2):
        assert main(["migrate"]) == 0
        assert capsys.readouterr().out.startswith("treestroke: the tables of postgresql:")
    with closing(Database(tmp_path, postgres_url)) as database:
        assert database.current()


def test_a_server_that_is_away_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("TREESTROKE_DATA", str(tmp_path))
    monkeypatch.setenv("TREESTROKE_DATABASE_URL", f"postgresql:{'//'}nobody@127.0.0.1:1/none")
    assert main(["migrate"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "the database does not answer" in line


def test_an_owner_goes_with_a_service_s_user(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("TREESTROKE_DATA", str(tmp_path))
    monkeypatch.setenv("TREESTROKE_OWNER_DATABASE_URL", f"postgresql:{'//'}owner@127.0.0.1:1/none")
    assert main(["migrate"]) == 2
    assert "TREESTROKE_OWNER_DATABASE_URL: it goes with TREESTROKE_DATABASE_URL" in capsys.readouterr().err
