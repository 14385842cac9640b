import numpy as np
import pytest
from tests.core.lift.stick_captures import FORK, capture

from treestroke.core.lift.thin_hull import ShownArea, shown_area
from treestroke.core.lift.tips import lengthened
from treestroke.core.skeleton.skeleton import Skeleton

UNIT = 0.012
TWIG = (FORK[1][0], FORK[1][1], 0.01)


@pytest.fixture(scope="module")
def areas() -> list[ShownArea]:
    pairs = zip(*capture((FORK[0], TWIG, FORK[2])), strict=True)
    return [shown_area(shot, matte.tree, matte.tree, matte.hidden) for shot, matte in pairs]


def cut(share: float) -> Skeleton:
    """The trunk and a share of the twig."""
    start, end = np.array(TWIG[0]), np.array(TWIG[1])
    lower = np.linspace((0, 0, 0), start, 40)
    points = np.concatenate([lower, np.linspace(start, start + share * (end - start), 30)[1:]])
    radii = np.where(np.arange(len(points)) < 40, FORK[0][2], TWIG[2])
    return Skeleton(points, radii, np.arange(len(points)) - 1)


def test_a_branch_goes_on_to_where_its_wood_ends(areas: list[ShownArea]) -> None:
    tree = cut(0.7)
    points, parents, whose = lengthened(tree, np.array([len(tree) - 1]), areas, UNIT)
    assert np.linalg.norm(points[-1] - TWIG[1]) < 0.06
    assert parents.tolist() == list(range(len(tree) - 1, len(tree) + len(points) - 1))
    assert (whose == len(tree) - 1).all()


def test_a_whole_branch_ends_where_it_does(areas: list[ShownArea]) -> None:
    tree = cut(1.0)
    assert len(lengthened(tree, np.array([len(tree) - 1]), areas, UNIT)[0]) <= 3


def test_wood_that_another_branch_explains_lengthens_nothing(areas: list[ShownArea]) -> None:
    tree = cut(1.0)
    stub = Skeleton(
        np.concatenate([tree.points, [[0.0, 0.7, 0.03]]]),
        np.append(tree.radii, 0.01),
        np.append(tree.parents, 15),
    )
    assert len(lengthened(stub, np.array([len(tree)]), areas, UNIT)[0]) == 0
