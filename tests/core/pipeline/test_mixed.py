"""A photo, and a sketch of the tree's left side."""

import numpy as np
import pytest
from tests.conftest import EXAMPLES
from tests.core.pipeline.recipes import model_photo

from treestroke.codec.image import decode_photo
from treestroke.codec.strokes import parse_strokes
from treestroke.core.pipeline.evidence import PhotoEvidence, read_photo
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.strokes import Sketch, Stroke

FEW = ModelSettings(iterations=40)


def line(*points: tuple[float, float]) -> Stroke:
    return Stroke(np.array(points, dtype=np.float64))


SIDE = Sketch(
    (300, 400),
    line((150, 20), (90, 80), (80, 200), (130, 260), (200, 250), (240, 160), (210, 70)),
    (
        line((150, 380), (150, 250), (160, 60)),
        line((150, 260), (110, 200), (95, 150)),
        line((150, 250), (200, 180), (225, 120)),
        line((153, 200), (120, 120), (115, 90)),
        line((155, 180), (190, 110), (195, 80)),
    ),
)
"""Leans towards the viewer; its crown is 160 of 360 deep."""


@pytest.fixture(scope="module")
def seen() -> PhotoEvidence:
    photo = decode_photo((EXAMPLES / "burr_oak_dusk.jpg").read_bytes(), "oak")
    strokes = parse_strokes((EXAMPLES / "burr_oak_dusk.strokes.json").read_bytes(), "oak")
    return read_photo(photo, strokes, side=SIDE)


def test_branches_stay_where_the_photo_shows_them_and_take_the_sides_depth(seen: PhotoEvidence) -> None:
    tree = grow_tree(seen, FEW, np.random.default_rng(0))
    assert tree.score["front_covered"] >= 0.9
    assert tree.score["side_covered"] >= 0.98
    assert min(tree.score["front_true"], tree.score["side_true"]) >= 0.95
    assert tree.score["paired"] >= 0.6


def test_the_crown_is_as_deep_as_the_side_shows(seen: PhotoEvidence) -> None:
    model = model_photo(seen, FEW, np.random.default_rng(0))
    assert model.cards is not None
    z, y = model.cards.centres[:, [2, 1]].T
    drawn = (SIDE.crown.points - SIDE.branches[0].points[0]) * [1, -1] / 360 * 10 if SIDE.crown else np.empty((0, 2))
    assert z.min() >= drawn[:, 0].min() - 0.4
    assert z.max() <= drawn[:, 0].max() + 0.4
    assert np.ptp(z) == pytest.approx(np.ptp(drawn[:, 0]), rel=0.2)
    assert y.max() == pytest.approx(10.0, abs=0.5)


def test_without_a_side_nothing_changes(seen: PhotoEvidence) -> None:
    photo = decode_photo((EXAMPLES / "burr_oak_dusk.jpg").read_bytes(), "oak")
    strokes = parse_strokes((EXAMPLES / "burr_oak_dusk.strokes.json").read_bytes(), "oak")
    plain = grow_tree(read_photo(photo, strokes, seen), FEW, np.random.default_rng(0))
    assert set(plain.score) == {"attractors_reached"}
    assert not plain.volume.depth_seen
