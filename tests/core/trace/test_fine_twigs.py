"""A drawn limb of a bare crown in a patch of wood: twigs fill the patch, thin and outward."""

import cv2
import numpy as np
import pytest
from tests.pictures import wood_mask

from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.trace import fine_twigs
from treestroke.core.trace.fine_twigs import fine_twigs as with_fine_twigs

LIMB = Skeleton(np.column_stack([np.full(60, 150.0), 290.0 - 4.0 * np.arange(60)]), np.full(60, 3.0), np.arange(60) - 1)
CLUMP = wood_mask([([(150.0, 290.0), (150.0, 54.0)], 6.0), ([(150.0, 150.0), (190.0, 90.0)], 50.0)], 300, 300)


def covered(tree: Skeleton) -> np.ndarray:
    """Mask (300, 300) of what a skeleton covers."""
    drawn = np.zeros((300, 300), dtype=np.uint8)
    for joint, parent in enumerate(tree.parents.tolist()):
        if parent >= 0:
            ends = [tuple(np.round(tree.points[at]).astype(int).tolist()) for at in (parent, joint)]
            cv2.line(drawn, ends[0], ends[1], 1, max(1, round(2 * tree.radii[joint])))
    return drawn > 0


def test_twigs_cover_what_was_not_traced_and_little_else() -> None:
    tree = with_fine_twigs(CLUMP.astype(np.float32), LIMB)
    left_before, left = (CLUMP & ~covered(one) for one in (LIMB, tree))
    assert left.sum() < 0.5 * left_before.sum()
    assert (covered(tree) & ~CLUMP).sum() < 0.1 * covered(tree).sum()


def test_what_was_traced_stays_and_twigs_are_thin_and_lead_on_from_it() -> None:
    tree = with_fine_twigs(CLUMP.astype(np.float32), LIMB)
    assert np.array_equal(tree.points[:60], LIMB.points)
    assert np.array_equal(tree.parents[:60], LIMB.parents)
    twigs = np.arange(60, len(tree))
    assert (tree.parents[twigs] < twigs).all()
    assert (tree.radii[twigs] <= tree.radii[tree.parents[twigs]]).all()
    first, last = twigs[::2], twigs[1::2]
    length = np.hypot(*(tree.points[last] - tree.points[tree.parents[first]]).T)
    assert (tree.radii[first] <= fine_twigs.SLENDER * length + 1e-9).all()


def test_twigs_point_away_from_the_root() -> None:
    tree = with_fine_twigs(CLUMP.astype(np.float32), LIMB)
    first = np.arange(60, len(tree), 2)
    from_limb = first[tree.parents[first] < 60]
    assert len(from_limb)
    assert (tree.points[from_limb + 1, 1] < tree.points[tree.parents[from_limb], 1]).all()


@pytest.mark.parametrize("wood", [covered(LIMB), np.zeros((300, 300), dtype=bool)], ids=["traced", "none"])
def test_none_grow_where_all_is_traced_or_nothing_is_seen(wood: np.ndarray) -> None:
    assert len(with_fine_twigs(wood.astype(np.float32), LIMB)) == len(LIMB)


def test_where_there_are_too_many_those_stay_that_show_most(monkeypatch: pytest.MonkeyPatch) -> None:
    every = with_fine_twigs(CLUMP.astype(np.float32), LIMB)
    monkeypatch.setattr(fine_twigs, "MOST", 6)
    few = with_fine_twigs(CLUMP.astype(np.float32), LIMB)
    assert len(few) == len(LIMB) + 12 < len(every)
    assert few.radii[60:].mean() > every.radii[60:].mean()


def test_where_wood_covers_little_of_each_pixel_twigs_are_finer() -> None:
    strip = wood_mask([([(152.0, 150.0), (190.0, 90.0)], 4.0)], 300, 300)
    solid, faint, veil = (
        with_fine_twigs(np.where(strip, share, 0).astype(np.float32), LIMB).radii[60:].max() for share in (1, 0.35, 0.2)
    )
    assert veil < 0.8 * faint < 0.8 * 0.8 * solid


def test_a_veil_that_hardly_covers_a_pixel_is_no_twig() -> None:
    assert len(with_fine_twigs(np.where(CLUMP, 0.1, 0).astype(np.float32), LIMB)) == len(LIMB)
