"""Backups of a service for teams that grows and deletes trees, and the service that is made of one of them."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest
from sqlalchemy import select
from tests.faults.harness import PATIENCE_SECONDS, QUICK, small_tree
from tests.faults.processes import wait_for
from tests.hosted import HOST, ORIGIN, PROXIED, SECRET, Hosted
from tests.postgres import PostgresServer
from tests.running import serving

from treestroke.cli import main
from treestroke.store.backup_folder import BackupFolder
from treestroke.store.database import Database
from treestroke.store.scope import SERVICE
from treestroke.store.table_rows import read
from treestroke.store.tables import TERMINAL, ModelRow


class Place:
    """Where a service keeps its rows and files; the command line and services get it by variables."""

    def __init__(self, folder: Path, database_url: str, bucket_url: str) -> None:
        self.folder, self.settings = folder, {"database_url": database_url, "bucket_url": bucket_url}
        self.database = Database(folder, database_url)

    def run(self, monkeypatch: pytest.MonkeyPatch, *command: str) -> int:
        with monkeypatch.context() as given:
            for name, value in self.settings.items():
                given.setenv(f"TREESTROKE_{name.upper()}", value)
            return main([*command, "--data", str(self.folder)])

    @contextmanager
    def served(self) -> Iterator[Hosted]:
        terms = {"secret": SECRET, "hosts": HOST, "proxies": "127.0.0.1", "tracers": 1, "workers": 1}
        with (
            serving(self.folder, **self.settings, **terms) as url,
            httpx.Client(base_url=url, headers=PROXIED, timeout=PATIENCE_SECONDS) as client,
        ):
            yield Hosted(client, self.database)

    def statuses(self) -> dict[str, str]:
        with self.database.of(SERVICE).reading() as session:
            return {row.id: row.status for row in session.scalars(select(ModelRow))}

    def finish(self) -> dict[str, str]:
        """Wait until all models have ended; give how."""
        wait_for(lambda: set(self.statuses().values()) <= set(TERMINAL), PATIENCE_SECONDS, "the end of all models")
        return self.statuses()


@pytest.fixture(params=["folder", "bucket"])
def places(request: pytest.FixtureRequest, tmp_path: Path, postgres: PostgresServer) -> list[Place]:
    """Two places: one with tables, an empty one."""
    buckets = ["", ""]
    if request.param == "bucket":
        buckets = [request.getfixturevalue("bucket_url"), request.getfixturevalue("s3_server").fresh()]
    urls = [postgres.fresh_with_tables(), postgres.fresh()]
    return [Place(tmp_path / name, *each) for name, *each in zip(("old", "new"), urls, buckets, strict=True)]


class Grown:
    """Trees that one person asks a service for."""

    def __init__(self, hosted: Hosted, key: str) -> None:
        self._hosted, self._key, self._seed = hosted, key, 0
        self._photo = self.ask("POST", "/v1/photos", files={"file": small_tree()[0]})["id"]

    def ask(self, method: str, path: str, **request: Any) -> Any:
        answer = self._hosted.ask(self._key, method, path, **request)
        assert answer.status_code < 300, answer.text
        return answer.json() if answer.content else None

    def one_more(self) -> str:
        self._seed += 1
        wanted = {"photo": self._photo, "strokes": small_tree()[1], "settings": QUICK, "seed": self._seed}
        return str(self.ask("POST", "/v1/models", json=wanted)["id"])


def test_a_service_is_restored_from_a_backup_that_was_made_under_load(
    places: list[Place], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old, new = places
    folder = BackupFolder(tmp_path / "backup")
    with old.served() as hosted:
        key = hosted.key()
        trees = Grown(hosted, key)
        first = trees.one_more()
        old.finish()
        shared = trees.ask("POST", f"/v1/models/{first}/shares", json={})["url"].removeprefix(ORIGIN)
        over = threading.Event()
        load = threading.Thread(target=grow_and_delete, args=(trees, over))
        load.start()
        try:
            codes = [old.run(monkeypatch, "backup", str(folder.path)) for _ in range(2)]
        finally:
            over.set()
            load.join()
        last = trees.one_more()
        codes.append(old.run(monkeypatch, "backup", str(folder.path)))
    assert codes == [0, 0, 0]
    assert new.run(monkeypatch, "restore", str(folder.path), "--verify") == 0  # which compares all hashes
    manifest = folder.manifest()
    assert manifest is not None
    told = {row["id"]: row["status"] for row in read(folder.tables(manifest.number), "models")}
    assert {first, last} <= told.keys()
    assert new.statuses() == {id: "queued" if status == "running" else status for id, status in told.items()}
    with new.served() as hosted:
        assert hosted.ask(key, "GET", f"/v1/models/{first}").status_code == 200
        assert hosted.ask(key, "GET", f"/v1/models/{first}/tree.glb").content.startswith(b"glTF")
        assert hosted.client.get(shared).status_code == 200
        ends = new.finish()
        assert "failed" not in ends.values()
        assert (ends[first], ends[last]) == ("succeeded", "succeeded")
    for place in places:
        place.database.close()


def grow_and_delete(trees: Grown, over: threading.Event) -> None:
    """Ask for trees, and delete every other one, which is stopped where it is under way."""
    while not over.wait(0.5):
        trees.one_more()
        trees.ask("DELETE", f"/v1/models/{trees.one_more()}")
