import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.api import drawn

from treestroke.core.errors import StrokesError, TreestrokeError
from treestroke.service import tracing
from treestroke.store.blobs import Blobs


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    blob, width, height = tracing.keep_photo(tmp_path, drawn.encoded())
    assert (width, height) == (drawn.WIDTH, drawn.HEIGHT)
    return Blobs(tmp_path).path(blob)


def body(**request: Any) -> bytes:
    return json.dumps(request).encode()


def test_one_more_stroke_is_answered_from_what_is_known(photo: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = json.loads(tracing.trace_answer(photo, body(crown=drawn.STROKES["crown"])))
    photo.unlink()  # it is remembered
    second = json.loads(tracing.trace_answer(photo, body(**drawn.STROKES)))
    assert second["foliage"] == first["foliage"]
    assert second["skeleton"]["points"]


def test_the_photos_that_were_used_longest_ago_are_forgotten(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tracing, "_KEPT_PIXELS", 2.5 * drawn.WIDTH * drawn.HEIGHT)
    monkeypatch.setattr(tracing, "_known", type(tracing._known)())
    photos = [Blobs(tmp_path).path(tracing.keep_photo(tmp_path, drawn.encoded(seed=seed))[0]) for seed in range(3)]
    for at in (0, 1, 0, 2):
        tracing.check_wish(photos[at], json.dumps(drawn.STROKES).encode())
    assert list(tracing._known) == [photos[0], photos[2]]


def test_a_wish_comes_out_the_same_from_json_and_from_a_form() -> None:
    settings = {"height": 12, "iterations": 7}
    whole = tracing.read_wish(body(photo="pho_1", strokes=drawn.STROKES, settings=settings, seed=3, name="Oak"))
    form = tracing.read_fields(
        {
            "strokes": json.dumps(drawn.STROKES).encode(),
            "settings": json.dumps(settings).encode(),
            "seed": b"3",
            "name": b"Oak",
        }
    )
    assert (form.strokes, form.settings, form.seed, form.name) == (whole.strokes, whole.settings, 3, "Oak")
    assert json.loads(whole.strokes) == {**drawn.STROKES, "erase": []}
    assert whole.settings["height"] == 12.0
    assert whole.settings["leaf_size"] == 1.0


def test_empty_fields_of_a_form_are_absent_ones() -> None:
    wish = tracing.read_fields(
        {"strokes": json.dumps(drawn.STROKES).encode(), "settings": b" ", "seed": b"", "name": b""}
    )
    assert (wish.seed, wish.name, wish.settings["iterations"]) == (0, "", 300)


@pytest.mark.parametrize(
    ("read", "pointer"),
    [
        (lambda: tracing.read_wish(body(photo="p", strokes={})), "/strokes/crown"),
        (lambda: tracing.read_wish(body(photo="p", strokes=drawn.STROKES, settings={"a~/b": 1})), "/settings/a~0~1b"),
        (lambda: tracing.read_wish(body(photo="p", strokes=drawn.STROKES, **{"x/y": 1})), "/x~1y"),
        (lambda: tracing.read_fields({"strokes": b"null"}), "/strokes"),
        (lambda: tracing.read_fields({}), "/strokes"),
        (lambda: tracing.read_name(b"{}"), "/name"),
        (lambda: tracing.read_name(b'{"name": "a", "b": 1}'), "/b"),
    ],
)
def test_a_pointer_leads_from_the_whole_request(read: Callable[[], object], pointer: str) -> None:
    with pytest.raises(TreestrokeError) as caught:
        read()
    assert caught.value.pointer == pointer


def test_strokes_are_checked_against_the_photo(photo: Path) -> None:
    beside = {**drawn.STROKES, "branches": [{"points": [[5, 235], [5, 238]]}]}
    with pytest.raises(StrokesError) as caught:
        tracing.check_wish(photo, json.dumps(beside).encode())
    assert (caught.value.code, caught.value.pointer) == ("trunk_outside_crown", "/strokes/branches/0")


@pytest.mark.parametrize("text", [b"[" * 3_000_000, b'{"a":[' + b"1," * 5_000_000 + b"1]}", b"{" * 300_000])
def test_more_than_the_longest_strokes_need_is_not_even_parsed(text: bytes) -> None:
    with pytest.raises(StrokesError) as caught:
        tracing.read_wish(text)
    assert caught.value.code == "too_many_points"


@pytest.mark.parametrize("name", ["", "Oak", "👨‍👩‍👧", "樫の　木", "a\u00a0b", "n" * 200])
def test_a_line_of_text_is_a_name(name: str) -> None:
    assert tracing.check_name(name) == name


@pytest.mark.parametrize("name", ["a\nb", "a\n", "\0", "\x85", "\u2028", "\u202e", "\ud800", "n" * 201, 5, None])
def test_anything_else_is_none(name: object) -> None:
    with pytest.raises(TreestrokeError, match="one line"):
        tracing.check_name(name)
