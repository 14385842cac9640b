"""Summary numbers of the examples, so that a change of shape is seen; a wanted change updates them here."""

from functools import cache
from typing import Any

import pytest
from tests.conftest import EXAMPLES

import treestroke

pytestmark = pytest.mark.golden

# branches, leaves, attractors_reached, depth_over_width
NUMBERS = {
    "burr_oak_dusk": (618, 23585, 0.975, 0.886),
    "sugar_maple_autumn": (849, 23552, 0.942, 1.015),
    "osage_orange_autumn": (852, 25781, 0.969, 0.999),
    "oak_02": (810, 24086, 0.927, 0.863),
}
LEAST_SILHOUETTE_IOU = 0.83
"""Its target is the matte, with each gap between leaves."""


@cache
def report(name: str) -> dict[str, Any]:
    model = treestroke.model(EXAMPLES / f"{name}.jpg", EXAMPLES / f"{name}.strokes.json", {"iterations": 300})
    return model.report


@pytest.mark.parametrize("name", NUMBERS)
def test_counts_are_as_they_were(name: str) -> None:
    branches, leaves, _, _ = NUMBERS[name]
    counts = report(name)["counts"]
    assert (counts["branches"], counts["leaves"]) == pytest.approx((branches, leaves), rel=0.25)
    assert counts["triangles"] < 200_000


@pytest.mark.parametrize("name", NUMBERS)
def test_the_crown_is_reached_and_as_deep_as_it_was(name: str) -> None:
    _, _, reached, depth = NUMBERS[name]
    score = report(name)["score"]
    assert score["attractors_reached"] == pytest.approx(reached, abs=0.05)
    assert score["depth_over_width"] == pytest.approx(depth, abs=0.15)


@pytest.mark.parametrize("name", NUMBERS)
def test_the_front_view_shows_the_photo_s_silhouette(name: str) -> None:
    assert report(name)["score"]["silhouette_iou"] > LEAST_SILHOUETTE_IOU
