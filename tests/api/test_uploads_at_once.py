"""Many uploads of one person at once: the surplus is refused, and nobody else notices."""

import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest
from fastapi import FastAPI
from tests.api import drawn
from tests.api.shared_service import SECONDS, as_person, shared_service
from tests.faults.processes import wait_for
from tests.postgres import PostgresServer

from treestroke.api.rates import UPLOADS_AT_ONCE
from treestroke.settings import Settings

PNG = {"Content-Type": "image/png"}
ANN, BEN = (PNG | as_person("oaks", name) for name in ("ann", "ben"))


@pytest.fixture(scope="module")
def shared(
    postgres: PostgresServer, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[httpx.Client, FastAPI]]:
    data, url = tmp_path_factory.mktemp("shared"), postgres.fresh()
    with shared_service(Settings(data=data, database_url=url, workers=0, tracers=1, trace_seconds=300)) as found:
        yield found


def test_a_person_who_uploads_too_much_at_once_is_refused_and_nobody_else(
    shared: tuple[httpx.Client, FastAPI],
) -> None:
    web, app = shared
    photo, go_on = drawn.encoded(), threading.Event()

    def held() -> Iterator[bytes]:
        """Send a photo, and what no photo has behind it, fast enough not to be dropped, until it is time to end."""
        yield photo
        while not go_on.wait(0.5):
            yield bytes(30_000)

    with ThreadPoolExecutor(UPLOADS_AT_ONCE) as hands:
        try:
            slow = [hands.submit(web.post, "/v1/photos", content=held(), headers=ANN) for _ in range(UPLOADS_AT_ONCE)]
            wait_for(lambda: sum(app.state.uploads.values()) == UPLOADS_AT_ONCE, SECONDS, "uploads under way")
            surplus = [web.post("/v1/photos", content=photo, headers=ANN) for _ in range(20 - UPLOADS_AT_ONCE)]
            assert {(answer.status_code, answer.json()["code"]) for answer in surplus} == {(429, "rate_limited")}
            assert {answer.headers["Retry-After"] for answer in surplus} == {"1"}
            assert web.get("/v1/models", headers=ANN).status_code == 200
            assert web.post("/v1/photos", content=photo, headers=BEN).status_code == 201
        finally:
            go_on.set()
        assert {one.result().status_code for one in slow} == {201}
    wait_for(lambda: not app.state.uploads, SECONDS, "the end of the uploads")
    assert web.post("/v1/photos", content=photo, headers=ANN).status_code == 201


def test_an_upload_that_fails_gives_its_place_back(shared: tuple[httpx.Client, FastAPI]) -> None:
    web, app = shared
    for _ in range(UPLOADS_AT_ONCE + 1):
        assert web.post("/v1/photos", content=b"no photo", headers=BEN).status_code == 422
    wait_for(lambda: not app.state.uploads, SECONDS, "the end of the uploads")
