"""Ten siblings of a tree are all different, and nearer to each other than to those of another kind."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from tests.conftest import DATA, EXAMPLES
from tests.kinship import between, features, within

from treestroke.core.pipeline.evidence import read_photo
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.siblings import grow_sibling, learn
from treestroke.core.types import Floats
from treestroke.service.loading import load_photo, load_strokes

pytestmark = pytest.mark.golden

PHOTOS = {"oak": EXAMPLES / "burr_oak_dusk", "pine": DATA / "ponderosa_slope", "bare": DATA / "bigleaf_maple_bare"}
COUNT = 10


@cache
def siblings(name: str) -> list[Floats]:
    """Measure the siblings of the tree in a photo."""
    photo: Path = PHOTOS[name]
    evidence = read_photo(load_photo(photo.with_suffix(".jpg")), load_strokes(photo.with_suffix(".strokes.json")))
    example = learn(grow_tree(evidence, ModelSettings(), np.random.default_rng(0)), "photo")
    grown = (grow_sibling(example, ModelSettings(), np.random.default_rng((0, n))) for n in range(1, COUNT + 1))
    return [features(tree.grown.skeleton) for tree in grown]


@pytest.mark.parametrize("name", PHOTOS)
def test_no_two_siblings_are_the_same(name: str, measured: Callable[[str], None]) -> None:
    apart = within(siblings(name))
    measured(
        f"siblings of {name}: apart {apart.mean():.3f}, the nearest two {apart.min() / np.median(apart):.2f} of that"
    )
    assert apart.min() > np.median(apart) / 3


@pytest.mark.parametrize("name", PHOTOS)
def test_siblings_are_nearer_to_each_other_than_to_another_kind(name: str, measured: Callable[[str], None]) -> None:
    for other in PHOTOS.keys() - {name}:
        share = within(siblings(name)).mean() / between(siblings(name), siblings(other)).mean()
        measured(f"siblings of {name} are {share:.2f} as far from each other as from those of {other}")
        assert share < 0.5
