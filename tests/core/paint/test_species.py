from typing import get_args

import numpy as np
import pytest

from treestroke.core.paint.leaf_shapes import LeafShapeName
from treestroke.core.paint.palette import lab_from_rgb, rgb_from_lab
from treestroke.core.paint.species import AUTO, SPECIES, species_for


def test_every_leaf_that_is_drawn_belongs_to_a_species():
    assert {species.leaf_shape for species in SPECIES.values()} - {None} == set(get_args(LeafShapeName))


@pytest.mark.parametrize("name", SPECIES)
def test_a_species_has_either_a_leaf_or_needles(name):
    assert (SPECIES[name].leaf_shape is None) != (SPECIES[name].needles is None)


def test_only_pine_and_spruce_are_evergreen():
    assert [name for name, species in SPECIES.items() if species.evergreen] == ["pine", "spruce"]


@pytest.mark.parametrize("name", ["auto", *SPECIES])
def test_all_colours_can_be_shown(name):
    species = SPECIES.get(name, AUTO)
    for ramp in (species.spring, species.summer, species.autumn):
        labs = np.array(ramp)
        assert abs(lab_from_rgb(rgb_from_lab(labs)) - labs).max() < 3


def test_an_unknown_tree_bears_the_sprays_of_most_trees_of_its_form() -> None:
    assert species_for("auto", "needles", "spire").needles == "short"
    assert species_for("auto", "needles", "umbrella").needles == "long"
    assert species_for("auto", "leaves", "weeping").leaf_shape == "willow"
    assert species_for("auto", "leaves", "round") == AUTO
    assert species_for("spruce", "needles", "round") == SPECIES["spruce"]
