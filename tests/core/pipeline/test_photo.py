from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from tests.conftest import DATA, EXAMPLES
from tests.core.pipeline.recipes import model_photo

from treestroke.core.pipeline.evidence import read_photo
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.pipeline.photo import trace_photo
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.strokes import Stroke, Strokes
from treestroke.service.loading import load_photo, load_strokes

QUICK = ModelSettings(iterations=30)
STAGES = ["foliage", "trace", "lift", "grow", "leaf", "mesh"]


def given(tree: Path) -> tuple[np.ndarray, Strokes]:
    return load_photo(tree.with_suffix(".jpg")), load_strokes(tree.with_suffix(".strokes.json"))


def modelled(tree: Path, settings: ModelSettings = QUICK, seed: int = 0) -> TreeModel:
    return model_photo(read_photo(*given(tree)), settings, np.random.default_rng(seed))


def enlarged(strokes: Strokes, factor: float) -> Strokes:
    def larger(stroke: Stroke) -> Stroke:
        return Stroke(stroke.points * factor, stroke.width)

    return Strokes(larger(strokes.crown), tuple(map(larger, strokes.branches)), tuple(map(larger, strokes.erase)))


MAPLE = EXAMPLES / "sugar_maple_autumn"


@pytest.fixture(scope="module")
def maple() -> TreeModel:
    return modelled(MAPLE)


def test_the_same_seed_gives_the_same_arrays(maple: TreeModel) -> None:
    again = modelled(MAPLE)
    assert maple.leaf is not None
    assert again.leaf is not None
    for one, other in ((maple.bark, again.bark), (maple.leaf, again.leaf)):
        for name in ("positions", "normals", "uvs", "triangles"):
            assert np.array_equal(getattr(one.mesh, name), getattr(other.mesh, name))
        assert np.array_equal(one.texture, other.texture)


def test_another_seed_gives_another_tree(maple: TreeModel) -> None:
    other = modelled(MAPLE, seed=1)
    assert not np.array_equal(other.bark.mesh.positions, maple.bark.mesh.positions)


def test_lines_among_the_maple_s_leaves_make_no_net_of_limbs() -> None:
    traced = read_photo(*given(MAPLE)).traced
    assert traced is not None
    found, points, parents = traced.stroke < 0, traced.skeleton.points, traced.skeleton.parents
    length, start = np.zeros(len(points)), np.arange(len(points))
    for joint in np.flatnonzero(found):
        start[joint] = start[parents[joint]]
        length[joint] = length[parents[joint]] + np.linalg.norm(points[joint] - points[parents[joint]])
    assert 10 < found.sum() < 30
    assert (length <= 1.4 * np.linalg.norm(points - points[start], axis=1))[found].all()


@pytest.mark.parametrize("name", ["redbud_park", "cherry_blossom"])
def test_a_trunk_that_leaves_the_photo_at_the_bottom_is_cut_level_at_the_origin(name: str) -> None:
    photo, strokes = given(DATA / name)
    trunk = strokes.branches[0].points
    row = int(trunk[0, 1] - 0.05 * np.ptp(trunk[:, 1]))
    start = [np.interp(-row, -trunk[:, 1], trunk[:, 0]), row]
    cut = Stroke(np.vstack([start, trunk[trunk[:, 1] < row]]))
    evidence = read_photo(photo[:row], replace(strokes, branches=(cut,)))
    tree = model_photo(evidence, ModelSettings(iterations=0), np.random.default_rng(0))
    bark, skeleton = tree.bark.mesh.positions, tree.grown.skeleton
    flat = bark[bark[:, 1] == 0.0]
    above = skeleton.radii[(skeleton.points[:, 1] > 0.3) & (skeleton.points[:, 1] < 0.8)].max()
    assert bark[:, 1].min() == 0.0
    assert flat.mean(axis=0) == pytest.approx(np.zeros(3), abs=0.05)
    assert np.ptp(flat[:, 0]) / 2 == pytest.approx(above, rel=0.1)


def test_the_origin_is_in_the_trunk_s_foot_and_the_tree_is_as_high_as_asked(maple: TreeModel) -> None:
    # The stroke begins at the origin; the trunk stands where the photo shows it, whose middle may be beside that.
    x, *others = maple.grown.skeleton.points[0].tolist()
    assert others == pytest.approx([0.0, 0.0], abs=1e-6)
    assert abs(x) < 0.2 * maple.grown.skeleton.radii[0]
    assert maple.leaf is not None
    assert maple.leaf.mesh.positions[:, 1].max() == pytest.approx(10.0, abs=1.0)


def test_height_scales_the_whole_tree(maple: TreeModel) -> None:
    double = modelled(MAPLE, ModelSettings(iterations=30, height=20.0))
    assert double.camera.metres_per_pixel == pytest.approx(2 * maple.camera.metres_per_pixel)
    assert double.grown.skeleton.points == pytest.approx(2 * maple.grown.skeleton.points, abs=1e-6)


@pytest.fixture(scope="module")
def huge() -> TreeModel:
    photo, strokes = given(MAPLE)
    factor = 6000 / max(photo.shape[:2])
    size = (6000, round(photo.shape[0] * factor))
    large = np.asarray(cv2.resize(photo, size, interpolation=cv2.INTER_CUBIC), dtype=np.uint8)
    return model_photo(read_photo(large, enlarged(strokes, factor)), QUICK, np.random.default_rng(0))


def test_a_large_photo_gives_its_camera_in_its_own_pixels(maple: TreeModel, huge: TreeModel) -> None:
    factor = 6000 / maple.camera.width
    assert (huge.camera.width, huge.camera.height) == (6000, round(maple.camera.height * factor))
    assert huge.camera.metres_per_pixel * factor == pytest.approx(maple.camera.metres_per_pixel, rel=0.02)
    assert huge.camera.root_px == pytest.approx(tuple(factor * v for v in maple.camera.root_px), rel=0.01)


def test_a_large_photo_gives_a_tree_of_the_same_shape(maple: TreeModel, huge: TreeModel) -> None:
    assert maple.leaf is not None
    assert huge.leaf is not None
    spans = [np.ptp(np.percentile(s.mesh.positions, [2, 98], axis=0), axis=0) for s in (maple.leaf, huge.leaf)]
    assert spans[1] == pytest.approx(spans[0], rel=0.1)
    assert len(huge.cards) == pytest.approx(len(maple.cards), rel=0.3)


def test_a_large_photo_s_trace_is_in_its_own_pixels() -> None:
    photo, strokes = given(MAPLE)
    large = np.asarray(cv2.resize(photo, None, fx=4, fy=4, interpolation=cv2.INTER_CUBIC), dtype=np.uint8)
    small, traced = trace_photo(photo, strokes), trace_photo(large, enlarged(strokes, 4))
    assert traced.foliage.shape == large.shape[:2]
    assert traced.skeleton is not None
    assert small.skeleton is not None
    assert traced.skeleton.points[0] / 4 == pytest.approx(small.skeleton.points[0], abs=1.0)
    assert traced.foliage.mean() == pytest.approx(small.foliage.mean(), rel=0.05)


@pytest.mark.parametrize(
    "settings", [ModelSettings(iterations=30, foliage="bare"), ModelSettings(iterations=30, leaf_density=0)]
)
def test_a_tree_without_leaves_has_none(settings: ModelSettings) -> None:
    model = modelled(MAPLE, settings)
    assert (model.leaf, model.cards) == (None, None)
    assert len(model.bark.mesh.triangles) > 100


@pytest.mark.parametrize(
    ("tree", "kind"),
    [(DATA / "ponderosa_slope", "needles"), (DATA / "bigleaf_maple_bare", "bare")],
    ids=["pine", "bare"],
)
def test_the_kind_is_seen(tree: Path, kind: str) -> None:
    assert modelled(tree, ModelSettings(iterations=0, leaf_density=0)).taken.foliage == kind


def test_the_kind_can_be_overruled(maple: TreeModel) -> None:
    assert maple.taken.foliage == "leaves"
    assert modelled(MAPLE, ModelSettings(iterations=0, leaf_density=0, foliage="needles")).taken.foliage == "needles"


def test_a_palm_s_only_stems_are_those_with_a_stroke() -> None:
    model = modelled(EXAMPLES / "oak_02.jpg", ModelSettings(iterations=4, foliage="palm"))
    _, strokes = given(EXAMPLES / "oak_02.jpg")
    joints = model.grown.skeleton.parents[model.grown.born == 0]
    tips = np.setdiff1d(np.arange(len(joints)), joints)
    assert len(tips) <= len(strokes.branches)


def test_progress_names_the_stages_in_order() -> None:
    seen: list[str] = []

    def report(stage: str, _: float) -> None:
        seen.append(stage)

    found = read_photo(*given(MAPLE), None, report)
    model_photo(found, ModelSettings(iterations=5), np.random.default_rng(0), report)
    assert list(dict.fromkeys(seen)) == STAGES


def test_without_a_branch_stroke_the_foliage_alone_is_traced() -> None:
    photo, strokes = given(MAPLE)
    traced = trace_photo(photo, Strokes(strokes.crown))
    assert traced.skeleton is None
    assert len(traced.stroke) == 0
    assert np.array_equal(traced.foliage, trace_photo(photo, strokes).foliage)


def test_limbs_under_strokes_are_wood_though_blossoms_are_nearer_to_the_trunk_s_colour() -> None:
    traced = read_photo(*given(DATA / "cherry_blossom")).traced
    assert traced is not None
    assert traced.measured[traced.stroke > 0].mean() > 0.7


def test_what_was_seen_of_the_crown_is_kept_between_strokes_and_changes_nothing() -> None:
    photo, strokes = given(EXAMPLES / "oak_02")
    first = read_photo(photo, Strokes(strokes.crown, strokes.branches[:-1]))
    before, again, anew = (
        read.traced for read in (first, read_photo(photo, strokes, first), read_photo(photo, strokes))
    )
    assert before is not None
    assert again is not None
    assert anew is not None
    assert again.picture is before.picture
    assert (anew.stroke < 0).sum() > 20
    assert np.array_equal(again.skeleton.points, anew.skeleton.points)
