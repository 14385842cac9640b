from pathlib import Path

import numpy as np
import pytest
from tests.conftest import DATA, EXAMPLES

from treestroke.core.trace.hidden_foot import hidden_ground
from treestroke.service.loading import load_photo, load_strokes

SKY, LAWN, BARK, HEDGE = (150, 180, 220), (120, 150, 80), (90, 70, 50), (40, 70, 35)
FOOT, HEIGHT = 500.0, 400.0


def scene(top: int | None, left: int = 0, right: int = 600, bottom: int = 508) -> np.ndarray:
    """Return a photo of a trunk on a lawn, with a hedge from its top row on, or without one."""
    photo = np.empty((600, 600, 3))
    photo[:], photo[430:], photo[200:500, 290:310] = SKY, LAWN, BARK
    if top is not None:
        photo[top:bottom, left:right] = HEDGE
    noise = np.random.default_rng(0).normal(0, 8, photo.shape)
    return np.clip(photo + noise, 0, 255).astype(np.uint8)


@pytest.mark.parametrize(("left", "right"), [(0, 600), (230, 390)], ids=["hedge", "car"])
def test_the_ground_behind_what_hides_the_foot_is_near_its_lower_edge(left: int, right: int) -> None:
    ground = hidden_ground(scene(455, left, right), np.array([300.0, 454.0]), HEIGHT)
    assert ground == pytest.approx(FOOT, abs=0.02 * HEIGHT)


def test_a_foot_on_a_lawn_is_not_hidden() -> None:
    assert hidden_ground(scene(None), np.array([300.0, FOOT]), HEIGHT) is None


def test_a_stroke_that_goes_on_to_the_ground_before_a_hedge_stays() -> None:
    assert hidden_ground(scene(455), np.array([300.0, FOOT]), HEIGHT) is None


def test_a_strip_of_grass_to_the_photo_s_bottom_hides_nothing() -> None:
    assert hidden_ground(scene(455, bottom=600), np.array([300.0, 454.0]), HEIGHT) is None


def test_a_photo_that_ends_at_the_foot_shows_no_ground_below() -> None:
    assert hidden_ground(scene(None)[:502], np.array([300.0, FOOT]), HEIGHT) is None


@pytest.mark.parametrize("photo", sorted([*DATA.glob("*.jpg"), *EXAMPLES.glob("*.jpg")]), ids=lambda path: path.stem)
def test_no_foot_of_a_real_tree_that_can_be_seen_is_taken_for_hidden(photo: Path) -> None:
    pixels = load_photo(photo)
    for drawn in photo.parent.glob(f"{photo.stem}.*strokes.json"):
        strokes = load_strokes(drawn)
        root = strokes.branches[0].points[0]
        assert hidden_ground(pixels, root, root[1] - strokes.crown.points[:, 1].min()) is None
