"""A solve is a job like any other: what dies over it is made good."""

from collections.abc import Iterator
from typing import Any

import pytest
from tests.engines.rendered_set import photos_of, ring
from tests.faults.harness import PATIENCE_SECONDS, Service
from tests.faults.processes import wait_for

from treestroke.codec.image import encode_png

PHOTOS = 6


@pytest.fixture
def place(service: Service) -> Iterator[str]:
    """A capture that no other test has, whose cameras are being looked for."""
    place = str(service.client.post("/v1/captures").headers["location"])
    for photo in photos_of(ring(PHOTOS, 60.0)):
        service.client.post(f"{place}/photos?name={place[-6:]}-{photo.name}", content=encode_png(photo.picture))
    assert service.client.post(f"{place}/solve").status_code == 202
    wait_until(service, place, lambda told: told["status"] == "running" and told["phase"] == "solve")
    yield place
    service.client.delete(place)


def wait_until(service: Service, place: str, what: Any) -> dict[str, Any]:
    def look() -> dict[str, Any] | None:
        told = dict(service.client.get(place).json())
        return told if what(told) else None

    return wait_for(look, PATIENCE_SECONDS, f"the state of {place}", 0.1)


def finished(service: Service, place: str) -> tuple[str, int, int]:
    told = wait_until(service, place, lambda told: told["status"] not in ("queued", "running"))
    return told["status"], told["attempt"], len(told["cameras"])


def test_a_solve_whose_process_dies_is_taken_up_again(service: Service, place: str) -> None:
    for grower in service.growers():
        grower.hit()
    assert finished(service, place) == ("solved", 2, PHOTOS)


def test_a_solve_whose_worker_dies_with_its_child_is_taken_up_again(service: Service, place: str) -> None:
    for process in service.workers() + service.growers():
        process.hit()
    assert finished(service, place) == ("solved", 2, PHOTOS)


def test_a_solve_under_way_stops_when_a_photo_is_removed(service: Service, place: str) -> None:
    photo = service.client.get(place).json()["photos"][0]["id"]
    assert service.client.delete(f"{place}/photos/{photo}").status_code == 204
    assert service.client.get(place).json()["status"] == "unsolved"
    wait_for(lambda: service.logged("job_canceled"), PATIENCE_SECONDS, "the solve's end")
