import cv2
import numpy as np
import pytest
from tests.conftest import DATA

from treestroke.core.paint.leaf_scale import LONGEST, bounded_length, leaf_length_px
from treestroke.core.paint.species import AUTO, SPECIES

SPRAY_PX = 40.0
MEASURED = (
    ("beech_round", np.s_[180:380, 80:300], 376, 6.0),
    ("redbud_park", np.s_[120:260, 150:550], 696, 9.0),
)
"""Photos, a part of their crown, its breadth and a leaf's length, px."""


def leafy(length_px: float, seed: int = 0, side: int = 320) -> np.ndarray:
    """A picture (side, side, 3) full of ovals of one length and different lightness that hide each other."""
    rng = np.random.default_rng(seed)
    picture = np.full((side, side, 3), 40, np.uint8)
    for _ in range(round(8 * (side / length_px) ** 2)):
        x, y = rng.uniform(0, side, 2).round().astype(int).tolist()
        axes = (max(1, round(length_px / 2)), max(1, round(0.3 * length_px)))
        colour = (int(rng.integers(20, 235)),) * 3
        cv2.ellipse(picture, (x, y), axes, float(rng.uniform(0, 180)), 0, 360, colour, -1, cv2.LINE_AA)
    return picture


def everywhere(picture: np.ndarray) -> np.ndarray:
    return np.ones(picture.shape[:2], bool)


@pytest.mark.parametrize(("name", "crown", "breadth_px", "length_px"), MEASURED)
def test_leaves_of_a_photo_are_found_as_long_as_measured_by_hand(name, crown, breadth_px, length_px):
    picture = cv2.imread(str(DATA / f"{name}.jpg"))[crown][..., ::-1]
    found = leaf_length_px(picture, everywhere(picture), 0.0225 * breadth_px)
    assert found == pytest.approx(length_px, rel=0.35)


def test_what_is_found_grows_with_the_leaves():
    found = [leaf_length_px(leafy(length), np.ones((320, 320), bool), 2.5 * length) for length in (6.0, 12.0, 20.0)]
    assert found[1] == pytest.approx(2 * found[0], rel=0.25)
    assert found[2] == pytest.approx(20 / 12 * found[1], rel=0.25)


def test_light_that_changes_from_clump_to_clump_counts_for_little():
    picture = leafy(8.0)
    clumps = 1 + 0.4 * np.sin(np.arange(320) / 40)[:, None, None]
    lit = np.clip(picture * clumps, 0, 255).astype(np.uint8)
    plain = leaf_length_px(picture, everywhere(picture), SPRAY_PX)
    assert leaf_length_px(lit, everywhere(picture), SPRAY_PX) == pytest.approx(plain, rel=0.15)


def test_only_what_is_covered_is_measured():
    picture = np.hstack([leafy(6.0), leafy(18.0)])
    left = np.zeros(picture.shape[:2], np.float32)
    left[:, :310] = 1.0
    alone = leaf_length_px(picture[:, :310], left[:, :310], SPRAY_PX)
    assert leaf_length_px(picture, left, SPRAY_PX) == pytest.approx(alone, rel=0.05)


def test_nothing_is_told_from_too_few_pixels_or_from_one_colour():
    picture = leafy(8.0)
    few = np.zeros(picture.shape[:2], bool)
    few[:12, :12] = True
    assert leaf_length_px(picture, few, SPRAY_PX) is None
    assert leaf_length_px(np.full_like(picture, 90), everywhere(picture), SPRAY_PX) is None


@pytest.mark.parametrize("species", [AUTO, SPECIES["oak"], SPECIES["walnut"]])
def test_the_length_is_bounded_by_the_species(species):
    assert bounded_length(species.length, species) == species.length
    assert bounded_length(0.01, species) == pytest.approx(0.7 * species.length)
    assert species.length < bounded_length(5.0, species) + 1e-9 <= LONGEST + 1e-9
