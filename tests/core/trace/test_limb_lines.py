"""Lines in drawn texture: dark ones stand out where texture makes none like them."""

import cv2
import numpy as np
import pytest
from tests.pictures import wood_mask

from treestroke.core.trace.limb_lines import find_lines, pieces
from treestroke.core.trace.ribbons import Ribbons

SIZE, HEIGHT = 400, 380.0
EVERYWHERE = np.ones((SIZE, SIZE), dtype=bool)
LIMB = [(90.0, 330.0), (170.0, 200.0), (190.0, 60.0)]


def texture(seed: int) -> np.ndarray:
    """Light and shade of leaves, about 100, with a deviation of 40."""
    noise = cv2.GaussianBlur(np.random.default_rng(seed).normal(size=(SIZE, SIZE)), (0, 0), 1.5)
    return np.asarray(110 + 40 * noise / noise.std())


def found(*changes: tuple[np.ndarray, float], likely: np.ndarray = EVERYWHERE) -> Ribbons:
    """Look for pieces in two layers of texture, in both of which what lies in a mask is changed by so much."""
    layers = []
    for seed in (1, 2):
        picture = texture(seed)
        for mask, change in changes:
            picture[mask] += change
        layers.append(find_lines(np.clip(picture, 0, 255).astype(np.uint8), EVERYWHERE, HEIGHT))
    return pieces((layers[0], layers[1]), likely, (SIZE, SIZE), HEIGHT)


def near(ribbons: Ribbons, mask: np.ndarray, within: float = 3.0) -> np.ndarray:
    """Which pixels of the ribbons are near a mask."""
    return np.asarray(
        cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, 5)[tuple(ribbons.pixels.T)] <= within
    )


@pytest.mark.parametrize("thickness", [3.0, 5.0, 7.0])
def test_a_dark_line_no_darker_than_much_of_the_texture_is_found(thickness: float) -> None:
    limb = wood_mask([(LIMB, thickness)], SIZE, SIZE)
    ribbons = found((limb, -70.0))
    assert near(ribbons, limb).mean() > 0.9
    assert len(ribbons.pixels) > 0.6 * 270


def test_a_thicker_line_has_a_greater_half_width() -> None:
    thin, thick = (found((wood_mask([(LIMB, width)], SIZE, SIZE), -70.0)) for width in (3.0, 8.0))
    assert np.median(thin.half_widths) < np.median(thick.half_widths)


@pytest.mark.parametrize("change", [0.0, 70.0], ids=["texture", "light line"])
def test_neither_texture_nor_a_light_line_is_a_limb(change: float) -> None:
    assert len(found((wood_mask([(LIMB, 4.0)], SIZE, SIZE), change)).pixels) < 0.1 * 270


def test_a_short_line_is_none() -> None:
    limb = wood_mask([([(100.0, 200.0), (112.0, 206.0)], 4.0)], SIZE, SIZE)
    assert not near(found((limb, -70.0)), limb).any()


def test_an_edge_is_no_line() -> None:
    side = np.zeros((SIZE, SIZE), dtype=bool)
    side[:, 200:] = True
    assert len(found((side, -70.0)).pixels) < 0.1 * SIZE


def test_no_line_is_taken_where_none_is_likely() -> None:
    limb = wood_mask([(LIMB, 4.0)], SIZE, SIZE)
    assert not near(found((limb, -70.0), likely=~EVERYWHERE), limb).any()
