"""A crown whose lower half is in the shade, over a lawn as dark, before a bright sky."""

import numpy as np

from treestroke.core.segment.shaded_leaves import log_odds_by_roughness, roughness

INSIDE = np.zeros((300, 300), dtype=bool)
INSIDE[40:200, 60:240] = True
UPPER, LOWER = slice(40, 110), slice(110, 200)


def photo(lawn_like_leaves: bool = False) -> np.ndarray:
    """Leaves in two lights, the sky above and a lawn below as dark as the lower half's darker leaves."""
    rng = np.random.default_rng(3)
    picture = np.full((300, 300), 220.0)
    picture[150:] = 22.0
    picture[UPPER, 60:240] = rng.choice([90.0, 150.0], (70, 180))
    picture[LOWER, 60:240] = rng.uniform(10.0, 60.0, (90, 180))
    if lawn_like_leaves:
        picture[150:, :60] = rng.uniform(10.0, 60.0, (150, 60))
        picture[200:] = rng.uniform(10.0, 60.0, (100, 300))
        picture[150:, 240:] = rng.uniform(10.0, 60.0, (150, 60))
    picture += rng.normal(0, 1.0, picture.shape)
    return np.repeat(np.clip(picture, 0, 255).astype(np.uint8)[..., None], 3, axis=2)


def odds(picture: np.ndarray) -> np.ndarray:
    """By leaves that colour found so far: the upper half and some of the lower one."""
    leaves = INSIDE.copy()
    leaves[170:] = False
    return log_odds_by_roughness(roughness(picture, INSIDE), leaves, INSIDE)


def test_shaded_leaves_are_told_from_a_lawn_as_dark() -> None:
    picture = photo()
    found, dark = odds(picture), picture[..., 0] < 22
    assert np.median(found[150:190, 70:230][dark[150:190, 70:230]]) >= 0.0
    assert found[150:190, 70:230].max() > 1.0
    assert np.median(found[210:290]) < -1.0


def test_bright_pixels_are_left_to_colour() -> None:
    picture = photo()
    assert not odds(picture)[picture[..., 0] > 120].any()


def test_where_all_around_is_as_rough_as_leaves_nothing_is_told() -> None:
    assert np.abs(odds(photo(lawn_like_leaves=True))[220:290]).max() < 1.0


def test_a_crown_without_dark_ground_beside_it_is_left_to_colour() -> None:
    picture = photo()
    picture[150:][~INSIDE[150:]] = 220
    assert not odds(picture).any()
