import cv2
import numpy as np

from treestroke.core.segment.view_mattes_twigs import with_twigs
from treestroke.core.types import Opacity, Picture

SKY, WOOD, FOREST = 225, 60, 70


def scene(background: int = SKY) -> tuple[Picture, Opacity]:
    """A trunk with a thin twig before the sky, a twig apart and a forest; and a matte of the trunk."""
    picture = np.full((200, 200), background, dtype=np.uint8)
    picture[140:, :70] = FOREST
    cv2.line(picture, (100, 60), (150, 20), WOOD, 1)
    cv2.line(picture, (20, 20), (60, 50), WOOD, 1)
    cv2.line(picture, (100, 150), (50, 145), WOOD, 2)
    picture[30:, 96:104] = WOOD
    opacity = np.zeros((200, 200), dtype=np.float32)
    opacity[30:, 96:104] = 1
    return np.repeat(picture[..., None], 3, axis=2), opacity


def test_a_thin_twig_before_the_sky_is_the_trees() -> None:
    tree = with_twigs(*scene()) >= 0.5
    assert tree[20:24, 145:151].any()
    assert tree[60, 100]


def test_what_does_not_hang_on_the_tree_or_stands_before_a_forest_is_not() -> None:
    tree = with_twigs(*scene()) >= 0.5
    assert not tree[15:55, 15:65].any()
    assert not tree[150:, :70].any()


def test_the_matte_stays_where_nothing_is_brighter_than_wood() -> None:
    picture, opacity = scene(background=WOOD + 10)
    assert with_twigs(picture, opacity).tolist() == opacity.tolist()


def test_no_tree_has_no_twigs() -> None:
    picture, opacity = scene()
    assert not with_twigs(picture, 0 * opacity).any()
