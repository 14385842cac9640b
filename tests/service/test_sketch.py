import json
from typing import Any

import pytest
from tests.api import drawn, sketched

from treestroke.core.errors import SettingsError, StrokesError
from treestroke.core.pipeline.grown_tree import LiveTree
from treestroke.service.making import Model
from treestroke.service.sketch import sketch
from treestroke.service.trace import trace_sketches

QUICK = drawn.QUICK


@pytest.fixture(scope="module")
def both() -> Model:
    return sketch(sketched.FRONT, sketched.SIDE, QUICK, 2)


def codes(report: dict[str, Any]) -> list[str]:
    return [warning["code"] for warning in report["warnings"]]


def test_two_sketches_make_the_same_tree_each_time(both: Model) -> None:
    again = sketch(json.dumps(sketched.FRONT).encode(), json.dumps(sketched.SIDE).encode(), QUICK, 2)
    assert again.glb == both.glb
    assert sketch(sketched.FRONT, sketched.SIDE, QUICK, 3).glb != both.glb


def test_the_report_has_what_a_photos_has(both: Model) -> None:
    report = both.report
    assert (report["seed"], codes(report)) == (2, [])
    assert list(report["seconds"]) == ["decode", "trace", "lift", "grow", "leaf", "mesh", "write"]
    assert report["counts"]["bytes"] == len(both.glb)
    assert {"silhouette_iou", "depth_over_width", "front_covered", "side_covered", "paired"} <= set(report["score"])
    json.dumps(report, allow_nan=False)


def test_the_tree_resembles_its_front(both: Model) -> None:
    assert both.report["score"]["silhouette_iou"] > 0.3
    assert both.preview().shape[2] == 3


def test_one_sketch_alone_is_enough_and_says_so() -> None:
    assert codes(sketch(sketched.FRONT, settings=QUICK).report) == ["side_assumed"]


def test_stages_come_in_order_and_the_grown_tree_once() -> None:
    told: list[str] = []
    shown: list[LiveTree] = []
    settings = {**QUICK, "variants": 2}
    made = sketch(sketched.FRONT, sketched.SIDE, settings, 1, lambda stage, _: told.append(stage), shown.append)
    grown = ["lift", "grow", "leaf", "mesh", "write"]
    order = [stage for at, stage in enumerate(told) if at == 0 or told[at - 1] != stage]
    assert order == ["decode", "trace", *grown, *grown]
    assert len(shown) == 1
    assert list(made.files) == ["tree.glb", "tree.v2.glb"]


def test_a_photo_lends_its_colours() -> None:
    plain, coloured = (sketch(sketched.FRONT, settings=QUICK, photo=photo) for photo in (None, drawn.encoded()))
    assert plain.glb != coloured.glb


def test_a_sketch_or_a_setting_that_cannot_be_used_is_named() -> None:
    with pytest.raises(StrokesError, match="^side: "):
        sketch(sketched.FRONT, {"branches": []})
    with pytest.raises(SettingsError, match="^height: "):
        sketch(sketched.FRONT, settings={"height": 0})


def test_a_trace_shows_what_was_drawn() -> None:
    found = trace_sketches(sketched.FRONT, sketched.SIDE)
    assert found.grown is None
    answer = found.answer()
    for view, given in (("front", sketched.FRONT), ("side", sketched.SIDE)):
        points = answer[view]["skeleton"]["points"]
        for branch in given["branches"]:
            assert min(abs(x - branch["points"][-1][0]) + abs(y - branch["points"][-1][1]) for x, y in points) < 1.0
