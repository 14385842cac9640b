"""A disk that is full, and has room again."""

import ctypes
import errno
import json
import os
import shutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import httpx
import pytest
from tests.faults.harness import PATIENCE_SECONDS, POISONED, Service, small_tree
from tests.faults.processes import wait_for
from tests.sweeping import Clocks, Kept

from treestroke.cli import main
from treestroke.queue import Hints, make_queue
from treestroke.settings import Settings
from treestroke.store.backup_folder import BackupFolder

SIZE = "40m"
_libc = ctypes.CDLL(None, use_errno=True)


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    place = tmp_path / "disk"
    place.mkdir()
    if _libc.mount(b"tmpfs", str(place).encode(), b"tmpfs", 0, f"size={SIZE}".encode()):
        reason = f"no disk can be mounted here: {os.strerror(ctypes.get_errno())}"
        pytest.fail(reason) if os.environ.get("CI") == "true" else pytest.skip(reason)
    try:
        yield place
    finally:
        _libc.umount2(str(place).encode(), 2)


class Filler:
    """A file that takes all the room there is."""

    def __init__(self, disk: Path) -> None:
        self._path = disk / "filler"

    def fill(self) -> None:
        for size in (2**20, 2**12, 1):
            with self._path.open("ab", buffering=0) as file, suppress(OSError):
                while file.write(bytes(size)) == size:
                    pass
        assert shutil.disk_usage(self._path.parent).free == 0

    def free(self) -> None:
        self._path.unlink()


def stored(service: Service) -> set[str]:
    return {path.name for path in service.data.rglob("*") if path.is_file() and "blobs" in path.parts}


def test_a_full_disk_refuses_uploads_and_serves_nothing_half_made(tmp_path: Path, small_disk: Path) -> None:
    """Takes over 20 s: nothing can be written of an attempt that finds no room, and so its lease runs out."""
    disk = Filler(small_disk)
    with Service(tmp_path / "service", data=small_disk / "data", program=POISONED) as service:
        service.wait_for_workers(1)
        body, before = service.body(), stored(service)
        disk.fill()
        answer = service.client.post("/v1/photos", content=small_tree()[0], headers={"content-type": "image/png"})
        refused_for_space(answer)
        refused_for_space(service.client.post("/v1/models", json=body))
        assert stored(service) == before
        assert service.client.get(f"/v1/photos/{body['photo']}/image").status_code == 200
        disk.free()
        id = service.ask("held")
        service.wait_running(id)
        disk.fill()
        service.release(id)
        wait_for(lambda: attempt_over(service, id), PATIENCE_SECONDS, "the end of an attempt that finds no room")
        disk.free()
        (row,) = service.finish([id])
        assert row["status"] == "succeeded" or json.loads(row["error"])["code"] == "storage_full"
        assert {row["status"] for row in service.finish(service.ask_for(2))} == {"succeeded"}
        service.check_invariants()


def attempt_over(service: Service, id: str) -> bool:
    return service.row(id)["status"] != "running" or any(map(service.logged, ("job_broke", "database_failed")))


def refused_for_space(answer: httpx.Response) -> None:
    assert answer.status_code == 507, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["code"] == "storage_full"


def test_a_backup_that_does_not_fit_on_the_disk_is_none_until_there_is_room(
    tmp_path: Path, small_disk: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    data = tmp_path / "data"
    data.mkdir()
    kept = Kept(data, Clocks(monkeypatch))
    kept.model()
    kept.database.close()
    disk, folder = Filler(small_disk), small_disk / "backup"
    command = ["backup", str(folder), "--data", str(data)]
    disk.fill()
    assert main(command) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert f"{folder}: the backup was not finished (No space left on device); mend that and run it again" in line
    assert BackupFolder(folder).manifest() is None
    disk.free()
    assert main(command) == 0
    assert BackupFolder(folder).manifest() is not None


def test_a_hint_that_does_not_fit_on_the_disk_leaves_nothing_behind(small_disk: Path) -> None:
    hints = Hints(make_queue(Settings(data=small_disk / "data")))
    hints.send()
    disk = Filler(small_disk)
    disk.fill()
    with pytest.raises(OSError, match=os.strerror(errno.ENOSPC)):
        hints.send()
    assert len(list((small_disk / "data" / "queue" / "messages").iterdir())) == 1
