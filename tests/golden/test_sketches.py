"""Summary numbers of the sketches that come with the project."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from tests.conftest import EXAMPLES

from treestroke.core.lift.retrieval import retrieve_depth
from treestroke.core.pipeline.crowns import drawn
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sides import UNITS, draw_side, in_units, stroke_height
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.service.loading import load_sketch
from treestroke.service.model import Model, sketch

SKETCHES = EXAMPLES / "sketches"
PAIRS = ("pear", "orange", "pine", "vine", "imagined")
pytestmark = pytest.mark.golden


def side_of(name: str, side: str) -> Path:
    return next(path for ending in ("json", "png") if (path := SKETCHES / f"{name}.{side}.{ending}").exists())


@pytest.fixture(scope="module", params=PAIRS)
def model(request: pytest.FixtureRequest) -> Model:
    settings = json.loads((SKETCHES / f"{request.param}.settings.json").read_text())
    return sketch(side_of(request.param, "front"), side_of(request.param, "side"), settings)


def test_every_tree_is_true_to_both_of_its_sketches(model: Model) -> None:
    score = model.report["score"]
    assert min(score["front_covered"], score["side_covered"]) >= 0.98
    assert min(score["front_true"], score["side_true"]) >= 0.95
    assert score["silhouette_iou"] >= 0.9


def test_every_tree_is_full_and_no_pair_of_planes(model: Model) -> None:
    score = model.report["score"]
    assert score["paired"] >= 0.8
    assert score["in_planes"] <= 0.22


def test_every_tree_is_one_and_bears_about_2000_small_branches(model: Model) -> None:
    skeleton = model.tree.grown.skeleton
    assert (skeleton.parents[1:] >= 0).all()
    assert model.report["counts"]["branches"] == pytest.approx(2000 + 110, abs=130)
    assert model.report["counts"]["iterations"] == ModelSettings().iterations


def test_trunks_are_as_thick_as_trees_have_them_or_as_the_brush_was(model: Model) -> None:
    thickest = float(model.tree.grown.skeleton.radii.max()) / model.report["settings"]["height"]
    assert 0.008 < thickest < 0.09


def test_a_brush_s_very_ink_is_covered_on_both_sides() -> None:
    sketches = [load_sketch(side_of("imagined", side), side) for side in ("front", "side")]
    drawings = [draw_side(each, side) for each, side in zip(sketches, ("front", "side"), strict=True)]
    tree = retrieve_depth(*(in_units(each.tree, stroke_height(each)) for each in drawings)).tree.skeleton
    for paper, drawing, axis in zip(sketches, drawings, (0, 2), strict=True):
        unit = stroke_height(drawing) / UNITS
        seen = drawing.tree.skeleton.points[0] + np.stack([tree.points[:, axis], -tree.points[:, 1]], axis=1) * unit
        assert paper.ink is not None
        limbs = drawn(Skeleton(seen, tree.radii * unit, tree.parents), paper.ink.shape)
        away = cv2.distanceTransform((~limbs).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        assert (away[paper.ink] <= 2 * unit).mean() >= 0.985
