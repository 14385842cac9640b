import numpy as np

from treestroke.core.film.hierarchy import sway_skeleton
from treestroke.core.film.tracks import Tracks


def two_limbs() -> Tracks:
    """Two groups of tracks that overlap in the picture a little and sway against each other."""
    rng = np.random.default_rng(8)
    rest = np.concatenate([rng.normal([-20.0, -60.0], 12.0, (80, 2)), rng.normal([20.0, -60.0], 12.0, (80, 2))])
    time = np.arange(50) / 25.0
    swing = np.where(np.arange(160) < 80, np.sin(9.0 * time)[:, None], np.sin(6.0 * time + 1.0)[:, None])
    points = rest + np.stack([3.0 * swing, 0.3 * swing], axis=2)
    return Tracks(points, np.ones((50, 160), dtype=bool), rest)


def test_what_sways_together_is_on_one_limb() -> None:
    tree = sway_skeleton(two_limbs(), np.zeros(2), 100.0)
    assert tree is not None
    assert tree.parents[0] == -1
    assert (tree.parents[1:] < np.arange(1, len(tree))).all()
    first = np.flatnonzero(tree.parents == 1)
    assert len(first) == 2
    assert tree.points[first, 0].min() < -3.0
    assert tree.points[first, 0].max() > 3.0


def test_inner_joints_are_drawn_toward_the_root_and_thicker() -> None:
    tree = sway_skeleton(two_limbs(), np.zeros(2), 100.0)
    assert tree is not None
    children = tree.parents >= 0
    assert (tree.radii[children] <= tree.radii[tree.parents[children]] + 1e-9).all()
    assert np.linalg.norm(tree.points[1]) < 60.0


def test_few_points_make_no_limbs() -> None:
    many = two_limbs()
    few = Tracks(many.points[:, ::16], many.seen[:, ::16], many.rest[::16])
    assert sway_skeleton(few, np.zeros(2), 100.0) is None
