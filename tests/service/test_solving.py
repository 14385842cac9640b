from collections.abc import Callable, Sequence

import numpy as np
import pytest
from tests.api import drawn
from tests.rows import claim
from tests.structures import small_structure

from treestroke.codec.image import decode_photo
from treestroke.core.capture import CapturedPhoto, Structure
from treestroke.core.errors import CaptureError
from treestroke.core.progress import Report
from treestroke.engines.child import Bounds
from treestroke.engines.solving import SolveEnded
from treestroke.service import captures, solving
from treestroke.service.captures import StoredCapture
from treestroke.service.photos import Resources
from treestroke.service.solving import solve_capture
from treestroke.store.leases import MAX_ATTEMPTS

Solve = Callable[[Sequence[CapturedPhoto], Bounds, Report], Structure]


@pytest.fixture
def capture(resources: Resources) -> StoredCapture:
    """A queued capture of five photos, sent in no order."""
    id = captures.make_capture(resources.database, b"").id
    for seed in (3, 0, 4, 1, 2):
        captures.add_photo(resources, id, f"{seed}.png", drawn.encoded(seed=seed))
    return captures.solve(resources, id)


def carry_out(resources: Resources, capture: StoredCapture, seconds: float = 60) -> StoredCapture:
    assert capture.solve is not None
    solve_capture(resources.database, resources.blobs, claim(resources.database, capture.solve), seconds)
    return captures.find_capture(resources.database, capture.id)


def use(monkeypatch: pytest.MonkeyPatch, solve: Solve) -> None:
    """Put a stand-in in the place of the engine."""
    monkeypatch.setattr(solving, "solve_in_process", solve)


def test_the_engine_is_given_the_photos_by_name_and_what_it_finds_is_kept(
    resources: Resources, capture: StoredCapture, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[CapturedPhoto] = []
    bounds: list[Bounds] = []

    def solve(photos: Sequence[CapturedPhoto], within: Bounds, report: Report) -> Structure:
        given.extend(photos)
        bounds.append(within)
        report("solve", 0.5)
        return small_structure([photo.name for photo in photos], [])

    use(monkeypatch, solve)
    after = carry_out(resources, capture)
    assert [photo.name for photo in given] == [f"{seed}.png" for seed in range(5)]
    assert np.array_equal(given[3].picture, decode_photo(drawn.encoded(seed=3), "photo"))
    assert after.status == "solved"
    assert bounds == [Bounds(60, 3 * 2**30)]
    structure = captures.structure_of(resources.blobs, after)
    assert structure is not None
    assert [photo.name for photo in structure.photos] == [photo.name for photo in given]


def test_photos_that_do_not_go_together_are_named(
    resources: Resources, capture: StoredCapture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> Structure:
        raise CaptureError("photos: 0.png and 3.png show another tree; leave them out", code="two_trees")

    use(monkeypatch, refuse)
    after = carry_out(resources, capture)
    assert after.status == "failed"
    assert after.solve is not None
    assert after.solve.error == {
        "code": "input_unusable",
        "detail": "photos: 0.png and 3.png show another tree; leave them out",
        "retryable": False,
    }
    assert captures.solve(resources, capture.id).status == "queued"  # on request it is tried again


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (MemoryError(), "out_of_memory"),
        (RuntimeError("colmap"), "engine_error"),
        (SolveEnded("memory"), "out_of_memory"),
        (SolveEnded("slow"), "time_limit"),
    ],
)
def test_an_engine_that_breaks_fails_the_solve(
    resources: Resources, capture: StoredCapture, monkeypatch: pytest.MonkeyPatch, error: Exception, code: str
) -> None:
    def break_(*_: object) -> Structure:
        raise error

    use(monkeypatch, break_)
    after = carry_out(resources, capture)
    assert after.solve is not None
    assert (after.status, after.solve.error and after.solve.error["code"]) == ("failed", code)


def test_a_solve_whose_process_crashes_is_tried_again_and_fails_in_the_end(
    resources: Resources, capture: StoredCapture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def crash(*_: object) -> Structure:
        raise SolveEnded("crash")

    use(monkeypatch, crash)
    for attempt in range(1, MAX_ATTEMPTS):
        after = carry_out(resources, capture)
        assert after.solve is not None
        assert (after.status, after.solve.attempt) == ("queued", attempt)
    after = carry_out(resources, capture)
    assert after.solve is not None
    assert (after.status, after.solve.error and after.solve.error["code"]) == ("failed", "worker_lost")


def test_a_solve_that_crashes_after_it_was_canceled_is_not_tried_again(
    resources: Resources, capture: StoredCapture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def crash(*_: object) -> Structure:
        captures.cancel(resources.database, capture.id)
        raise SolveEnded("crash")

    use(monkeypatch, crash)
    assert carry_out(resources, capture).status == "unsolved"


def test_a_solve_that_takes_too_long_fails(
    resources: Resources, capture: StoredCapture, monkeypatch: pytest.MonkeyPatch
) -> None:
    use(monkeypatch, lambda photos, bounds, report: small_structure())
    after = carry_out(resources, capture, seconds=0)
    assert after.solve is not None
    assert (after.status, after.solve.error and after.solve.error["code"]) == ("failed", "time_limit")


def test_a_solve_stops_when_it_is_canceled_and_is_not_published(
    resources: Resources, capture: StoredCapture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def solve(*_: object) -> Structure:
        captures.cancel(resources.database, capture.id)
        return small_structure()

    use(monkeypatch, solve)
    after = carry_out(resources, capture)
    assert after.solve is not None
    assert (after.status, after.solve.status, after.solve.structure) == ("unsolved", "canceled", None)


def test_a_damaged_photo_is_not_the_engine_s_fault(
    resources: Resources, capture: StoredCapture, monkeypatch: pytest.MonkeyPatch
) -> None:
    use(monkeypatch, lambda photos, bounds, report: small_structure())
    resources.blobs.path(capture.photos[2].blob).write_bytes(b"damaged")
    after = carry_out(resources, capture)
    assert after.solve is not None
    assert after.solve.error is not None
    assert after.solve.error["code"] == "input_damaged"
