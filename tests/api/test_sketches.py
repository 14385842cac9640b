import base64
import hashlib
import io
import json
import zipfile
from collections.abc import Callable
from typing import Any

import httpx
import numpy as np
import pytest
from PIL import Image
from tests.api import corpora, drawn, sketched
from tests.api.conftest import Service
from tests.promises import kept

import treestroke

TRACE = "/v1/sketches/trace"
BOTH = {"front": sketched.FRONT, "side": sketched.SIDE}


def asked(client: httpx.Client, key: str | None = None, **request: Any) -> httpx.Response:
    return client.post("/v1/models", headers={} if key is None else {"Idempotency-Key": key}, **request)


def form(**sketches: bytes) -> dict[str, Any]:
    """Ask for a model that is made at once by a form: arguments of httpx's ``post``."""
    files = {name: (f"{name}.bin", content) for name, content in sketches.items()}
    return {"files": files, "data": {"settings": json.dumps(sketched.QUICK)}}


@pytest.fixture(scope="module")
def tree(service: Service) -> dict[str, Any]:
    """A finished model of both sketches that no test changes."""
    model = service.make(**sketched.request(name="Drawn"))
    assert model["status"] == "succeeded", model
    return model


def test_sketches_are_traced_while_they_are_drawn(client: httpx.Client) -> None:
    client.post(TRACE, json=BOTH)
    with kept(1.0):
        answer = client.post(TRACE, json={**BOTH, "rev": 5})
    told = answer.json()
    assert (answer.status_code, told["rev"], told["warnings"]) == (200, 5, [])
    assert set(told) == {"rev", "front", "side", "warnings"}
    for view in ("front", "side"):
        skeleton = told[view]["skeleton"]
        assert len(skeleton["points"]) == len(skeleton["radii"]) == len(skeleton["parents"]) == len(skeleton["stroke"])
        assert set(skeleton["stroke"]) == {0, 1, 2}


def test_what_would_grow_of_sketches_is_shown_and_nothing_is_kept(service: Service) -> None:
    before = service.stored()
    told = service.client.post(TRACE, json={**BOTH, "grow": True}).json()
    assert len(told["grown"]["points"]) == len(told["grown"]["born"]) > 100
    assert told["photo"] == told["grown"]["photo"]
    assert (told["photo"]["width"], told["photo"]["height"]) == (drawn.WIDTH, drawn.HEIGHT)
    assert told["score"]["front_covered"] > 0.9
    assert service.stored() == before


def test_one_sketch_alone_is_traced_and_says_what_was_assumed(client: httpx.Client) -> None:
    told = client.post(TRACE, json={"front": sketched.pictured(sketched.FRONT)}).json()
    assert told["side"] is None
    assert [warning["code"] for warning in told["warnings"]] == ["side_assumed"]


def test_a_crown_that_was_drawn_is_told_from_one_that_was_assumed(client: httpx.Client) -> None:
    outline = {"points": [[20, 100], [100, 20], [180, 100], [100, 180]]}
    told = client.post(TRACE, json={"front": {**sketched.FRONT, "crown": outline}, "side": sketched.SIDE}).json()
    assert (told["front"]["crown"], told["front"]["crown_drawn"]) == (outline["points"], True)
    assert (len(told["side"]["crown"]) > 3, told["side"]["crown_drawn"]) == (True, False)


@pytest.mark.parametrize(
    ("request_", "pointer", "code"),
    [
        ({}, "/front", "missing_key"),
        ({"side": sketched.SIDE}, "/front", "missing_key"),
        ({"front": "front.png"}, "/front", "wrong_type"),
        ({"front": {"picture": "A" * 33_333_340}}, "/front/picture", "sketch_too_large_file"),
        ({"front": {"picture": "aGVsbG8="}}, "/front/picture", "sketch_unreadable"),
        ({"front": sketched.FRONT, "side": {"branches": "x"}}, "/side/branches", "wrong_type"),
        ({"front": {"branches": [{"points": [[0, 0], [1e9, 5]]}]}}, "/front/branches", "canvas_invalid"),
    ],
)
def test_what_is_wrong_in_a_sketch_is_pointed_at(
    client: httpx.Client, request_: dict[str, Any], pointer: str, code: str
) -> None:
    answer = client.post(TRACE, json=request_)
    told = answer.json()
    assert (answer.status_code, told["code"]) == (422, code)
    assert [fault["pointer"] for fault in told["errors"]] == [pointer]


@pytest.mark.parametrize(
    "make",
    [lambda: sketched.png(sketched.FRONT)[:200], lambda: corpora.flat_png(16_384, 16_384), lambda: b"\x89PNG"],
    ids=["cut", "flat", "short"],
)
def test_a_hostile_picture_is_refused_and_the_next_is_answered(client: httpx.Client, make: Callable[[], bytes]) -> None:
    picture = make()
    answer = client.post(TRACE, json={"front": {"picture": base64.b64encode(picture).decode()}})
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/front/picture")
    assert asked(client, **form(front=picture)).status_code in (400, 422)
    assert client.post(TRACE, json={"front": sketched.FRONT}).status_code == 200


def test_noise_is_no_sketch_and_says_so_before_long(client: httpx.Client) -> None:
    out = io.BytesIO()
    Image.fromarray(np.random.default_rng(0).integers(0, 2, (800, 800), dtype=np.uint8) * 255).save(out, "PNG")
    picture = {"picture": base64.b64encode(out.getvalue()).decode()}
    with kept(10.0):
        answers = client.post(TRACE, json={"front": picture}), asked(client, json={"sketches": {"front": picture}})
    for answer in answers:
        assert answer.status_code == 422, answer.text
        assert answer.json()["errors"][0]["pointer"].endswith("/front")


def test_a_model_of_sketches_is_made_and_gives_them_back(client: httpx.Client, tree: dict[str, Any]) -> None:
    assert (tree["photo"], tree["name"], tree["error"]) == (None, "Drawn", None)
    assert set(tree["files"]) == {"tree.glb", "preview.png", "front.json", "side.json", "project"}
    assert tree["score"]["side_covered"] > 0.9
    for view, given in BOTH.items():
        answer = client.get(tree["files"][f"{view}.json"])
        assert (answer.headers["content-type"], answer.json()) == ("application/json", given)
    assert client.get(tree["files"]["tree.glb"]).content[:4] == b"glTF"


@pytest.mark.parametrize("name", ["strokes.json", "front.png", "side.png", "back.json", "front.txt", "front.tree"])
def test_what_it_was_not_made_of_is_not_found(client: httpx.Client, tree: dict[str, Any], name: str) -> None:
    answer = client.get(f"/v1/models/{tree['id']}/{name}")
    assert (answer.status_code, answer.json()["code"]) == (404, "file_not_found")


def test_a_model_of_a_photo_has_no_sketches(client: httpx.Client, made: dict[str, Any]) -> None:
    assert client.get(f"/v1/models/{made['id']}/front.json").status_code == 404


def test_its_project_holds_what_it_was_made_of(client: httpx.Client, tree: dict[str, Any]) -> None:
    with zipfile.ZipFile(io.BytesIO(client.get(tree["files"]["project"]).content)) as archive:
        assert archive.namelist() == ["front.json", "side.json", "settings.json"]
        assert json.loads(archive.read("front.json")) == sketched.FRONT


def test_the_service_and_the_library_make_the_same_tree(client: httpx.Client, tree: dict[str, Any]) -> None:
    by_library = treestroke.sketch(sketched.FRONT, sketched.SIDE, sketched.QUICK)
    assert client.get(tree["files"]["tree.glb"]).content == by_library.glb
    assert tree["score"] == by_library.report["score"]


def test_the_same_sketches_are_answered_at_once_in_either_form(client: httpx.Client, tree: dict[str, Any]) -> None:
    files = {view: json.dumps(sketch).encode() for view, sketch in BOTH.items()}
    for answer in (asked(client, json=sketched.request()), asked(client, **form(**files))):
        told = answer.json()
        assert (answer.status_code, told["status"]) == (200, "succeeded")
        tags = [client.get(one["files"]["tree.glb"]).headers["etag"] for one in (told, tree)]
        assert tags[0] == tags[1]


def test_front_and_side_exchanged_are_another_tree(client: httpx.Client) -> None:
    exchanged = {"front": sketched.SIDE, "side": sketched.FRONT}
    answer = asked(client, json=sketched.request(sketches=exchanged))
    assert answer.status_code == 202
    client.post(f"{answer.headers['location']}/cancel")


def test_a_key_gives_the_first_model_and_no_other_request(client: httpx.Client) -> None:
    first, again = (asked(client, "sketched", json=sketched.request()) for _ in range(2))
    assert first.json()["id"] == again.json()["id"]
    other = asked(client, "sketched", json=sketched.request(sketches={"front": sketched.FRONT}))
    assert (other.status_code, other.json()["code"]) == (422, "idempotency_key_reused")


def test_one_picture_alone_makes_a_tree_that_says_what_was_assumed(service: Service) -> None:
    picture = sketched.png(sketched.FRONT, note="secret")
    told = service.finished(asked(service.client, **form(front=picture)))
    assert told["status"] == "succeeded", told
    assert "side_assumed" in [warning["code"] for warning in told["report"]["warnings"]]
    stored = service.client.get(told["files"]["front.png"])
    assert stored.headers["content-type"] == "image/png"
    assert b"secret" not in stored.content


def test_sketches_over_a_stored_photo_outlive_it(service: Service) -> None:
    photo = service.add_photo(drawn.encoded(seed=31))
    told = service.make(**sketched.request(photo=photo, fruit=base64.b64encode(sketched.berry()).decode()))
    assert (told["status"], told["photo"]) == ("succeeded", photo)
    service.client.delete(f"/v1/photos/{photo}")
    with zipfile.ZipFile(io.BytesIO(service.client.get(told["files"]["project"]).content)) as archive:
        names = ["photo.png", "front.json", "side.json", "settings.json", "fruit.png"]
        assert archive.namelist() == names
        assert archive.read("fruit.png") == sketched.berry()


def test_a_photo_that_came_along_lends_its_colours_to_sketches(service: Service) -> None:
    files = {"photo": drawn.encoded(seed=32), "front": json.dumps(sketched.FRONT).encode()}
    told = service.finished(asked(service.client, **form(**files)))
    assert told["status"] == "succeeded", told
    assert told["photo"].startswith("pho_")
    assert "strokes.json" not in told["files"]


def test_a_side_gives_a_photo_its_depth(service: Service, photo: str, made: dict[str, Any]) -> None:
    told = service.make(**drawn.request(photo, sketches={"side": sketched.SIDE}))
    assert told["status"] == "succeeded", told
    assert set(told["files"]) == {"tree.glb", "preview.png", "strokes.json", "side.json", "project"}
    trees = [hashlib.sha256(service.client.get(one["files"]["tree.glb"]).content).digest() for one in (told, made)]
    assert trees[0] != trees[1]


def test_a_deleted_model_of_sketches_is_restored_with_them(service: Service) -> None:
    client, told = service.client, service.make(**sketched.request(seed=5))
    place = f"/v1/models/{told['id']}"
    assert client.delete(place).status_code == 204
    assert client.get(told["files"]["front.json"]).status_code == 404
    assert client.post(f"{place}/restore").json()["files"] == told["files"]
    assert client.get(told["files"]["front.json"]).json() == sketched.FRONT


@pytest.mark.parametrize(
    ("request_", "pointer", "code"),
    [
        ({"sketches": {}}, "/photo", "missing_key"),
        ({"sketches": {"side": sketched.SIDE}}, "/sketches/front", "missing_key"),
        ({"strokes": drawn.STROKES, "sketches": BOTH}, "/strokes", "strokes_and_sketch"),
        ({"photo": "p" * 41, "sketches": BOTH}, "/photo", "wrong_type"),
        ({"sketches": {"front": {"picture": "aGVsbG8="}}}, "/sketches/front/picture", "sketch_unreadable"),
        ({"sketches": {**BOTH, "back": {}}}, "/sketches/back", "unknown_key"),
        (
            {"sketches": {"front": {"branches": [{"points": [[9, 9], [9, 9]]}]}}},
            "/sketches/front/branches/0",
            "stroke_too_short",
        ),
    ],
)
def test_any_other_combination_is_one_problem_and_nothing_is_kept(
    service: Service, request_: dict[str, Any], pointer: str, code: str
) -> None:
    before = service.stored()
    answer = asked(service.client, json=request_)
    told = answer.json()
    assert (answer.status_code, told["code"]) == (422, code), told
    assert [fault["pointer"] for fault in told["errors"]] == [pointer]
    assert service.stored() == before


def test_a_sketch_that_does_not_fit_its_photo_is_refused(client: httpx.Client, photo: str) -> None:
    wide = {**sketched.FRONT, "canvas": [400, 240]}
    told = asked(client, json=sketched.request(photo=photo, sketches={"front": wide})).json()
    assert (told["code"], told["errors"][0]["pointer"]) == ("canvas_mismatch", "/sketches/front")


def test_a_photo_that_there_is_not_is_not_found(client: httpx.Client) -> None:
    answer = asked(client, json=sketched.request(photo="pho_0a1b2c3d4e5f60718293a4b5"))
    assert (answer.status_code, answer.json()["code"]) == (404, "photo_not_found")


@pytest.mark.parametrize(
    ("parts", "status"),
    [
        ({"front": b"{"}, 400),
        ({"front": b"{}"}, 422),
        ({"front": b"[" * 300_000}, 400),
        ({"side": json.dumps(sketched.SIDE).encode()}, 422),
        ({"photo": drawn.encoded(), "side": json.dumps(sketched.SIDE).encode()}, 422),
        ({"front": json.dumps(sketched.FRONT).encode(), "fruit": b"no PNG"}, 422),
        ({"photo": b"no photo", "front": json.dumps(sketched.FRONT).encode()}, 422),
        ({}, 422),
    ],
)
def test_a_form_that_is_refused_leaves_no_row(service: Service, parts: dict[str, bytes], status: int) -> None:
    before = service.rows("photos"), service.rows("models")
    answer = asked(service.client, **(form(**parts) if parts else {"files": {"name": (None, b"x")}}))
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert (service.rows("photos"), service.rows("models")) == before
