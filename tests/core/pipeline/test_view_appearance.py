import numpy as np
import pytest

from treestroke.core.capture import Shot, TreeMatte
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.pipeline.view_appearance import view_appearance
from treestroke.core.skeleton.skeleton import Skeleton

SIZE = 120
TREE = Skeleton(np.array([[0.0, 0, 0], [0, 4, 0], [0, 6, 0], [1, 5, 1]]), np.array([0.3, 0.3, 0.1, 0.1]), [-1, 0, 1, 1])


def shot_from(azimuth: float, grey: int = 90) -> Shot:
    """A grey shot from 10 m away, level, at the height of the tree's middle."""
    back = np.array([np.sin(azimuth), 0.0, np.cos(azimuth)])
    turn = np.stack([np.array([back[2], 0.0, -back[0]]), [0.0, -1.0, 0.0], -back])
    pose = np.column_stack([turn, -turn @ (10 * back + [0.0, 3.0, 0.0])])
    camera = PerspectiveCamera(SIZE, SIZE, pose, 120.0, (SIZE / 2, SIZE / 2))
    return Shot(f"{azimuth:.1f}.jpg", np.full((SIZE, SIZE, 3), grey, np.uint8), camera)


def matte() -> TreeMatte:
    """A trunk below a ball of leaves, and a post before its left edge."""
    row, column = np.indices((SIZE, SIZE))
    ball = np.hypot(row - 36, column - 60) < 24
    trunk = (np.abs(column - 60) < 4) & (row >= 60) & (row < 98)
    hidden = (column >= 30) & (column < 40) & ball
    return TreeMatte((ball | trunk).astype(np.float32), trunk.astype(np.float32), hidden)


@pytest.fixture(scope="module")
def front():
    return view_appearance([shot_from(0.0)], [matte()], TREE).views[0]


def at(view, point):
    x, y = np.floor(view.camera.pixels_from_world(np.array([point], dtype=float))[0]).astype(int)
    return y, x


def test_leaves_may_lie_in_the_foliage_behind_wood_and_behind_what_hides_the_tree(front):
    crown, trunk, beside = at(front, (0, 4.6, 0)), at(front, (0, 1.0, 0)), at(front, (-1.6, 1.0, 0))
    assert front.foliage[crown]
    assert front.leaves_from[trunk] == pytest.approx(10.0, abs=0.05)
    assert np.isposinf(front.leaves_from[beside])
    hidden = at(front, (-1.9, 5.0, 0))
    assert front.leaves_from[hidden] == 0
    assert not front.foliage[hidden]


def test_wood_and_foliage_are_the_tree_and_only_leaves_have_their_colour(front):
    assert front.tree[at(front, (0, 1.0, 0))]
    assert not front.leaf_coloured[at(front, (0, 1.0, 0))]
    assert front.leaf_coloured[at(front, (0, 4.6, 0))]


def test_a_view_is_the_part_of_the_shot_that_shows_the_tree(front):
    assert front.camera.width < SIZE
    assert front.picture.shape[:2] == front.tree.shape == (front.camera.height, front.camera.width)


def test_the_stem_is_read_where_it_is_seen(front):
    foot, top = front.stem.radii_px[0], front.stem.radii_px[-1]
    assert foot == pytest.approx(0.3 * 120 / 10, rel=0.05)
    assert top == 0


def test_the_nearer_limb_is_the_wood_that_is_seen():
    crossed = Skeleton(np.array([[0.0, 0, 0], [0, 6, 0], [0, 3, 2]]), np.full(3, 0.2), [-1, 0, 1])
    row, column = np.indices((SIZE, SIZE))
    bare = ((np.abs(column - 60) < 3) & (row > 20) & (row < 96)).astype(np.float32)
    view = view_appearance([shot_from(0.0)], [TreeMatte(bare, bare, np.zeros((SIZE, SIZE), bool))], crossed).views[0]
    assert view.leaves_from[at(view, (0, 3.4, 0))] < 9.0


def test_a_photo_darker_than_its_neighbours_is_brought_to_their_light():
    azimuths = np.deg2rad(np.arange(0, 120, 15))
    shots = [shot_from(azimuth, 80 if number == 3 else 90) for number, azimuth in enumerate(azimuths)]
    greys = [int(view.picture[0, 0, 0]) for view in view_appearance(shots, [matte()] * len(shots), TREE).views]
    assert abs(greys[3] - 90) <= 4
    assert all(abs(grey - 90) <= 4 for grey in greys)


def test_a_sunny_side_stays_brighter():
    azimuths = np.deg2rad(np.arange(0, 360, 20))
    shots = [shot_from(azimuth, round(100 + 30 * np.cos(azimuth))) for azimuth in azimuths]
    greys = [int(view.picture[0, 0, 0]) for view in view_appearance(shots, [matte()] * len(shots), TREE).views]
    assert greys[0] > greys[9] + 40


def test_bark_is_read_on_the_side_in_the_usual_light():
    azimuths = np.deg2rad(np.arange(0, 360, 20))
    shots = [shot_from(azimuth, round(100 + 30 * np.cos(azimuth))) for azimuth in azimuths]
    view = view_appearance(shots, [matte()] * len(shots), TREE).bark_view
    assert abs(int(view.picture[0, 0, 0]) - 100) < 12
    assert (view.stem.radii_px > 0).any()


def test_a_bare_tree_can_be_given_leaves_between_its_twigs():
    row, column = np.indices((SIZE, SIZE))
    twigs = (np.hypot(row - 36, column - 60) < 24) & (column % 3 == 0)
    trunk = (np.abs(column - 60) < 4) & (row >= 60) & (row < 98)
    bare = (twigs | trunk).astype(np.float32)
    shot = shot_from(0.0)
    appearance = view_appearance([shot], [TreeMatte(bare, bare, np.zeros_like(twigs))], TREE, shows_leaves=False)
    view = appearance.views[0]
    assert not appearance.shows_leaves
    assert not view.leaf_coloured.any()
    crown, foot = at(view, (0, 4.6, 0)), at(view, (0, 1.0, 0))
    assert view.foliage[crown[0], crown[1] : crown[1] + 3].all()
    assert not view.foliage[foot]


def test_a_tree_that_no_shot_shows_is_refused():
    nothing = TreeMatte(*np.zeros((2, SIZE, SIZE), np.float32), np.zeros((SIZE, SIZE), bool))
    with pytest.raises(ValueError, match="no shot"):
        view_appearance([shot_from(0.0)], [nothing], TREE)
