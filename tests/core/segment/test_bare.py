"""A drawn bare tree before a sky that grows lighter downward: the share of each pixel that its wood covers is found."""

import cv2
import numpy as np
from tests.pictures import wood_mask

from treestroke.core.segment.bare import wood_in_crown, wood_matte
from treestroke.core.segment.foliage import segment_foliage

TRUNK = np.array([(200.0, 390.0), (200.0, 300.0), (200.0, 240.0)])
LIMBS = [
    ([(200.0, 390.0), (200.0, 200.0)], 16.0),
    ([(200.0, 240.0), (110.0, 80.0)], 8.0),
    ([(200.0, 240.0), (290.0, 80.0)], 6.0),
    ([(155.0, 160.0), (80.0, 150.0)], 2.0),
    ([(245.0, 160.0), (250.0, 70.0)], 1.0),
]
CROWN = np.array([(60.0, 50.0), (340.0, 50.0), (340.0, 280.0), (60.0, 280.0)])
WOOD = (70, 55, 45)


def inside() -> np.ndarray:
    mask = np.zeros((400, 400), dtype=bool)
    mask[50:280, 60:340] = True
    return mask


def share() -> np.ndarray:
    fine = wood_mask([([(x * 4, y * 4) for x, y in line], width * 4) for line, width in LIMBS], 1600, 1600)
    return np.asarray(cv2.resize(fine.astype(np.float32), (400, 400), interpolation=cv2.INTER_AREA))


def photo(background: np.ndarray) -> np.ndarray:
    """Lay the tree over a background (400, 400, 3) with a camera's noise."""
    noise = np.random.default_rng(0).normal(0, 3, (400, 400, 3))
    cover = share()[..., None]
    return np.clip(cover * np.array(WOOD) + (1 - cover) * background + noise, 0, 255).astype(np.uint8)


def sky() -> np.ndarray:
    down = np.linspace(0, 1, 400)[:, None, None]
    return np.broadcast_to((1 - down) * np.array([90, 140, 210]) + down * np.array([190, 220, 245]), (400, 400, 3))


def test_the_matte_is_the_share_of_wood_in_the_crown_and_nothing_around_it() -> None:
    found = wood_matte(photo(sky()), inside(), TRUNK)
    assert np.abs(found - share())[inside()].mean() < 0.02
    assert not found[~inside()].any()


def test_a_wall_beside_and_behind_the_crown_is_no_wood() -> None:
    wall = np.array(sky())
    wall[100:, :] = (200, 185, 155)
    wall[130:180, 20::70] = wall[130:180, 21::70] = (80, 92, 102)
    found = wood_matte(photo(wall), inside(), TRUNK)
    one, other = (found > 0.5)[inside()], (share() > 0.5)[inside()]
    assert (one & other).sum() / (one | other).sum() > 0.85


def test_a_stroke_that_crosses_background_does_not_make_it_wood() -> None:
    beside = TRUNK + np.array([5.0, 0.0])
    found = wood_matte(photo(sky()), inside(), beside)
    assert np.abs(found - share())[inside()].mean() < 0.03


def test_before_a_background_of_its_colours_wood_is_not_told_apart() -> None:
    hillside = np.array(sky())
    hillside[45:285, 55:345] = WOOD
    picture = photo(hillside)
    foliage = segment_foliage(picture, CROWN)
    assert wood_in_crown(foliage, picture, TRUNK) is None


def test_of_a_bare_tree_s_foliage_only_what_covers_is_replaced() -> None:
    picture = photo(sky())
    foliage = segment_foliage(picture, CROWN)
    wood = wood_in_crown(foliage, picture, TRUNK)
    assert wood is not None
    assert np.array_equal(wood.mask, wood.alpha > 0.5)
    assert wood.region is foliage.region
    assert wood.cues is foliage.cues


def test_wood_that_is_not_found_along_the_trunk_is_none() -> None:
    picture = photo(sky())
    foliage = segment_foliage(picture, CROWN)
    aside = TRUNK - np.array([0.0, 60.0]) + np.array([20.0, 0.0])
    assert wood_in_crown(foliage, picture, TRUNK - np.array([0.0, 60.0])) is not None
    assert wood_in_crown(foliage, picture, aside) is None


def test_a_stroke_may_go_on_between_limbs_above_the_trunk() -> None:
    picture = photo(sky())
    beyond = np.vstack([TRUNK, [(200.0, 60.0)]])
    wood = wood_in_crown(segment_foliage(picture, CROWN), picture, beyond)
    assert wood is not None
    assert np.abs(wood.alpha - share())[inside()].mean() < 0.03
