import numpy as np
from tests.builders import fork

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import TurnedOutline, turned_outline
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.reaching import reaching
from treestroke.core.skeleton.traverse import child_counts
from treestroke.core.types import Floats, Mask

CAMERA = OrthographicCamera(500, 400, 0.01, (250.0, 390.0))


def reached(foliage: Mask) -> Grown:
    """Extend a fork, 3.6 m high, with its right limb ending at pixel (353, 68), to foliage (h, w)."""
    front = Silhouette(foliage, CAMERA)
    tree = Grown(fork(), np.array([0, 0, 0, 1, 1, 2, 2]), np.zeros((0, 3), np.int64))
    return reaching(tree, front, turned_outline(front))


def test_twigs_run_along_the_foliage_to_its_ends() -> None:
    foliage = np.zeros((400, 500), dtype=bool)
    foliage[50:100, 330:440] = True
    grown = reached(foliage)
    tree, before = grown.skeleton, fork()
    assert tree.points[:7].tolist() == before.points.tolist()
    assert tree.radii[:7].tolist() == before.radii.tolist()
    new = CAMERA.pixels_from_world(tree.points[7:])
    assert new[:, 0].max() > 430
    assert foliage[new[:, 1].astype(int), new[:, 0].astype(int)].all()
    assert (tree.parents < np.arange(len(tree))).all()
    assert (tree.radii[7:] <= tree.radii[tree.parents[7:]]).all()
    assert set(grown.born[7:].tolist()) == {3}


def test_a_twig_crosses_a_narrow_gap_and_no_wide_one() -> None:
    foliage = np.zeros((400, 500), dtype=bool)
    foliage[50:100, 340:370] = foliage[50:100, 395:410] = foliage[50:100, 470:490] = True
    ends = CAMERA.pixels_from_world(reached(foliage).skeleton.points)[:, 0]
    assert ends.max() > 395
    assert ends.max() < 470


def test_what_branches_reach_gets_no_twigs() -> None:
    foliage = np.zeros((400, 500), dtype=bool)
    foliage[60:76, 345:361] = True
    assert len(reached(foliage).skeleton) == 7


def test_no_twig_grows_into_the_ground() -> None:
    foliage = np.zeros((400, 500), dtype=bool)
    foliage[370:400, 170:235] = True
    tree = reached(foliage).skeleton
    assert len(tree) > 7
    assert tree.points[:, 1].min() == 0


class BeforeAndBehind(TurnedOutline):
    """A crown whose foliage stands right of the tree far before the picture's plane, left of it as far behind it."""

    def admits(self, points_world: Floats) -> Mask:
        return np.asarray(np.sign(points_world[:, 0]) * points_world[:, 2] > 0.2)


def test_twigs_end_amid_the_foliage_in_depth_too() -> None:
    foliage = np.zeros((400, 500), dtype=bool)
    foliage[50:150, 80:440] = True
    front = Silhouette(foliage, CAMERA)
    volume = BeforeAndBehind(**vars(turned_outline(front)))
    tree = Grown(fork(), np.array([0, 0, 0, 1, 1, 2, 2]), np.zeros((0, 3), np.int64))
    skeleton = reaching(tree, front, volume).skeleton
    tips = np.setdiff1d(np.flatnonzero(child_counts(skeleton) == 0), np.arange(7))
    assert len(tips) > 5
    assert set(np.sign(skeleton.points[tips, 0])) == {-1.0, 1.0}
    assert volume.admits(skeleton.points[tips]).all()
