"""Drawn wood and drawn shade: a ribbon is long, narrow and clear of other wood."""

import cv2
import numpy as np
import pytest
from tests.pictures import disc, wood_mask

from treestroke.core.trace.ribbons import Ribbons, find_ribbons, headings

SIZE, HEIGHT = 300, 280.0
CROWN = np.ones((SIZE, SIZE), dtype=bool)
LIMB = [(40.0, 250.0), (250.0, 60.0)]


def found_in(wood: np.ndarray, crown: np.ndarray = CROWN) -> Ribbons:
    odds = np.where(wood, 3.0, -3.0).astype(np.float32)
    return find_ribbons(odds, np.asarray(cv2.GaussianBlur(odds, (0, 0), 0.7)), crown, HEIGHT)[0]


def shade(share: float, seed: int = 0) -> np.ndarray:
    """Shade between small leaves that covers a share of the picture."""
    noise = cv2.GaussianBlur(np.random.default_rng(seed).normal(size=(SIZE, SIZE)), (0, 0), 0.7)
    return noise > np.quantile(noise, 1 - share)


@pytest.mark.parametrize("thickness", [2.0, 5.0, 11.0])
def test_a_limb_s_centre_line_and_half_width_are_found(thickness: float) -> None:
    ribbons = found_in(wood_mask([(LIMB, thickness)], SIZE, SIZE))
    (x0, y0), (x1, y1) = LIMB
    away = np.abs((ribbons.points - (x0, y0)) @ np.array([y1 - y0, x0 - x1])) / np.hypot(x1 - x0, y1 - y0)
    assert len(ribbons.pixels) > 0.75 * max(x1 - x0, y0 - y1)
    assert np.median(away) < 1.5
    assert np.median(ribbons.half_widths) == pytest.approx(thickness / 2, abs=1.0)


def test_shade_among_leaves_is_no_ribbon_but_a_limb_among_it_is() -> None:
    among = shade(0.4)
    limb = wood_mask([(LIMB, 6.0)], SIZE, SIZE)
    beside = cv2.dilate(limb.astype(np.uint8), np.ones((25, 25), np.uint8)) > 0
    ribbons = found_in(np.where(beside, limb, among))
    on_limb = beside[tuple(ribbons.pixels.T)]
    assert len(found_in(among).pixels) < 0.02 * among.sum() / 2
    assert on_limb.sum() > 120
    assert on_limb.mean() > 0.5


@pytest.mark.parametrize("wood", [disc(SIZE, 40), disc(SIZE, 3), ~CROWN, CROWN], ids=["blob", "speck", "none", "all"])
def test_what_is_not_long_and_narrow_is_no_ribbon(wood: np.ndarray) -> None:
    assert len(found_in(wood).pixels) == 0


def test_wood_outside_the_crown_is_not_looked_at() -> None:
    above = np.zeros_like(CROWN)
    above[:150] = True
    ribbons = found_in(wood_mask([(LIMB, 5.0)], SIZE, SIZE), above)
    assert len(ribbons.pixels) > 50
    assert ribbons.pixels[:, 0].max() < 150


@pytest.mark.parametrize("slope", [0.0, 0.5, 1.0, -2.0])
def test_headings_follow_the_line(slope: float) -> None:
    x = np.arange(60) if abs(slope) <= 1 else np.arange(30)
    lines = np.unique(np.column_stack([np.round(100 + slope * x), 50 + x]).astype(int), axis=0)
    along = np.array([1.0, slope]) / np.hypot(1.0, slope)
    heading = headings(Ribbons(lines, np.ones(len(lines))), 8)
    assert np.abs(heading @ along).min() > 0.97


@pytest.mark.parametrize(("wood", "are_shown"), [(wood_mask([(LIMB, 5.0)], SIZE, SIZE), True), (shade(0.4), False)])
def test_whether_colours_show_limbs_is_told(wood: np.ndarray, are_shown: bool) -> None:
    odds = np.where(wood, 3.0, -3.0).astype(np.float32)
    assert find_ribbons(odds, np.asarray(cv2.GaussianBlur(odds, (0, 0), 0.7)), CROWN, HEIGHT)[1] is are_shown
