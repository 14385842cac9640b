"""Every part of the service, well and ill for real."""

import resource
import shutil
import socket
import sqlite3
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import closing
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from tests.bucket import BUCKET, S3Server
from tests.faults.processes import wait_for
from tests.postgres import PostgresServer
from tests.promises import kept
from tests.rows import Messages

from treestroke.cli import main
from treestroke.service.dispatch import Dispatcher, record_heartbeat
from treestroke.service.doctor import Finding, examine, examine_deployment, examine_installation
from treestroke.service.photos import Resources
from treestroke.service.readiness import readiness
from treestroke.settings import Settings, read_settings
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.scope import LOCAL
from treestroke.store.tables import PhotoRow


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A data folder with a database and one photo in it."""
    place = tmp_path / "data"
    place.mkdir(0o700)
    database = Database(place).of(LOCAL)
    database.migrate()
    blob = open_blobs(database, place).of(LOCAL).put(b"photo")
    with database.writing() as session:
        session.add(PhotoRow(id="pho_1", sha256="0" * 64, width=64, height=64, blob=blob, created=0.0))
    database.close()
    return place


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    place = tmp_path / "disk"
    place.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(place)], capture_output=True).returncode:
        pytest.skip("no file system may be mounted here")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def settings_of(folder: Path, **given: object) -> Settings:
    return read_settings(**{"data": folder, "port": 0, **given})


def findings(folder: Path, **given: object) -> dict[str, Finding]:
    return {finding.part: finding for finding in examine_deployment(settings_of(folder, **given))}


def ill(folder: Path, **given: object) -> dict[str, str]:
    return {part: finding.found for part, finding in findings(folder, **given).items() if not finding.ok}


def test_all_is_well(folder: Path) -> None:
    found = {finding.part: finding for finding in examine(settings_of(folder))}
    assert list(found) == [
        "packages", "growth engine", "tracers", "data folder", "disk", "web process", "queue", "database", "files",
        "workers",
    ]  # fmt: skip
    assert ill(folder) == {}
    assert found["files"].found == "all 1 intact"


@pytest.mark.parametrize(("broker_url", "missing"), [("", ""), ("redis://127.0.0.1/0", "missing: packaging")])
def test_what_the_worker_imports_for_a_redis_is_missed_where_there_is_one(
    folder: Path, monkeypatch: pytest.MonkeyPatch, broker_url: str, missing: str
) -> None:
    for name in ("kombu.transport.redis", "packaging.version"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setitem(sys.modules, "packaging", None)
    packages = next(examine_installation(settings_of(folder, broker_url=broker_url)))
    assert (packages.part, packages.ok) == ("packages", not missing)
    assert missing in packages.found


def test_tracers_that_cannot_start_are_ill(folder: Path) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    looks = examine_installation(settings_of(folder))
    next(looks), next(looks)
    try:
        resource.setrlimit(resource.RLIMIT_NOFILE, (4, hard))
        tracers = next(looks)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    assert (tracers.part, tracers.ok) == ("tracers", False)
    assert tracers.found == "cannot be started: Too many open files"
    assert "ulimit" in tracers.mend


class Answers(BaseHTTPRequestHandler):
    """Says about itself what its server was told to say."""

    def do_GET(self) -> None:
        self.send_response(200)
        self.end_headers()
        self.wfile.write(self.server.said)  # type: ignore[attr-defined]

    def log_message(self, *_: object) -> None:
        pass


@pytest.mark.parametrize(
    ("said", "found"),
    [
        (b'{"status": "ok", "checks": {"dispatcher": "ok", "tracers": "ok"}}', None),
        (b'{"status": "degraded", "checks": {"workers": "none; jobs wait", "tracers": "ok"}}', None),
        (b'{"status": "degraded", "checks": {"dispatcher": "does not run", "broker": "ok"}}', "dispatcher: does not"),
        (b'{"status": "down", "checks": {"database": "unavailable"}}', "database: unavailable"),
        (b"<html>", "is another program"),
    ],
)
def test_a_web_process_that_runs_is_asked_how_it_is(folder: Path, said: bytes, found: str | None) -> None:
    with ThreadingHTTPServer(("127.0.0.1", 0), Answers) as server:
        server.said = said  # type: ignore[attr-defined]
        threading.Thread(target=server.serve_forever, daemon=True).start()
        looked = ill(folder, port=server.server_port)
        server.shutdown()
    assert list(looked) == ([] if found is None else ["web process"])
    assert found is None or found in looked["web process"]


def test_a_web_process_that_does_not_run_is_for_its_owner_to_start(folder: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    found = findings(folder, port=port)["web process"]
    assert (found.ok, found.found) == (True, f"none at 127.0.0.1:{port}")


def test_a_folder_that_is_not_there_is_well_and_is_not_made(tmp_path: Path) -> None:
    found = findings(tmp_path / "a" / "b")
    assert all(finding.ok for finding in found.values())
    assert "`treestroke serve` creates it" in found["data folder"].found
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_ready_once_the_database_is_gone_from_its_place(resources: Resources) -> None:
    dispatcher = Dispatcher(resources.database, resources.blobs, Messages(), 0)
    assert readiness(resources, dispatcher).checks["database"] == "ok"
    resources.database.path.rename(resources.database.path.with_name("away"))
    health = readiness(resources, dispatcher)
    assert (health.status, health.checks["database"]) == ("down", "unavailable")


def test_looking_leaves_no_file(folder: Path) -> None:
    before = sorted(folder.rglob("*"))
    ill(folder)
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize("below", [".", "inner"])
def test_a_file_in_the_folder_s_place_is_ill(tmp_path: Path, below: str) -> None:
    (tmp_path / "data").write_bytes(b"")
    assert list(ill(tmp_path / "data" / below)) == ["data folder"]


def test_a_disk_that_is_nearly_full_is_ill(small_disk: Path) -> None:
    found = findings(small_disk)
    assert not found["disk"].ok
    assert found["disk"].mend.startswith("free space")


def test_a_queue_that_is_no_folder_is_ill(folder: Path) -> None:
    assert findings(folder)["queue"].ok
    (folder / "queue").touch()
    found = findings(folder)["queue"]
    assert (found.ok, found.found) == (False, f"{folder / 'queue'}: Not a directory")
    assert "move it away" in found.mend


def test_a_file_that_cannot_be_read_is_named_and_the_rest_is_looked_at(folder: Path) -> None:
    (path,) = (one for one in (folder / "blobs").rglob("*") if one.is_file())
    path.unlink()
    path.mkdir()
    found = findings(folder)
    assert found["files"].found == f"1 of 1 damaged or missing: {path.name}: Is a directory"
    assert "workers" in found


def test_a_redis_that_does_not_run_is_ill_and_nothing_else(folder: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    found = findings(folder, broker_url=f"redis://127.0.0.1:{port}/0")
    assert [part for part, finding in found.items() if not finding.ok] == ["queue"]
    assert "start Redis or free its memory" in found["queue"].mend


def test_a_redis_that_is_silent_is_ill_soon(folder: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server, kept(5.0):
        assert list(ill(folder, broker_url=f"redis://127.0.0.1:{server.getsockname()[1]}/0")) == ["queue"]


@pytest.mark.skipif(shutil.which("redis-server") is None, reason="redis-server is not installed")
@pytest.mark.parametrize(("memory", "said"), [("0", None), ("1kb", "maxmemory")])
def test_a_redis_is_well_unless_it_is_full(folder: Path, memory: str, said: str | None) -> None:
    socket_file = folder.parent / "redis.sock"
    options = ["--port", "0", "--unixsocket", str(socket_file), "--save", "", "--maxmemory", memory]
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    options[1] = port
    redis = subprocess.Popen(["redis-server", *options], stdout=subprocess.DEVNULL, cwd=folder.parent)
    try:
        wait_for(socket_file.exists, 60, "redis-server")
        found = ill(folder, broker_url=f"redis://127.0.0.1:{port}/0")
    finally:
        redis.terminate()
        redis.wait(10)
    assert list(found) == ([] if said is None else ["queue"])
    assert said is None or said in found["queue"]


def test_a_damaged_database_is_ill(folder: Path) -> None:
    path = folder / "treestroke.sqlite3"
    path.write_bytes(path.read_bytes()[:4096] + b"\xff" * 8192)
    assert "database" in ill(folder)
    path.write_bytes(b"no database at all" * 1000)
    assert "not a database" in ill(folder)["database"]


def test_a_database_that_is_lost_or_empty_beside_files_is_ill(folder: Path) -> None:
    (folder / "treestroke.sqlite3").unlink()
    for _ in range(2):
        found = findings(folder)["database"]
        assert (found.ok, found.mend) == (
            False, "restore it from a copy, or move the folder 'blobs' away to start with an empty database",
        )  # fmt: skip
        assert f"the database is lost or empty, but there are files in {folder / 'blobs'}" in found.found
        (folder / "treestroke.sqlite3").write_bytes(b"")


def test_a_database_of_another_version_is_ill(folder: Path) -> None:
    with closing(sqlite3.connect(folder / "treestroke.sqlite3")) as connection:
        connection.execute("UPDATE alembic_version SET version_num = 'later'")
        connection.commit()
    found = findings(folder)["database"]
    assert "a newer treestroke made this database (its version is later" in found.found
    assert "install that treestroke again" in found.mend
    with closing(sqlite3.connect(folder / "treestroke.sqlite3")) as connection:
        connection.execute("UPDATE alembic_version SET version_num = '0004'")
        connection.commit()
    assert ill(folder) == {"database": "of an older version"}


def test_a_postgres_is_sound_of_an_older_version_or_away(
    tmp_path: Path, postgres: PostgresServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "data"
    assert findings(place, database_url=postgres.fresh())["database"].ok is False  # it has no tables yet
    place.mkdir(0o700)
    sound = findings(place, database_url=postgres.fresh_with_tables())
    assert {part: finding.found for part, finding in sound.items() if not finding.ok} == {}
    away = findings(place, database_url=postgres.url("nowhere"))["database"]
    assert (away.ok, away.mend) == (False, "start Postgres, or correct TREESTROKE_DATABASE_URL")
    assert "\n" not in away.found


def test_files_that_are_damaged_or_gone_are_ill_and_named(folder: Path) -> None:
    (blob,) = (path for path in (folder / "blobs").rglob("*") if path.is_file())
    blob.write_bytes(b"phoso")
    assert ill(folder) == {"files": f"1 of 1 damaged or missing: {blob.name}: damaged"}
    blob.unlink()
    assert ill(folder) == {"files": f"1 of 1 damaged or missing: {blob.name}: missing"}


def test_files_in_a_bucket_are_compared_there_and_not_their_copies(
    folder: Path, s3_server: S3Server, bucket_url: str
) -> None:
    database = Database(folder)
    name = open_blobs(database, folder, bucket_url).of(LOCAL).put(b"photo")
    assert findings(folder, bucket_url=bucket_url)["files"].ok
    open_blobs(database, folder, bucket_url).of(LOCAL).check(name)
    database.close()
    key = f"{bucket_url.rpartition('/')[2]}/local/{name[:2]}/{name}"
    s3_server.client().put_object(Bucket=BUCKET, Key=key, Body=b"phoso")
    assert ill(folder, bucket_url=bucket_url) == {"files": f"1 of 1 damaged or missing: {name}: damaged"}


def test_a_bucket_that_is_not_there_is_ill(folder: Path, bucket_url: str) -> None:
    missing = bucket_url.replace(BUCKET, "no-forest")
    found = findings(folder, bucket_url=missing)["files"]
    assert (found.ok, found.found.startswith(missing)) == (False, True)
    assert "TREESTROKE_BUCKET_URL" in found.mend


def test_a_folder_that_others_may_look_into_is_ill(folder: Path) -> None:
    folder.chmod(0o755)
    found = findings(folder)["data folder"]
    assert (found.ok, found.mend) == (False, f"chmod 700 {folder}")


def test_a_worker_that_does_not_beat_is_ill(folder: Path) -> None:
    database = Database(folder).of(LOCAL)
    record_heartbeat(database, "dead-1", 1, "treestroke")
    database.close()
    with kept(6.0):
        assert ill(folder) == {"workers": "0 of 1 are running"}


def test_the_command_says_what_mends_it_and_leaves_with_1(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TREESTROKE_PORT", "0")
    assert main(["doctor", "--data", str(folder)]) == 0
    shutil.rmtree(folder / "blobs")
    assert main(["doctor", "--data", str(folder)]) == 1
    told = capsys.readouterr()
    assert "ILL  files          1 of 1 damaged or missing: " in told.out
    assert f"                    mend: restore them from a copy of {folder / 'blobs'}" in told.out
    assert told.err == "treestroke: 1 of 10 parts are ill\n"
