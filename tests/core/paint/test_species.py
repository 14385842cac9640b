from typing import get_args

import numpy as np
import pytest

from treestroke.core.paint.blades import BladeName
from treestroke.core.paint.palette import lab_from_rgb, rgb_from_lab
from treestroke.core.paint.species import KINDS, SPECIES


def test_every_leaf_that_is_drawn_belongs_to_a_species():
    assert {KINDS[name].blade for name in SPECIES} - {None} == set(get_args(BladeName))


@pytest.mark.parametrize("name", SPECIES)
def test_a_species_has_either_a_leaf_or_needles(name):
    assert (KINDS[name].blade is None) != (KINDS[name].needles is None)


def test_only_pine_and_spruce_are_evergreen():
    assert [name for name in SPECIES if KINDS[name].evergreen] == ["pine", "spruce"]


@pytest.mark.parametrize("name", ["auto", *SPECIES])
def test_all_colours_can_be_shown(name):
    for ramp in (KINDS[name].spring, KINDS[name].summer, KINDS[name].autumn):
        labs = np.array(ramp)
        assert abs(lab_from_rgb(rgb_from_lab(labs)) - labs).max() < 3
