import base64
import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.api import drawn, sketched

from treestroke.codec.sketch import parse_sketch
from treestroke.core.errors import StrokesError, TreestrokeError
from treestroke.service import model_request


def body(**request: Any) -> bytes:
    return json.dumps(request).encode()


def test_a_wish_comes_out_the_same_from_json_and_from_a_form() -> None:
    settings = {"height": 12, "iterations": 7}
    whole = model_request.read_order(body(photo="pho_1", strokes=drawn.STROKES, settings=settings, seed=3, name="Oak"))
    form = model_request.read_form(
        {
            "strokes": json.dumps(drawn.STROKES).encode(),
            "settings": json.dumps(settings).encode(),
            "seed": b"3",
            "name": b"Oak",
        }
    )
    assert (form.parts, form.settings, form.seed, form.name) == (whole.parts, whole.settings, 3, "Oak")
    assert json.loads(whole.parts["strokes"]) == {**drawn.STROKES, "erase": []}
    assert whole.settings["height"] == 12.0
    assert whole.settings["leaf_size"] == 1.0


def test_empty_fields_of_a_form_are_absent_ones() -> None:
    order = model_request.read_form(
        {"strokes": json.dumps(drawn.STROKES).encode(), "settings": b" ", "seed": b"", "name": b""}
    )
    assert (order.seed, order.name, order.settings["iterations"]) == (0, "", 300)


@pytest.mark.parametrize(
    ("read", "pointer"),
    [
        (lambda: model_request.read_order(body(photo="p", strokes={})), "/strokes/crown"),
        (
            lambda: model_request.read_order(body(photo="p", strokes=drawn.STROKES, settings={"a~/b": 1})),
            "/settings/a~0~1b",
        ),
        (lambda: model_request.read_order(body(photo="p", strokes=drawn.STROKES, **{"x/y": 1})), "/x~1y"),
        (lambda: model_request.read_form({"strokes": b"null"}), "/strokes"),
        (lambda: model_request.read_form({}), "/strokes"),
        (lambda: model_request.read_name(b"{}"), "/name"),
        (lambda: model_request.read_name(b'{"name": "a", "b": 1}'), "/b"),
    ],
)
def test_a_pointer_leads_from_the_whole_request(read: Callable[[], object], pointer: str) -> None:
    with pytest.raises(TreestrokeError) as caught:
        read()
    assert caught.value.pointer == pointer


@pytest.mark.parametrize("text", [b"[" * 3_000_000, b'{"a":[' + b"1," * 5_000_000 + b"1]}", b"{" * 300_000])
def test_more_than_the_longest_strokes_need_is_not_even_parsed(text: bytes) -> None:
    with pytest.raises(StrokesError) as caught:
        model_request.read_order(text)
    assert caught.value.code == "too_many_points"


@pytest.mark.parametrize("name", ["", "Oak", "👨‍👩‍👧", "樫の　木", "a\u00a0b", "n" * 200])
def test_a_line_of_text_is_a_name(name: str) -> None:
    assert model_request.read_name(body(name=name)) == name


@pytest.mark.parametrize("name", ["a\nb", "a\n", "\0", "\x85", "\u2028", "\u202e", "\ud800", "n" * 201, 5])
def test_anything_else_is_no_name(name: object) -> None:
    with pytest.raises(TreestrokeError, match="one line") as caught:
        model_request.read_name(body(name=name))
    assert (caught.value.code, caught.value.pointer) == ("name_invalid", "/name")


BOTH = {"front": sketched.FRONT, "side": sketched.SIDE}


@pytest.mark.parametrize(
    "request_",
    [
        {"sketches": {"front": sketched.FRONT}},
        {"sketches": BOTH},
        {"photo": "pho_1", "sketches": {"front": sketched.FRONT}},
        {"photo": "pho_1", "sketches": BOTH},
        {"photo": "pho_1", "strokes": drawn.STROKES, "sketches": {"side": sketched.SIDE}},
        {"photo": "pho_1", "strokes": drawn.STROKES, "sketches": {}},
    ],
)
def test_a_wish_holds_what_makes_a_tree_together(request_: dict[str, Any]) -> None:
    order = model_request.read_order(body(**request_))
    sketches = request_["sketches"]
    assert order.photo == request_.get("photo")
    assert order.parts.keys() == sketches.keys() | request_.keys() & {"strokes"}
    for view, sketch in sketches.items():
        assert json.loads(order.parts[view]) == sketch


@pytest.mark.parametrize(
    ("request_", "pointer", "code"),
    [
        ({}, "/photo", "missing_key"),
        ({"sketches": {}}, "/photo", "missing_key"),
        ({"photo": "p"}, "/strokes", "missing_key"),
        ({"strokes": drawn.STROKES}, "/photo", "missing_key"),
        ({"strokes": drawn.STROKES, "sketches": {"side": sketched.SIDE}}, "/photo", "missing_key"),
        ({"sketches": {"side": sketched.SIDE}}, "/sketches/front", "missing_key"),
        ({"photo": "p", "sketches": {"side": sketched.SIDE}}, "/strokes", "missing_key"),
        ({"strokes": drawn.STROKES, "sketches": BOTH}, "/strokes", "strokes_and_sketch"),
        ({"photo": "p", "strokes": drawn.STROKES, "sketches": BOTH}, "/strokes", "strokes_and_sketch"),
        ({"sketches": []}, "/sketches", "wrong_type"),
        ({"sketches": None}, "/sketches", "wrong_type"),
        ({"sketches": {**BOTH, "back": sketched.SIDE}}, "/sketches/back", "unknown_key"),
        ({"sketches": {"front": 5}}, "/sketches/front", "wrong_type"),
        ({"sketches": {"front": None}}, "/sketches/front", "wrong_type"),
        ({"photo": None, "sketches": BOTH}, "/photo", "wrong_type"),
        ({"sketches": {"front": {"picture": "A" * 33_333_338}}}, "/sketches/front/picture", "sketch_too_large_file"),
        ({"sketches": {"front": {"picture": "?"}}}, "/sketches/front/picture", "sketch_unreadable"),
        ({"sketches": {"front": {"picture": "aGVsbG8="}}}, "/sketches/front/picture", "sketch_unreadable"),
        ({"sketches": BOTH, "fruit": "aGVsbG8="}, "/fruit", "fruit_unreadable"),
        ({"sketches": BOTH, "fruit": "?"}, "/fruit", "fruit_unreadable"),
        ({"sketches": BOTH, "fruit": 5}, "/fruit", "wrong_type"),
        ({"sketches": BOTH, "leaf": "A" * 5_400_001}, "/leaf", "wrong_type"),
    ],
)
def test_any_other_combination_is_one_problem(request_: dict[str, Any], pointer: str, code: str) -> None:
    with pytest.raises(TreestrokeError) as caught:
        model_request.read_order(body(**request_))
    assert (caught.value.pointer, caught.value.code) == (pointer, code)


@pytest.mark.parametrize(
    ("fields", "brings_photo", "pointer"),
    [
        ({"front": b"{"}, False, ""),
        ({"front": b"\x89PNG\r\n\x1a\nrubbish"}, False, "/front"),
        ({"front": b"\x89PNG"}, False, ""),
        ({"side": body(**sketched.SIDE)}, False, "/front"),
        ({"side": body(**sketched.SIDE)}, True, "/strokes"),
        ({"strokes": body(**drawn.STROKES)}, False, "/photo"),
        ({"strokes": body(**drawn.STROKES), "front": body(**sketched.FRONT)}, True, "/strokes"),
        ({"front": b"[]"}, False, "/front"),
        ({"sketches": b"{}"}, False, "/sketches"),
        ({}, False, "/photo"),
        ({"front": body(**sketched.FRONT), "fruit": b"no PNG"}, False, "/fruit"),
    ],
)
def test_a_form_of_another_combination_is_refused(fields: dict[str, bytes], brings_photo: bool, pointer: str) -> None:
    with pytest.raises(TreestrokeError) as caught:
        model_request.read_form(fields, brings_photo)
    assert caught.value.pointer == pointer


def test_sketches_come_out_the_same_from_json_and_from_a_form() -> None:
    berry = sketched.berry()
    whole = model_request.read_order(body(sketches=BOTH, seed=3, fruit=base64.b64encode(berry).decode()))
    files = {"front": body(**sketched.FRONT), "side": body(**sketched.SIDE), "seed": b"3", "fruit": berry}
    form = model_request.read_form(files, brings_photo=False)
    assert (form.parts, form.seed, form.settings) == (whole.parts, whole.seed, whole.settings)
    assert (form.within, whole.within) == ((), ("sketches",))


def test_a_picture_is_kept_without_what_it_tells_of_its_maker() -> None:
    encoded = sketched.pictured(sketched.FRONT, note="secret")
    picture = base64.b64decode(encoded["picture"])
    assert b"secret" in picture
    by_json = model_request.read_order(body(sketches={"front": encoded})).parts["front"]
    by_form = model_request.read_form({"front": picture}, brings_photo=False).parts["front"]
    assert by_json == by_form
    assert b"secret" not in by_json
    kept, given = parse_sketch(by_json, "kept").ink, parse_sketch(picture, "given").ink
    assert np.array_equal(np.asarray(kept), np.asarray(given))
