import numpy as np
import pytest

from treestroke.core.segment.form import crown_form
from treestroke.core.types import FoliageKind, TreeForm

ROUND = {"aspect": 0.1, "taper": 0.7, "widest": 0.5, "tip": 0.3, "shoulder": 0.6, "foot": 0.5, "level": 0.0}
TRUNK = np.array([[100.0, 300.0], [100.0, 150.0]])


def form_of(kind: FoliageKind = "leaves", branches: tuple[np.ndarray, ...] = (TRUNK,), **cues: float) -> TreeForm:
    return crown_form({**ROUND, **cues}, kind, branches, 300.0)


@pytest.mark.parametrize(
    ("cues", "form"),
    [
        ({}, "round"),
        ({"aspect": 0.6, "taper": 0.25, "widest": 0.9}, "spire"),
        ({"aspect": 0.5, "taper": 0.4, "widest": 0.8}, "spire"),
        ({"aspect": 1.2, "taper": 0.8}, "columnar"),
        ({"aspect": 0.75, "taper": 0.6, "widest": 0.7, "level": -0.3}, "columnar"),
        ({"aspect": -0.9, "foot": 0.3}, "umbrella"),
        ({"aspect": -0.6, "foot": 0.3, "shoulder": 0.45}, "umbrella"),
        ({"level": -0.4, "widest": 0.7}, "weeping"),
        ({"widest": 0.3, "foot": 0.2, "shoulder": 0.8}, "vase"),
        ({"aspect": 0.8, "taper": 2.9, "widest": 0.3, "foot": 0.1, "shoulder": 0.8}, "vase"),
    ],
)
def test_the_outline_tells_the_form(cues: dict[str, float], form: TreeForm) -> None:
    assert form_of(**cues) == form


def test_a_conifer_is_a_spire_sooner_than_a_broad_leaved_tree() -> None:
    tapering = {"aspect": 0.2, "taper": 0.5, "widest": 0.8}
    assert form_of("needles", **tapering) == "spire"
    assert form_of("leaves", **tapering) == "round"


def test_a_conifer_as_wide_as_high_is_a_spire_only_where_it_is_pointed() -> None:
    assert form_of("needles", aspect=-0.05, taper=0.25, widest=0.8) == "spire"
    assert form_of("scales", aspect=-0.05, taper=0.5, widest=0.8) == "round"


def test_strokes_that_begin_at_the_ground_apart_are_several_stems() -> None:
    beside, limb = TRUNK + np.array([40.0, 0.0]), TRUNK - np.array([0.0, 120.0])
    assert form_of(branches=(TRUNK, beside)) == "multi_stem"
    assert form_of(branches=(TRUNK, limb, TRUNK + np.array([1.0, 0.0]))) == "round"


def test_a_palm_has_no_form_of_limbs() -> None:
    assert form_of("palm", aspect=1.5, taper=0.2) == "round"
