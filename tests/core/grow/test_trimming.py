from dataclasses import replace

import numpy as np
from tests.builders import fork

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import turned_outline
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.trimming import trimmed
from treestroke.core.skeleton.edit import densified
from treestroke.core.skeleton.skeleton import Skeleton

CAMERA = OrthographicCamera(300, 400, 0.01, (150.0, 390.0))


def cut(tree: Skeleton, born: list[int], left: int, right: int, deep_px: float = 400.0) -> Grown:
    """Trim a tree by foliage between two columns, px, as deep as given."""
    foliage = np.zeros((400, 300), dtype=bool)
    foliage[:, left:right] = True
    front = Silhouette(foliage, CAMERA)
    volume = replace(turned_outline(front), radius_px=np.full(400, deep_px))
    return trimmed(Grown(tree, np.array(born), np.zeros((0, 3), np.int64)), front, volume)


def test_ends_that_grew_out_of_the_foliage_go() -> None:
    tree = fork(angle_rad=0.7)
    left = cut(tree, [0, 0, 0, 1, 1, 1, 1], 140, 210)
    assert left.skeleton.points.tolist() == tree.points[:6].tolist()
    assert left.skeleton.parents.tolist() == [-1, 0, 1, 2, 3, 2]
    assert left.born.tolist() == [0, 0, 0, 1, 1, 1]


def test_a_twig_crosses_a_gap_only_for_what_it_bears_beyond() -> None:
    tree, owner = densified(fork(angle_rad=0.7), 0.1)
    born = np.array([0, 0, 0, 1, 1, 1, 1])[owner].tolist()
    aside = int((owner >= 5).sum())
    assert len(cut(tree, born, 160, 300).skeleton) == np.count_nonzero(owner < 3) + aside
    assert len(cut(tree, born, 180, 300).skeleton) == np.count_nonzero(owner < 3)


def test_what_was_seen_stays() -> None:
    assert len(cut(fork(angle_rad=0.7), [0] * 7, 0, 1).skeleton) == 7


def test_wood_behind_the_foliage_goes_unless_it_bears_some() -> None:
    tree = fork(angle_rad=0.7)
    turned = Skeleton(tree.points[:, [2, 1, 0]], tree.radii, tree.parents)
    assert len(cut(turned, [0, 0, 0, 1, 1, 1, 1], 100, 200).skeleton) == len(tree)
    assert len(cut(turned, [0, 0, 0, 1, 1, 1, 1], 100, 200, deep_px=5.0).skeleton) < len(tree)
