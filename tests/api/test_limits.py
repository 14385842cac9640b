"""A service that keeps little: what it does not take, and what it says."""

from collections.abc import Iterator

import httpx
import numpy as np
import pytest
from tests.api import drawn
from tests.api.conftest import Service, running

from treestroke.codec.image import encode_png

MB = 10**6


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    yield from running(tmp_path_factory.mktemp("small"), workers=0, tracers=1, photo_mb=1, photos_mb=1)


def noise(side: int, seed: int = 0) -> bytes:
    """Make a photo of so many px a side that takes three bytes each, however it is kept."""
    return encode_png(np.random.default_rng(seed).integers(0, 256, (side, side, 3), dtype=np.uint8))


def refusal(answer: httpx.Response) -> tuple[int, str]:
    return answer.status_code, answer.json()["code"]


def test_a_photo_that_would_take_too_much_is_refused(small: Service) -> None:
    answer = small.client.post("/v1/photos", files={"file": noise(700)})
    assert refusal(answer) == (422, "photo_too_large_stored")
    assert answer.json()["detail"] == "photo: kept as PNG it takes 1.5 MB, at most 1 MB are allowed; resize it"


def test_beyond_what_all_may_take_none_is_taken_by_either_way_and_a_deleted_one_still_counts(small: Service) -> None:
    first = small.add_photo(noise(500))
    ways = [
        lambda: small.client.post("/v1/photos", files={"file": noise(500, 1)}),
        lambda: small.client.post("/v1/models", **drawn.form(noise(500, 2))),
    ]
    for way in ways:
        assert refusal(way()) == (507, "photos_full")
    assert small.client.delete(f"/v1/photos/{first}").status_code == 204
    for way in ways:
        assert refusal(way()) == (507, "photos_full")
    assert small.rows("photos") == 1
    assert small.rows("models") == 0


def test_the_limits_are_told(small: Service) -> None:
    limits = small.client.get("/v1/limits").json()
    assert (limits["photo_stored_bytes"], limits["photos_stored_bytes"]) == (MB, MB)
