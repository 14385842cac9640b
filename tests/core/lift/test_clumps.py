import cv2
import numpy as np
import pytest

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.clumped_crown import ClumpedCrown
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import turned_outline
from treestroke.core.lift.clumps import in_clumps
from treestroke.core.lift.imagined import imagined_crown

CAMERA = OrthographicCamera(400, 480, 0.02, (200.0, 460.0))


def round_front() -> np.ndarray:
    mask = np.zeros((480, 400), np.uint8)
    cv2.ellipse(mask, (200, 200), (150, 160), 0, 0, 360, 1, -1)
    return mask > 0


def broken_front() -> np.ndarray:
    """Clumps of 40 to 60 px all over a crown: bays between them, and more of them on the right."""
    mask = np.zeros((480, 400), np.uint8)
    rng = np.random.default_rng(3)
    for number in range(34):
        angle, away = 2.4 * number, np.sqrt((number + 0.5) / 34)
        place = round(200 + (120 + 30 * np.cos(angle)) * away * np.cos(angle)), round(210 + 150 * away * np.sin(angle))
        cv2.line(mask, (200, 210), place, 1, 8)
        cv2.circle(mask, place, int(rng.uniform(18, 28)), 1, -1)
    return mask > 0


def crown_of(mask: np.ndarray, seed: int = 0) -> ClumpedCrown:
    front, rng = Silhouette(mask, CAMERA), np.random.default_rng(seed)
    return in_clumps(imagined_crown(turned_outline(front), front, rng), np.zeros((0, 3)), rng)


def seen_from(crown: ClumpedCrown, azimuth: float) -> np.ndarray:
    """Draw the crown's cells from a side, a cell a pixel; the stem is in the middle."""
    cells = crown.clumps
    points = np.argwhere(cells.filled) + 0.5
    x = points[:, 0] - (CAMERA.root_px[0] - cells.corner[0]) / cells.side
    z = points[:, 2] + cells.corner[2] / cells.side
    picture = np.zeros((cells.filled.shape[1] + 4, 260), np.uint8)
    across = np.cos(azimuth) * x - np.sin(azimuth) * z
    for way in (-0.3, 0.3):
        picture[points[:, 1].astype(int) + 2, np.floor(across + way + 130).astype(int)] = 1
    return picture


def outline(picture: np.ndarray) -> float:
    """Return the outline's length over the root of the area."""
    contours = cv2.findContours(picture, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)[0]
    return sum(cv2.arcLength(c, True) for c in contours) / np.sqrt(picture.sum())


def lopsided(picture: np.ndarray) -> float:
    rows = picture[picture.any(axis=1)] > 0
    left, right = 130 - rows.argmax(axis=1), 130 - rows[:, ::-1].argmax(axis=1)
    return float((np.abs(left - right) / np.maximum(np.abs(left) + np.abs(right), 1)).mean())


SIDES = np.radians([45, 90, 135])


@pytest.mark.parametrize("front", [round_front, broken_front])
def test_the_front_stays_as_it_is(front) -> None:
    crown = crown_of(front())
    y, x = np.nonzero(front())
    pixels = np.stack([x, y], axis=1) + 0.5
    depths = np.arange(-200, 200, 2) * 0.02
    shown = np.zeros(len(pixels), dtype=bool)
    for depth in depths:
        shown |= crown.admits(CAMERA.world_from_pixels(pixels, depth))
    assert shown.mean() > 0.97
    beside = np.stack([np.tile(np.arange(400), 2), np.repeat([20, 470], 400)], axis=1) + 0.5
    assert not any(crown.inside(CAMERA.world_from_pixels(beside, depth)).any() for depth in depths)


def test_a_broken_crown_is_broken_from_all_sides_and_a_smooth_one_smooth() -> None:
    for front, least, most in ((broken_front, 0.75, 1.25), (round_front, 0.85, 1.25)):
        crowns = [crown_of(front(), seed) for seed in range(4)]
        sides = [outline(seen_from(crown, side)) for crown in crowns for side in SIDES]
        assert least < np.mean(sides) / outline(seen_from(crowns[0], 0.0)) < most


def test_a_lopsided_crown_is_lopsided_from_other_sides_too() -> None:
    sides = [lopsided(seen_from(crown_of(broken_front(), seed), side)) for seed in range(4) for side in SIDES]
    assert np.mean(sides) > 0.6 * lopsided(seen_from(crown_of(broken_front()), 0.0))


def test_no_side_repeats_another() -> None:
    crown = crown_of(broken_front())
    views = [seen_from(crown, side) for side in np.radians([0, 45, 90, 135])]
    for i, one in enumerate(views):
        for other in views[i + 1 :]:
            for like in (other, other[:, ::-1]):
                assert (one & like).sum() / (one | like).sum() < 0.9


def test_front_and_back_bear_alike() -> None:
    for mask in (round_front(), broken_front()):
        cells = crown_of(mask).clumps
        z = (np.arange(cells.filled.shape[2]) + 0.5) * cells.side + cells.corner[2]
        mass = cells.filled.sum(axis=(0, 1))
        assert 0.6 < mass[z > 0].sum() / mass[z < 0].sum() < 1.6


def test_another_seed_gives_other_sides_and_the_same_seed_the_same() -> None:
    one, same, other = (crown_of(broken_front(), seed).clumps.filled for seed in (0, 0, 1))
    assert np.array_equal(one, same)
    assert one.shape != other.shape or not np.array_equal(one, other)


@pytest.mark.parametrize("size", [(1, 1), (3, 40), (60, 2), (5, 5)])
def test_the_smallest_crowns_have_a_volume(size: tuple[int, int]) -> None:
    mask = np.zeros((480, 400), dtype=bool)
    mask[100 : 100 + size[1], 200 : 200 + size[0]] = True
    crown = crown_of(mask)
    centre = CAMERA.world_from_pixels(np.argwhere(mask)[:, ::-1] + 0.5)
    deep = [crown.admits(centre + np.array([0, 0, z])) for z in np.linspace(-1, 1, 101)]
    assert np.any(deep, axis=0).mean() > 0.9
