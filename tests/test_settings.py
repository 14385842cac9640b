"""The service's settings, and the commands that read them: one line where something is wrong."""

import socket
from pathlib import Path

import pytest

from treestroke.cli import main
from treestroke.core.errors import SettingsError
from treestroke.settings import PREFIX, Settings, read_settings


def test_without_variables_the_defaults_hold() -> None:
    settings = read_settings()
    assert (settings.host, settings.port, settings.embedded) == ("127.0.0.1", 8000, True)
    assert settings.folder == Path.home() / ".treestroke"


def test_a_variable_sets_and_a_flag_goes_before_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TREESTROKE_PORT", "8001")
    monkeypatch.setenv("TREESTROKE_TRACERS", "3")
    settings = read_settings(port="8002")
    assert (settings.port, settings.tracers) == (8002, 3)


def test_only_where_teams_share_the_service_their_jobs_under_way_are_limited() -> None:
    assert read_settings().most_running == 0
    assert read_settings(database_url="postgresql:///trees").most_running == 2


def test_an_empty_variable_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TREESTROKE_WORKERS", "")
    assert read_settings() == Settings()


def test_a_file_among_the_secrets_gives_what_a_variable_does_not(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("treestroke.settings.SECRETS", tmp_path)
    monkeypatch.setenv("TREESTROKE_PORT", "8001")
    for name, value in {"TREESTROKE_SECRET": "oak" * 20, "TREESTROKE_PORT": "1", "of_another_program": "x"}.items():
        (tmp_path / name).write_text(f"{value}\n")
    settings = read_settings()
    assert (settings.secret, settings.port) == ("oak" * 20, 8001)


def test_a_file_among_the_secrets_that_is_no_setting_is_refused(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("treestroke.settings.SECRETS", tmp_path)
    (tmp_path / "TREESTROKE_SECRETS").touch()
    with pytest.raises(SettingsError, match="TREESTROKE_SECRETS: there is no such setting"):
        read_settings()


def test_what_is_handed_to_another_process_is_read_there_alike(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    settings = read_settings(data=tmp_path, port=0, keep_days=1.5, broker_url="redis://127.0.0.1:1/0")
    for name, value in settings.environment().items():
        monkeypatch.setenv(name, value)
    assert read_settings() == settings


@pytest.mark.parametrize(
    "url", ["forest", f"https:{'//'}forest/trees", f"s3:{'//'}", f"s3:{'//'}Forest", f"s3:{'//'}f/a//b"]
)
def test_a_bucket_is_named_by_its_url(url: str) -> None:
    for good in (f"s3:{'//'}forest", f"s3:{'//'}forest/", f"s3:{'//'}my.forest-1/trees/of_2026"):
        assert read_settings(bucket_url=good).bucket_url == good
    with pytest.raises(SettingsError, match=r"^TREESTROKE_BUCKET_URL: .* names no bucket; give s3:"):
        read_settings(bucket_url=url)


@pytest.mark.parametrize("name", ["TREESTROKE_COLOUR", "TREESTROKE_", "treestroke_ports"])
def test_an_unknown_variable_is_refused(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(name, "1")
    with pytest.raises(SettingsError, match=rf"^{name}: there is no such setting; .*TREESTROKE_PORT"):
        read_settings()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("PORT", "65536"),
        ("PORT", "eighty"),
        ("WORKERS", "-1"),
        ("WORKERS", "1.5"),
        ("TRACERS", "0"),
        ("TRACE_SECONDS", "0"),
        ("TRACE_SECONDS", "nan"),
        ("MODEL_SECONDS", "inf"),
        ("MEMORY_MB", "10"),
        ("KEEP_DAYS", "-1"),
        ("BROKER_URL", "amqp:"),
        ("DATABASE_URL", "mysql://127.0.0.1/trees"),
        ("OIDC_ISSUER", f"http:{'//'}id.example"),
        ("OIDC_ISSUER", "https:"),
        ("OIDC_ISSUER", f"https:{'//'}id.example?realm=trees"),
        ("OIDC_ISSUER", f"https:{'//'}id.example"),
        ("OIDC_ROLE", "owner"),
        ("PORT", "9" * 5000),
    ],
)
def test_a_value_that_is_not_allowed_is_one_line(
    name: str, value: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(f"{PREFIX}{name}", value)
    assert main(["serve"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"treestroke: {PREFIX}{name}: ")
    assert len(line) < 250


def test_an_issuer_needs_a_client(monkeypatch: pytest.MonkeyPatch) -> None:
    shared = {"database_url": "postgresql://127.0.0.1/trees", "oidc_issuer": f"http:{'//'}127.0.0.1:9000/realm"}
    with pytest.raises(SettingsError, match=r"^TREESTROKE_OIDC_CLIENT: "):
        read_settings(**shared)
    assert read_settings(**shared, oidc_client="trees").oidc_role == "member"


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        (["--port", "eighty"], "--port: 'eighty' is not allowed"),
        (["--host", "0.0.0.0"], "--host 0.0.0.0: without keys only this machine"),
        (["--host", "example"], "--host example: without keys only this machine"),
        (["--data", "~nobody-of-this-name/data"], "--data"),
        (["--colour", "red"], "unrecognized arguments"),
    ],
)
def test_a_flag_that_is_not_allowed_is_one_line(
    flags: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["serve", *flags]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


def test_a_port_that_is_taken_is_one_line_with_the_way_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        assert main(["serve", "--port", str(port), "--data", str(tmp_path / "data")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert f"--port {port}: another program listens there" in line
    assert "make run PORT=" in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", ["serve", "worker", "doctor"])
def test_help_names_every_flag(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as left:
        main([command, "--help"])
    assert left.value.code == 0
    told = capsys.readouterr().out
    flags = ["--data", "--debug"] + (["--host", "--port"] if command == "serve" else [])
    assert all(flag in told for flag in flags)
