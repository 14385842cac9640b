"""One real service for most tests of the API, and what they ask it for."""

import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from tests.api import drawn
from tests.running import serving

PATIENCE_SECONDS = 300.0
"""Emergency exit of what is waited for: nothing is expected to take this long, however busy the machine is."""


def problem_of(answer: httpx.Response) -> dict[str, Any]:
    """Return a problem without the id of its request, which no other has."""
    return {key: value for key, value in answer.json().items() if key != "request_id"}


@dataclass(frozen=True)
class Service:
    """A service that runs: its address, its data folder, and a client of it."""

    url: str
    data: Path
    client: httpx.Client

    @property
    def port(self) -> int:
        return httpx.URL(self.url).port or 0

    def rows(self, table: str) -> int:
        """Count the rows of a table."""
        with closing(sqlite3.connect(self.data / "treestroke.sqlite3")) as database:
            return int(database.execute(f"SELECT count(*) FROM {table}").fetchone()[0])

    def settle(self) -> None:
        """Wait until no model queues or grows."""
        deadline = time.monotonic() + PATIENCE_SECONDS
        with closing(sqlite3.connect(self.data / "treestroke.sqlite3")) as database:
            busy = "SELECT count(*) FROM models WHERE status IN ('queued', 'running')"
            while database.execute(busy).fetchone()[0]:
                assert time.monotonic() < deadline
                time.sleep(0.1)

    def stored(self) -> tuple[int, int, int, int]:
        """Count what is kept once all is still: photos, models, blobs, and files in the folder for temporary ones."""
        self.settle()
        blobs, temporary = (sum(path.is_file() for path in (self.data / one).rglob("*")) for one in ("blobs", "tmp"))
        return self.rows("photos"), self.rows("models"), blobs, temporary

    def web_process(self) -> Path:
        """Find the web process's folder below /proc."""
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                command, environment = (folder / "cmdline").read_bytes(), (folder / "environ").read_bytes()
            except OSError:
                continue
            if b"treestroke.api" in command and f"TREESTROKE_DATA={self.data}\0".encode() in environment:
                return folder
        raise AssertionError("no web process")

    def add_photo(self, content: bytes) -> str:
        """Upload a photo and give its id."""
        answer = self.client.post("/v1/photos", files={"file": content})
        assert answer.status_code == 201, answer.text
        return str(answer.json()["id"])

    def make(self, **request: Any) -> dict[str, Any]:
        """Ask for a model and wait for it."""
        return self.finished(self.client.post("/v1/models", json=request, headers={"Prefer": "wait=60"}))

    def finished(self, answer: httpx.Response) -> dict[str, Any]:
        """Wait for a model that was asked for, which takes long where the machine is busy."""
        assert answer.status_code in (200, 202), answer.text
        told, deadline = answer.json(), time.monotonic() + PATIENCE_SECONDS
        while told["status"] in ("queued", "running"):
            assert time.monotonic() < deadline, told
            time.sleep(0.05)
            told = self.client.get(f"/v1/models/{told['id']}").json()
        return dict(told)


def running(folder: Path, **settings: object) -> Iterator[Service]:
    with serving(folder / "data", **settings) as url, httpx.Client(base_url=url, timeout=PATIENCE_SECONDS) as client:
        yield Service(url, folder / "data", client)


@pytest.fixture(scope="package")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    yield from running(tmp_path_factory.mktemp("service"), workers=2)


@pytest.fixture(scope="package")
def client(service: Service) -> httpx.Client:
    return service.client


@pytest.fixture(scope="package")
def photo(service: Service) -> str:
    """A stored photo that no test deletes."""
    return service.add_photo(drawn.encoded())


@pytest.fixture(scope="package")
def made(service: Service, photo: str) -> dict[str, Any]:
    """A finished model that no test changes."""
    model = service.make(**drawn.request(photo, name="The old oak"))
    assert model["status"] == "succeeded"
    return model
