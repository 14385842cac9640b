import numpy as np
import pytest
from hypothesis import given
from tests.builders import fork, oak, stick
from tests.strategies import skeletons

from treestroke.core.skeleton.skeleton import Skeleton

POINTS = np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 2.0]])
RADII = np.array([0.3, 0.2, 0.1])
PARENTS = np.array([-1, 0, 1])


@given(skeletons())
def test_each_parent_comes_before_its_child(tree: Skeleton) -> None:
    assert (tree.parents < np.arange(len(tree))).all()
    assert tree.parents[0] == -1


@pytest.mark.parametrize("name", ["points", "radii", "parents"])
def test_arrays_cannot_be_written(name: str) -> None:
    with pytest.raises(ValueError, match="read-only"):
        getattr(stick(), name)[0] = 1


def test_the_caller_s_array_is_copied() -> None:
    points = POINTS.copy()
    tree = Skeleton(points, RADII, PARENTS)
    points[1] = 99.0
    assert np.array_equal(tree.points, POINTS)


@pytest.mark.parametrize("name", ["points", "radii", "parents"])
def test_attributes_cannot_be_replaced(name: str) -> None:
    with pytest.raises(AttributeError):
        setattr(stick(), name, POINTS)


def test_several_stems_are_one_skeleton() -> None:
    assert len(Skeleton(POINTS, RADII, np.array([-1, -1, 1]))) == 3


@pytest.mark.parametrize(
    "points", [np.zeros((0, 3)), np.zeros(3), np.zeros((3, 4)), np.zeros((3, 1)), np.zeros((3, 2, 1))]
)
def test_points_of_another_shape_are_refused(points: np.ndarray) -> None:
    with pytest.raises(ValueError, match=r"points must be \(n, 2\) or \(n, 3\)"):
        Skeleton(points, RADII[: len(points)], PARENTS[: len(points)])


@pytest.mark.parametrize(("radii", "parents"), [(RADII[:2], PARENTS), (RADII, PARENTS[:2]), (RADII[:, None], PARENTS)])
def test_columns_of_different_length_are_refused(radii: np.ndarray, parents: np.ndarray) -> None:
    with pytest.raises(ValueError, match="3 points need 3 radii and parents"):
        Skeleton(POINTS, radii, parents)


@pytest.mark.parametrize(
    ("points", "radii"),
    [
        (POINTS * np.nan, RADII),
        (POINTS + np.inf, RADII),
        (POINTS, RADII * np.nan),
        (POINTS, -RADII),
        (POINTS, RADII * np.inf),
    ],
)
def test_numbers_that_measure_nothing_are_refused(points: np.ndarray, radii: np.ndarray) -> None:
    with pytest.raises(ValueError, match="finite, radii not negative"):
        Skeleton(points, radii, PARENTS)


@pytest.mark.parametrize("parents", [[0, 0, 1], [-1, 1, 1], [-1, 2, 0], [-1, 0, -2], [-1, 0, 7]])
def test_a_parent_that_does_not_come_first_is_refused(parents: list[int]) -> None:
    with pytest.raises(ValueError, match="each parent must come before its child"):
        Skeleton(POINTS, RADII, np.array(parents))


@pytest.mark.parametrize(("tree", "joints"), [(stick(), 5), (fork(), 7), (oak(), 121)])
def test_its_length_is_its_number_of_joints(tree: Skeleton, joints: int) -> None:
    assert len(tree) == joints
