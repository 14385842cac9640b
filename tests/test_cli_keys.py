from pathlib import Path

import pytest
from tests.accounts import SECRET, accounts

from treestroke.cli import main
from treestroke.service.accounts import Unauthenticated
from treestroke.store.database import Database


@pytest.fixture
def on_postgres(tmp_path: Path, postgres_url: str, monkeypatch: pytest.MonkeyPatch) -> Database:
    """A database without tables, which the command line knows."""
    for name, value in {"DATA": str(tmp_path), "DATABASE_URL": postgres_url, "SECRET": SECRET}.items():
        monkeypatch.setenv(f"TREESTROKE_{name}", value)
    return Database(tmp_path, postgres_url)


def test_the_first_key_of_a_team_is_made_listed_and_revoked(
    on_postgres: Database, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["keys", "add", "--team", "Oaks", "--member", "Ann", "--scopes", "team", "--days", "3"]) == 0
    key = capsys.readouterr().out.removesuffix("\n")
    who = accounts(on_postgres).by_key(key)
    assert (who.name, who.role, who.scopes, who.read_only) == ("Ann", "owner", {"team"}, False)
    assert main(["keys", "list", "--team", "Oaks"]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    assert line.startswith(f"{who.credential}  {key[:7]}...  Oaks  Ann (owner)  team  expires 2")
    assert main(["keys", "revoke", who.credential]) == 0
    with pytest.raises(Unauthenticated):
        accounts(on_postgres).by_key(key)
    assert main(["keys", "list"]) == 0
    assert capsys.readouterr().out.endswith("revoked\n")
    on_postgres.close()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["add"], "--team: it is missing"),
        (["add", "--team", "Oaks", "--role", "king"], "--role king: there is no such role"),
        (["add", "--team", "Oaks", "--days", "many"], "days: "),
        (["add", "--team", "Oaks", "--scopes", "all"], "scopes"),
        (["revoke"], "the key's id is missing"),
        (["dance"], "invalid choice: 'dance'"),
    ],
)
def test_what_cannot_be_used_is_one_line(
    on_postgres: Database, capsys: pytest.CaptureFixture[str], given: list[str], said: str
) -> None:
    assert main(["keys", *given]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


def test_a_service_without_a_database_of_its_own_has_no_keys(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["keys", "list"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "no keys; set TREESTROKE_DATABASE_URL" in line


@pytest.mark.parametrize("secret", ["", "short"])
def test_neither_keys_nor_service_begin_without_a_secret(
    on_postgres: Database, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], secret: str
) -> None:
    monkeypatch.setenv("TREESTROKE_SECRET", secret)
    for command in (["keys", "add", "--team", "Oaks"], ["serve", "--port", "0"]):
        assert main(command) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert "TREESTROKE_SECRET: a service with keys needs a secret of at least 32 characters" in line
        assert not secret or secret not in line


def test_a_service_on_another_address_needs_names(on_postgres: Database, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serve", "--host", "0.0.0.0", "--port", "0"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "--host 0.0.0.0: name what the service answers to by TREESTROKE_HOSTS" in line


def test_a_database_that_does_not_answer_is_one_line(
    on_postgres: Database, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("TREESTROKE_DATABASE_URL", f"postgresql:{'//'}postgres@127.0.0.1:1/none")
    assert main(["keys", "list"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "TREESTROKE_DATABASE_URL: the database does not answer" in line
