import numpy as np
import pytest

from treestroke.core.geometry.polyline import resample
from treestroke.core.trace.stroke_radii import CHILD_RADIUS, drawn_radii, limb_radii, stem_radii

LINE = resample(np.array([[0.0, 200.0], [0.0, 0.0]]), 4.0)
SHARE = np.linspace(0.0, 1.0, len(LINE))
UNSEEN = np.full(len(LINE), np.nan)


def test_a_limb_that_is_nowhere_seen_is_half_as_thick_as_its_parent_and_tapers() -> None:
    radii = limb_radii(LINE, UNSEEN, 20.0)
    assert radii[0] == CHILD_RADIUS * 20.0
    assert (np.diff(radii) < 0).all()


def test_a_limb_is_as_thick_as_it_is_seen() -> None:
    even = 8.0 * (1 - 0.6 * SHARE)
    assert limb_radii(LINE, even, 20.0) == pytest.approx(even)


def test_another_limb_beside_it_or_leaves_before_it_hardly_change_a_limb() -> None:
    even = 8.0 * (1 - 0.6 * SHARE)
    seen = even.copy()
    seen[5:10], seen[30:36] = 18.0, 1.0
    assert limb_radii(LINE, seen, 20.0) == pytest.approx(even, rel=0.25)


def test_a_limb_tapers_on_where_it_is_hidden() -> None:
    seen = np.where((SHARE > 0.3) & (SHARE < 0.6), 8.0, np.nan)
    radii = limb_radii(LINE, seen, 20.0)
    assert radii[0] > 8.0
    assert radii[-1] < 5.0


def test_no_limb_is_thicker_than_its_parent() -> None:
    assert limb_radii(LINE, np.full(len(LINE), 9.0), 5.0).max() == 5.0


def test_a_stem_is_as_thick_as_it_is_seen_below_the_crown() -> None:
    seen = np.where(SHARE < 0.4, 10.0, np.where(SHARE > 0.7, 1.0, np.nan))
    radii = stem_radii(LINE, seen, SHARE < 0.4, 200.0, 3.0)
    assert radii[SHARE < 0.3] == pytest.approx(10.0, rel=0.05)
    assert radii.min() >= 0.5 * 10.0 * 0.3 - 1e-9


def test_limbs_that_leave_a_stem_in_the_crown_do_not_widen_it() -> None:
    seen = 10.0 * (1 - SHARE)
    forked = np.where((SHARE > 0.45) & (SHARE < 0.7), 14.0, seen)
    radii = stem_radii(LINE, forked, SHARE < 0.4, 200.0, 3.0)
    assert radii[SHARE < 0.9] == pytest.approx(np.maximum(seen, 5.0 * (1 - 0.7 * SHARE))[SHARE < 0.9], rel=0.2)


def test_a_stem_that_is_nowhere_seen_has_the_usual_thickness() -> None:
    assert stem_radii(LINE, UNSEEN, SHARE < 0.4, 200.0, 3.0)[0] == 3.0


def test_a_brush_s_width_is_the_base_s_diameter() -> None:
    assert drawn_radii(LINE, 12.0)[0] == 6.0
