import json
from typing import Any

import httpx
import numpy as np
import pytest
from tests.api import drawn, sketched
from tests.api.conftest import Service

from treestroke import trace
from treestroke.core.types import FOLIAGE_KINDS, TREE_FORMS


def traced(client: httpx.Client, photo: str, **request: Any) -> dict[str, Any]:
    answer = client.post(f"/v1/photos/{photo}/trace", json={**drawn.STROKES, **request})
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def test_a_trace_is_that_of_the_library(client: httpx.Client, photo: str) -> None:
    wanted = trace(drawn.pixels(), drawn.STROKES, grow=True).as_dict()
    assert traced(client, photo, rev=3, grow=True) == {"rev": 3, **json.loads(json.dumps(wanted))}


@pytest.mark.parametrize("rev", [None, 0, -1, 2**53 - 1])
def test_the_revision_comes_back(client: httpx.Client, photo: str, rev: int | None) -> None:
    assert traced(client, photo, rev=rev)["rev"] == rev


def test_the_crown_alone_gives_the_foliage(client: httpx.Client, photo: str) -> None:
    answer = client.post(f"/v1/photos/{photo}/trace", json={"crown": drawn.STROKES["crown"]}).json()
    assert answer["skeleton"] == {"points": [], "radii": [], "parents": [], "stroke": []}
    assert "grown" not in answer
    ring = np.array(max(answer["foliage"], key=len))
    assert np.abs(np.hypot(*(ring - (100, 90)).T) - 70).max() < 8


def test_the_skeleton_lies_under_its_strokes_and_every_joint_has_an_earlier_parent(
    client: httpx.Client, photo: str
) -> None:
    skeleton = traced(client, photo)["skeleton"]
    assert skeleton["points"][0] == pytest.approx(drawn.ROOT, abs=3)
    assert all(parent < at for at, parent in enumerate(skeleton["parents"]))
    assert skeleton["stroke"][0] == 0
    assert {len(column) for column in skeleton.values()} == {len(skeleton["points"])}


def test_what_was_mended_is_told(client: httpx.Client, photo: str) -> None:
    far = {"points": [[30, 60], [40, 90]]}
    warnings = traced(client, photo, branches=[*drawn.STROKES["branches"], far])["warnings"]
    assert [(one["code"], one["stroke"]) for one in warnings] == [("branch_joined", "branches/1")]


def test_an_erasing_stroke_is_taken(client: httpx.Client, photo: str) -> None:
    assert traced(client, photo, erase=[{"points": [[10, 10], [20, 20]]}])["skeleton"]["points"]


def test_points_outside_the_photo_are_clamped(client: httpx.Client, photo: str) -> None:
    outside = [[-50.0, -50.0], [1e308, -0.0], [5000, 400], [-1e308, 400]]
    corners = [[0, 0], [200, 0], [200, 240], [0, 240]]
    first, second = (traced(client, photo, crown={"points": points}) for points in (outside, corners))
    assert first["foliage"] == second["foliage"]


def test_a_grown_tree_is_the_one_that_the_model_grows(service: Service, client: httpx.Client, photo: str) -> None:
    grown = traced(client, photo, grow=True)
    model = service.make(photo=photo, strokes=drawn.STROKES)
    told = client.get(f"/v1/models/{model['id']}/events").text
    preview = told.split("event: preview\ndata: ")[1].split("\n")[0]
    assert json.loads(preview) == grown["grown"]
    assert grown["photo"] == grown["grown"]["photo"]
    assert grown["photo"]["root"] == pytest.approx(drawn.ROOT, abs=3)


def test_a_side_gives_the_grown_tree_its_depth(client: httpx.Client, photo: str) -> None:
    plain, beside = traced(client, photo, grow=True), traced(client, photo, grow=True, side=sketched.SIDE)
    assert beside["skeleton"] == plain["skeleton"]
    assert beside["grown"]["points"] != plain["grown"]["points"]
    assert traced(client, photo, grow=True)["grown"] == plain["grown"]


def test_the_grown_tree_grows_by_the_settings(client: httpx.Client, photo: str) -> None:
    plain, needles = (traced(client, photo, grow=True, **by) for by in ({}, {"settings": {"foliage": "needles"}}))
    assert needles["grown"]["points"] != plain["grown"]["points"]
    assert {**needles, "grown": None, "photo": None} == {**plain, "grown": None, "photo": None}
    assert traced(client, photo, grow=True)["grown"] == plain["grown"]


def test_a_trace_says_what_the_tree_is_taken_for(client: httpx.Client, photo: str) -> None:
    taken = traced(client, photo)["taken"]
    assert set(taken) == {"foliage", "form", "sureness", "ask"}
    assert taken["foliage"] in FOLIAGE_KINDS
    assert taken["form"] in TREE_FORMS
    assert 0.0 <= taken["sureness"] <= 1.0
    assert traced(client, photo, settings={"foliage": "palm", "form": "vase"})["taken"] == taken
    assert traced(client, photo, branches=[])["taken"] is None


def test_an_error_in_a_side_is_led_to(client: httpx.Client, photo: str) -> None:
    body = {**drawn.STROKES, "side": {"branches": [{"points": [[1, 1], [1, 1]]}]}}
    answer = client.post(f"/v1/photos/{photo}/trace", json=body)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/side/branches/0")


def test_a_grown_tree_needs_a_trunk(client: httpx.Client, photo: str) -> None:
    answer = traced(client, photo, branches=[], grow=True)
    assert (answer["grown"], answer["photo"]) == (None, None)


@pytest.mark.parametrize(
    ("change", "pointer", "code"),
    [
        ({"rev": 1.5}, "/rev", "wrong_type"),
        ({"rev": True}, "/rev", "wrong_type"),
        ({"rev": 2**53}, "/rev", "wrong_type"),
        ({"grow": 1}, "/grow", "wrong_type"),
        ({"crown": {"points": [[1, 1], [2, 2], [1, 2]]}}, "/crown", "crown_too_small"),
        ({"crown": {"points": [[1, 1], [1, 1], [2, 2]]}}, "/crown", "stroke_too_short"),
        ({"branches": [{"points": [[5, 235], [5, 238]]}]}, "/branches/0", "trunk_outside_crown"),
        ({"branches": [{"points": [[5, 5], [5, 5]]}]}, "/branches/0", "stroke_too_short"),
        ({"branches": [{"points": []}]}, "/branches/0", "stroke_too_short"),
        ({"branches": [{"points": [[5, 5]] * 10_001}]}, "/branches/0", "too_many_points"),
        ({"branches": [{**drawn.STROKES["branches"][0], "width": 0}]}, "/branches/0/width", "width_invalid"),
        ({"branches": [{**drawn.STROKES["branches"][0], "width": None}]}, "/branches/0/width", "wrong_type"),
        ({"branches": [drawn.STROKES["branches"][0]] * 200}, "", "too_many_strokes"),
        ({"colour": 1}, "/colour", "unknown_key"),
        ({"settings": {"foliage": "moss"}}, "/settings/foliage", "setting_not_allowed"),
        ({"settings": {"folliage": "bare"}}, "/settings/folliage", "unknown_setting"),
        ({"settings": []}, "/settings", "wrong_type"),
    ],
)
def test_strokes_that_cannot_be_used_are_named(
    client: httpx.Client, photo: str, change: dict[str, Any], pointer: str, code: str
) -> None:
    answer = client.post(f"/v1/photos/{photo}/trace", json={**drawn.STROKES, **change})
    told = answer.json()
    assert (answer.status_code, told["code"]) == (422, code), told
    assert [(fault["pointer"], fault["code"]) for fault in told["errors"]] == ([(pointer, code)] if pointer else [])


@pytest.mark.parametrize(
    "crown",
    [
        [[40, 40], [160, 140], [160, 40], [40, 140]],  # a figure eight
        [[40, 40], [40, 140], [160, 140], [160, 40]],  # the other way round
        [[40, 40], [160, 40], [160, 140], [60, 140], [60, 20], [180, 20]],  # crossing, and not closed
    ],
)
def test_an_odd_crown_is_usable(client: httpx.Client, photo: str, crown: list[list[int]]) -> None:
    assert traced(client, photo, crown={"points": crown})["foliage"]


def test_a_branch_twice_and_one_outside_the_crown_are_usable(client: httpx.Client, photo: str) -> None:
    trunk = drawn.STROKES["branches"][0]
    outside = {"points": [[5, 200], [8, 235]]}
    answer = traced(client, photo, branches=[trunk, trunk, outside])
    assert [one["stroke"] for one in answer["warnings"]] == ["branches/2"]
