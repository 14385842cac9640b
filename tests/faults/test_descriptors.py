"""A service that may have few files open, and many who hold connections to it."""

import json
import socket
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest
from tests.api import drawn
from tests.faults.harness import PATIENCE_SECONDS
from tests.faults.processes import wait_for
from tests.running import serving

DESCRIPTORS, SILENT = 160, 150


class TooManyFollowers:
    """The service, and lines to it."""

    def __init__(self, url: str, log: Path, lines: ExitStack) -> None:
        self.url, self._log, self._lines = url, log, lines
        self._at = urlsplit(url)

    def line(self, said: str = "") -> socket.socket:
        line = socket.create_connection((self._at.hostname, self._at.port), timeout=PATIENCE_SECONDS)
        line.sendall(said.replace("HOST", self._at.netloc).encode())
        return self._lines.enter_context(line)

    def logged(self) -> list[str]:
        return [json.loads(line)["event"] for line in self._log.read_text().splitlines()]


@pytest.fixture
def crowded(tmp_path: Path) -> Iterator[TooManyFollowers]:
    with serving(tmp_path / "data", descriptors=DESCRIPTORS, workers=0) as url, ExitStack() as lines:
        yield TooManyFollowers(url, tmp_path / "data.log", lines)


def test_silent_connections_leave_everybody_else_answered(crowded: TooManyFollowers) -> None:
    for number in range(SILENT):
        crowded.line("GET / HT" if number % 2 else "")
    photos, pages = [], []
    for _ in range(5):  # each with a connection of its own
        photos.append(httpx.post(f"{crowded.url}/v1/photos", content=drawn.encoded(), timeout=PATIENCE_SECONDS))
        pages.append(httpx.get(f"{crowded.url}/v1/models", timeout=PATIENCE_SECONDS))
    assert [answer.status_code for answer in photos] == [201] * 5
    assert [answer.status_code for answer in pages] == [200] * 5
    traced = httpx.post(
        f"{crowded.url}/v1/photos/{photos[0].json()['id']}/trace", json=drawn.STROKES, timeout=PATIENCE_SECONDS
    )
    assert traced.status_code == 200
    assert len(crowded.logged()) < 10
    assert not {"request_failed", "storage_failed"} & set(crowded.logged())


def test_streams_beyond_the_bound_are_told_to_come_again(crowded: TooManyFollowers) -> None:
    with httpx.Client(base_url=crowded.url, timeout=PATIENCE_SECONDS) as client:
        photo = client.post("/v1/photos", content=drawn.encoded()).json()["id"]
        place = client.post("/v1/models", json=drawn.request(photo)).headers["location"]
        followers = client.get("/v1/limits").json()["followers"]
        for _ in range(followers + 1):  # HEAD is answered at once, and takes no place
            head = client.head(f"{place}/events")
            assert (head.status_code, head.headers["content-type"][:17]) == (200, "text/event-stream")
        streams = [crowded.line(f"GET {place}/events HTTP/1.1\r\nHost: HOST\r\n\r\n") for _ in range(followers)]
        assert {stream.recv(12) for stream in streams} == {b"HTTP/1.1 200"}
        refused = client.get(f"{place}/events")
        assert (refused.status_code, refused.json()["code"], refused.headers["retry-after"]) == (503, "overloaded", "1")
        waited = client.post("/v1/models", json=drawn.request(photo, seed=2), headers={"Prefer": "wait=20"})
        assert waited.status_code == 202
        assert client.get(place).status_code == 200
        streams[0].close()

        def followed() -> bool:
            with client.stream("GET", f"{place}/events") as stream:
                return stream.status_code == 200

        wait_for(followed, PATIENCE_SECONDS, "its place", every_s=0.2)
