import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest
from tests.api import drawn
from tests.api.conftest import PATIENCE_SECONDS, Service, running
from tests.api.test_hostile_json import probing

LONG = {"iterations": 2000, "leaf_density": 3}


@pytest.fixture(scope="module")
def hasty(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service that gives a tracing little time, with one process for it."""
    yield from running(tmp_path_factory.mktemp("hasty"), trace_seconds=1.0, tracers=1, workers=0)


def test_tracing_goes_on_while_models_grow(service: Service, photo: str) -> None:
    growing = [drawn.request(photo, seed=seed, settings=LONG) for seed in (51, 52)]
    places = [service.client.post("/v1/models", json=request).headers["location"] for request in growing]
    photos = [service.add_photo(drawn.encoded(seed=seed)) for seed in range(60, 64)]

    def draw(hand: int) -> list[int]:
        """Add strokes to a photo, six times."""
        with httpx.Client(base_url=service.url, timeout=PATIENCE_SECONDS) as client:
            place = f"/v1/photos/{photos[hand % len(photos)]}/trace"
            return [client.post(place, json={**drawn.STROKES, "rev": rev}).status_code for rev in range(6)]

    with probing(service, most_s=0.2), ThreadPoolExecutor(8) as hands:
        statuses = Counter(status for answers in hands.map(draw, range(8)) for status in answers)
    for place in places:
        service.client.post(f"{place}/cancel")
    assert statuses == {200: 48}


def test_more_than_can_wait_is_told_to_come_again(service: Service, photo: str) -> None:
    heavy = {**drawn.STROKES, "branches": [{"points": [[100, 230 - at / 10] for at in range(1000)]}] * 10}

    def ask(_: int) -> httpx.Response:
        with httpx.Client(base_url=service.url, timeout=PATIENCE_SECONDS) as client:
            return client.post(f"/v1/photos/{photo}/trace", json=heavy)

    with ThreadPoolExecutor(30) as many:
        answers = list(many.map(ask, range(30)))
    refused = [answer for answer in answers if answer.status_code == 503]
    assert {answer.status_code for answer in answers} <= {200, 503}
    assert all(int(answer.headers["retry-after"]) >= 1 for answer in refused)
    assert {answer.json()["code"] for answer in refused} <= {"overloaded"}
    assert len(answers) - len(refused) >= 16
    assert service.client.post(f"/v1/photos/{photo}/trace", json=drawn.STROKES).status_code == 200


def test_what_takes_too_long_is_stopped_and_the_next_is_answered(hasty: Service) -> None:
    large = {**drawn.STROKES, "branches": [{"points": [[100, 230 - at / 100] for at in range(9999)]}] * 199}
    photo = _patiently(hasty, drawn.encoded())
    told = hasty.client.post(f"/v1/photos/{photo}/trace", json=large)
    assert (told.status_code, told.json()["code"]) == (503, "tracing_stopped")
    assert told.headers["retry-after"] == "1"
    assert 'treestroke_tracers_replaced_total{why="slow"}' in hasty.client.get("/metrics").text
    assert hasty.client.get("/livez").status_code == 200
    assert _patiently(hasty, drawn.encoded())


def _patiently(service: Service, content: bytes) -> str:
    """Upload a photo until its decoding was quick enough."""
    deadline = time.monotonic() + PATIENCE_SECONDS
    while time.monotonic() < deadline:
        answer = service.client.post("/v1/photos", content=content)
        if answer.status_code == 201:
            return str(answer.json()["id"])
    raise AssertionError(answer.text)
