"""A crown in which limbs have the colours of shade."""

import cv2
import numpy as np
import pytest
from tests.pictures import disc, wood_mask

from treestroke.core.imaging.mixture import Mixture
from treestroke.core.trace.appearance import Surroundings
from treestroke.core.trace.crown_picture import FINEST_SIDE, CrownPicture, see_crown

SIZE, HEIGHT = 500, 420.0
COLOURS = Mixture(np.array([1.0]), np.array([[90.0, 140.0, 60.0]]), np.array([np.eye(3) * 100.0]))
CROWN = disc(SIZE, 200)
LIMB = [(240.0, 400.0), (300.0, 200.0)]


def seen(scale: int = 1, broad: bool = True) -> tuple[CrownPicture, np.ndarray]:
    """Draw shaded leaves before a light sky, a limb as dark as shade among them, and look at it."""
    noise = cv2.GaussianBlur(np.random.default_rng(3).normal(size=(SIZE, SIZE)), (0, 0), 1.5)
    grey = np.where(CROWN, 110 + 40 * noise / noise.std(), 235.0)
    grey[wood_mask([(LIMB, 5.0)], SIZE, SIZE)] -= 80.0
    photo = np.repeat(np.clip(grey, 0, 255).astype(np.uint8)[..., None], 3, axis=2)
    photo, crown = (cv2.resize(part, None, fx=scale, fy=scale) for part in (photo, CROWN.astype(np.uint8)))
    around = Surroundings(COLOURS, COLOURS, crown > 0, crown > 0, broad=broad)
    picture = see_crown(np.asarray(photo), around, HEIGHT * scale)
    return picture, np.zeros(picture.crown.shape, dtype=np.float32)


@pytest.mark.parametrize("scale", [1, 3])
def test_a_limb_among_leaves_is_found_where_it_is_whatever_the_photo_s_size(scale: int) -> None:
    picture, smooth = seen(scale)
    limb = wood_mask([(LIMB, 5.0)], SIZE, SIZE)
    found = picture.pieces(smooth)
    assert found is not None
    row, column = (picture.window.outside(found.points) / scale).astype(int).T[::-1]
    away = cv2.distanceTransform((~limb).astype(np.uint8), cv2.DIST_L2, 5)[row, column]
    assert max(picture.crown.shape) <= FINEST_SIDE
    assert (away <= 3).sum() * scale > 60
    assert (away <= 3).mean() > 0.7


def test_points_go_into_the_window_and_back() -> None:
    window = seen(3)[0].window
    points = np.array([[310.0, 500.0], [900.5, 1200.25]])
    assert window.outside(window.inside(points)) == pytest.approx(points)


def test_shade_between_needles_tells_nothing() -> None:
    picture, smooth = seen(broad=False)
    assert picture.pieces(smooth) is None


def test_the_tree_s_height_in_the_photo_is_known() -> None:
    assert seen(3)[0].tree_px == pytest.approx(3 * HEIGHT)
