import numpy as np
import pytest
from tests.builders import oak, stick
from tests.core.grow.crowns import limbed_case

from treestroke.core.grow.library import SPRAYS, TYPE_1, TYPE_2, WHORLS, Subtree, choose_library, visible_subtrees
from treestroke.core.grow.placements import turn_library
from treestroke.core.types import FOLIAGE_KINDS

NAMES = ("auto", "visible", "type1", "type2", "both")


@pytest.mark.parametrize("kind", FOLIAGE_KINDS)
@pytest.mark.parametrize("name", NAMES)
def test_every_choice_holds_one_to_eight_subtrees(name: str, kind: str) -> None:
    for skeleton in (stick(), oak(), limbed_case().skeleton):
        assert 1 <= len(choose_library(name, kind, skeleton)) <= 8


def test_type_1_has_shoots_at_the_end_and_type_2_along_the_support() -> None:
    for subtree in TYPE_1:
        assert subtree.fractions[subtree.parents < 0].min() >= 0.85
    for subtree in TYPE_2:
        assert subtree.fractions[subtree.parents < 0].min() <= 0.4


@pytest.mark.parametrize("subtree", TYPE_1 + TYPE_2)
def test_a_predefined_subtree_goes_on_and_bears_no_shoot_longer_than_what_is_left_of_its_path(subtree: Subtree) -> None:
    lengths, on_support = np.linalg.norm(subtree.vectors, axis=1), subtree.parents < 0
    goes_on = int(np.flatnonzero(on_support & (subtree.fractions == 1.0))[0])
    assert subtree.vectors[goes_on, 1] >= np.cos(np.radians(20)) * lengths[goes_on]
    for shoot in np.delete(np.arange(len(lengths)), goes_on):
        parent, fraction = subtree.parents[shoot], subtree.fractions[shoot]
        left = 1 - fraction + lengths[goes_on] if parent < 0 else lengths[parent]
        assert lengths[shoot] <= 0.75 * left


def test_auto_takes_visible_subtrees_where_there_are_enough() -> None:
    assert all(tree in TYPE_1 + TYPE_2 for tree in choose_library("auto", "leaves", stick()))
    taken = [tree for tree in choose_library("auto", "leaves", oak()) if tree not in TYPE_1 + TYPE_2]
    assert 1 <= len(taken) <= 3


def test_a_conifer_gets_whorls_on_its_stem_and_sprays_on_its_limbs() -> None:
    library = choose_library("auto", "needles", oak())
    assert library[: len(WHORLS + SPRAYS)] == WHORLS + SPRAYS
    assert {tree.replaces for tree in WHORLS} == {"stem"}
    assert {tree.replaces for tree in SPRAYS} == {"limb"}
    assert len(library) <= 8


def test_nothing_visible_falls_back_to_the_predefined() -> None:
    assert choose_library("visible", "leaves", stick()) == TYPE_1 + TYPE_2


def test_visible_shoots_are_at_most_085_of_their_support() -> None:
    found = visible_subtrees(oak())
    assert len(found) >= 3
    assert [tree.longest for tree in found] == pytest.approx([0.85] * len(found))


@pytest.mark.parametrize("subtree", TYPE_1 + TYPE_2 + WHORLS + SPRAYS)
def test_no_turn_maps_a_predefined_subtree_onto_itself(subtree: Subtree) -> None:
    vectors = turn_library((subtree,), 12).vectors[0]
    for angle in range(1, 12):
        apart = np.linalg.norm(vectors[angle][:, None] - vectors[0], axis=2).min(axis=1)
        assert apart.max() > 0.05


@pytest.mark.parametrize("subtree", TYPE_1 + TYPE_2 + WHORLS)
def test_no_predefined_subtree_is_flat(subtree: Subtree) -> None:
    across = subtree.vectors[:, [0, 2]]
    assert np.linalg.svd(across)[1].min() > 0.2 * np.linalg.svd(across)[1].max()


def test_an_unknown_name_is_refused() -> None:
    with pytest.raises(ValueError, match="'type3'"):
        choose_library("type3", "leaves", stick())
