import json
from pathlib import Path

import numpy as np
import pytest
from tests.api import sketched

import treestroke
from treestroke.core.errors import SettingsError
from treestroke.core.pipeline.grown_tree import LiveTree
from treestroke.service.trace import Trace, trace_sketches


def test_foliage_and_branches_lie_in_the_photo(maple_photo: Path, maple_strokes: Path) -> None:
    found = treestroke.trace(maple_photo, maple_strokes)
    height, width = found.photo.shape[:2]
    assert found.foliage.shape == (height, width)
    assert found.skeleton is not None
    assert (found.skeleton.points >= 0).all()
    assert (found.skeleton.points <= (width, height)).all()
    assert len(found.stroke) == len(found.skeleton)


def test_the_answer_is_plain_json(maple_photo: Path, maple_strokes: Path) -> None:
    answer = treestroke.trace(maple_photo, maple_strokes).as_dict()
    assert json.loads(json.dumps(answer)) == answer


def test_without_branches_the_foliage_alone_is_found(maple_photo: Path, maple_strokes: Path) -> None:
    crown = json.loads(maple_strokes.read_text())["crown"]
    found = treestroke.trace(maple_photo, {"crown": crown})
    assert found.skeleton is None
    assert np.count_nonzero(found.foliage) > 1000


@pytest.fixture(scope="module")
def live(maple_photo: Path, maple_strokes: Path) -> Trace:
    return treestroke.trace(maple_photo, maple_strokes, grow=True)


def same(one: LiveTree | None, other: LiveTree | None) -> bool:
    assert one is not None
    assert other is not None
    pairs = [(getattr(one.skeleton, name), getattr(other.skeleton, name)) for name in ("points", "radii", "parents")]
    arrays = all(np.array_equal(*pair) for pair in [*pairs, (one.born, other.born)])
    return arrays and one.camera == other.camera


def test_the_live_tree_is_the_one_that_the_model_grows(live: Trace, maple_photo: Path, maple_strokes: Path) -> None:
    seen: list[LiveTree] = []
    model = treestroke.model(maple_photo, maple_strokes, {"leaf_density": 0}, on_grown=seen.append)
    assert same(live.grown, seen[0])
    assert np.array_equal(live.grown.skeleton.points, model.tree.grown.skeleton.points)
    assert live.grown.camera == model.tree.camera


def test_the_live_tree_is_the_same_whether_its_foliage_is_known(live: Trace, maple_strokes: Path) -> None:
    crown = json.loads(maple_strokes.read_text())["crown"]
    before = treestroke.trace(live.photo, {"crown": crown})
    after = treestroke.trace(live.photo, maple_strokes, after=before, grow=True)
    assert after.photo_trace.evidence.foliage is before.photo_trace.evidence.foliage
    assert same(after.grown, live.grown)


def test_what_was_traced_of_the_same_strokes_is_not_traced_again(live: Trace, maple_strokes: Path) -> None:
    before = treestroke.trace(live.photo, maple_strokes)
    after = treestroke.trace(live.photo, maple_strokes, after=before, grow=True)
    assert after.photo_trace is before.photo_trace
    assert same(after.grown, live.grown)


def test_only_the_tree_is_grown_again_by_other_settings(live: Trace, maple_photo: Path, maple_strokes: Path) -> None:
    settings = {"foliage": "needles", "iterations": 100}
    after = treestroke.trace(live.photo, maple_strokes, after=live, grow=True, settings=settings)
    assert after.photo_trace is live.photo_trace
    assert not same(after.grown, live.grown)
    seen: list[LiveTree] = []
    treestroke.model(maple_photo, maple_strokes, {**settings, "leaf_density": 0}, on_grown=seen.append)
    assert same(after.grown, seen[0])


def test_what_the_photo_shows_is_taken_whatever_the_settings_say(live: Trace, maple_strokes: Path) -> None:
    chosen = treestroke.trace(live.photo, maple_strokes, after=live, settings={"foliage": "palm", "form": "vase"})
    assert live.taken is not None
    assert live.taken.foliage == "leaves"
    assert chosen.taken == live.taken
    crown = json.loads(maple_strokes.read_text())["crown"]
    assert treestroke.trace(live.photo, {"crown": crown}, after=live).taken is None


def test_a_setting_that_cannot_be_used_is_refused(live: Trace, maple_strokes: Path) -> None:
    with pytest.raises(SettingsError) as caught:
        treestroke.trace(live.photo, maple_strokes, after=live, settings={"foliage": "moss"})
    assert caught.value.pointer == "/foliage"


def test_another_erase_stroke_is_traced(live: Trace, maple_strokes: Path) -> None:
    strokes = json.loads(maple_strokes.read_text())
    erase = {"points": [[5.0, 5.0], [15.0, 15.0]]}
    assert treestroke.trace(live.photo, {**strokes, "erase": [erase]}, after=live).photo_trace is not live.photo_trace


def test_growing_changes_nothing_of_the_trace(live: Trace, maple_photo: Path, maple_strokes: Path) -> None:
    plain, grown = treestroke.trace(maple_photo, maple_strokes).as_dict(), live.as_dict()
    assert {name: grown[name] for name in plain} == plain


def test_an_answer_with_a_live_tree_is_plain_json(live: Trace) -> None:
    answer = live.as_dict()
    assert json.loads(json.dumps(answer)) == answer
    assert set(answer) == {"foliage", "skeleton", "taken", "warnings", "grown", "photo"}
    assert set(answer["grown"]) == {"points", "radii", "parents", "born", "photo"}
    assert answer["photo"] == answer["grown"]["photo"]
    assert (answer["photo"]["width"], answer["photo"]["height"]) == (live.photo.shape[1], live.photo.shape[0])


def test_the_live_tree_s_root_stands_at_the_root_s_pixel(live: Trace, maple_strokes: Path) -> None:
    photo = live.as_dict()["photo"]
    x, y, _ = live.grown.skeleton.points[0]
    place = photo["root"][0] + x / photo["metres_per_pixel"], photo["root"][1] - y / photo["metres_per_pixel"]
    assert place == pytest.approx(live.skeleton.points[0], abs=1e-6)


def test_without_branches_nothing_grows(maple_photo: Path, maple_strokes: Path) -> None:
    crown = json.loads(maple_strokes.read_text())["crown"]
    found = treestroke.trace(maple_photo, {"crown": crown}, grow=True)
    assert found.grown is None
    assert (found.as_dict()["grown"], found.as_dict()["photo"]) == (None, None)


def test_a_trace_of_sketches_shows_what_was_drawn() -> None:
    found = trace_sketches(sketched.FRONT, sketched.SIDE)
    assert found.grown is None
    answer = found.as_dict()
    for view, given in (("front", sketched.FRONT), ("side", sketched.SIDE)):
        points = answer[view]["skeleton"]["points"]
        for branch in given["branches"]:
            assert min(abs(x - branch["points"][-1][0]) + abs(y - branch["points"][-1][1]) for x, y in points) < 1.0
