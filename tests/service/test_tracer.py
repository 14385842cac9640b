import json
from pathlib import Path
from typing import Any

import pytest
from tests.api import drawn, sketched

from treestroke.codec.sketch import sketch_from
from treestroke.codec.strokes import strokes_from
from treestroke.core.errors import PhotoError, StrokesError, TreestrokeError
from treestroke.service import tracer
from treestroke.service.model_request import Drawing

MB = 10**6
STROKES = strokes_from(drawn.STROKES)
FRONT, SIDE = (sketch_from(sketch) for sketch in (sketched.FRONT, sketched.SIDE))


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    return written(tmp_path, drawn.encoded())


def written(folder: Path, content: bytes) -> Path:
    """Have a photo read, and give its file the name of a blob."""
    told = tracer.read_photo(folder / "photo", content, MB, MB)
    assert (told["width"], told["height"], told["warnings"]) == (drawn.WIDTH, drawn.HEIGHT, [])
    assert (folder / "photo").stat().st_size == told["bytes"]
    return (folder / "photo").rename(folder / told["blob"])


@pytest.mark.parametrize(
    ("most", "room", "refusal"), [(1000, MB, PhotoError), (MB, 1000, tracer.NoRoom), (MB, -1, tracer.NoRoom)]
)
def test_a_photo_that_takes_too_much_is_not_written(
    tmp_path: Path, most: int, room: int, refusal: type[Exception]
) -> None:
    with pytest.raises(refusal):
        tracer.read_photo(tmp_path / "photo", drawn.encoded(), most, room)
    assert list(tmp_path.iterdir()) == []


def body(**request: Any) -> bytes:
    return json.dumps(request).encode()


def test_one_more_stroke_is_answered_from_what_is_known(photo: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = json.loads(tracer.trace_answer(photo, body(crown=drawn.STROKES["crown"])))
    photo.unlink()  # it is remembered
    second = json.loads(tracer.trace_answer(photo, body(**drawn.STROKES)))
    assert second["foliage"] == first["foliage"]
    assert second["skeleton"]["points"]


@pytest.mark.parametrize(
    ("bound", "most"),
    [("_KEPT_PIXELS", 2.5 * drawn.WIDTH * drawn.HEIGHT), ("_KEPT_PHOTOS", 2)],
    ids=["pixels", "photos"],
)
def test_the_photos_that_were_used_longest_ago_are_forgotten(
    bound: str, most: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tracer, bound, most)
    monkeypatch.setattr(tracer, "_known", type(tracer._known)())
    photos = [written(tmp_path, drawn.encoded(seed=seed)) for seed in range(3)]
    for at in (0, 1, 0, 2):
        tracer.check_drawing(photos[at], Drawing(STROKES, {}))
    assert list(tracer._known) == [photos[0], photos[2]]


def test_strokes_are_checked_against_the_photo(photo: Path) -> None:
    beside = {**drawn.STROKES, "branches": [{"points": [[5, 235], [5, 238]]}]}
    with pytest.raises(StrokesError) as caught:
        tracer.check_drawing(photo, Drawing(strokes_from(beside), {}))
    assert (caught.value.code, caught.value.pointer) == ("trunk_outside_crown", "/strokes/branches/0")


def test_sketches_are_traced_apart_and_a_joint_knows_its_branch() -> None:
    told = json.loads(tracer.sketch_answer(body(front=sketched.FRONT, side=sketched.SIDE, rev=3)))
    assert told["rev"] == 3
    assert told["warnings"] == []
    assert [told[view]["size"] for view in ("front", "side")] == [[200, 240], [180, 240]]
    for view, given in (("front", sketched.FRONT), ("side", sketched.SIDE)):
        skeleton = told[view]["skeleton"]
        assert set(skeleton["stroke"]) == set(range(len(given["branches"])))
        assert skeleton["points"][0] == pytest.approx(given["branches"][0]["points"][0])
        assert len(told[view]["crown"]) > 2
    assert "grown" not in told


def test_one_sketch_alone_says_what_was_assumed_and_grows() -> None:
    told = json.loads(tracer.sketch_answer(body(front=sketched.FRONT, grow=True)))
    assert told["side"] is None
    assert [warning["code"] for warning in told["warnings"]] == ["side_assumed"]
    assert len(told["grown"]["points"]) > len(told["front"]["skeleton"]["points"])
    assert (told["photo"]["width"], told["photo"]["height"]) == (200, 240)


def test_what_grows_of_two_sketches_is_told_with_its_score() -> None:
    told = json.loads(tracer.sketch_answer(body(front=sketched.FRONT, side=sketched.SIDE, grow=True)))
    assert told["grown"]["photo"] == told["photo"]
    assert told["score"]["front_covered"] > 0.9
    assert told["score"]["side_covered"] > 0.9


def test_a_picture_is_traced_as_its_strokes_are() -> None:
    told = json.loads(tracer.sketch_answer(body(front=sketched.pictured(sketched.FRONT))))
    assert told["front"]["size"] == [200, 240]
    assert told["front"]["skeleton"]["points"]


@pytest.mark.parametrize(
    ("request_", "pointer"),
    [
        ({}, "/front"),
        ({"side": sketched.SIDE}, "/front"),
        ({"front": None}, "/front"),
        ({"front": {}}, "/front/branches"),
        ({"front": {"branches": []}}, "/front/branches"),
        ({"front": {**sketched.FRONT, "erase": []}}, "/front/erase"),
        ({"front": {**sketched.FRONT, "canvas": [200]}}, "/front/canvas"),
        ({"front": {"picture": 5}}, "/front/picture"),
        ({"front": {"picture": "%%%"}}, "/front/picture"),
        ({"front": {"picture": ""}}, "/front/picture"),
        ({"front": {"picture": "aGVsbG8="}}, "/front/picture"),
        ({"front": {"picture": "", "canvas": [9, 9]}}, "/front/canvas"),
        ({"front": sketched.FRONT, "side": None}, "/side"),
        ({"front": sketched.FRONT, "side": {"branches": [{"points": [[1, 1], [1, 1]]}]}}, "/side/branches/0"),
        ({"front": sketched.FRONT, "rev": "1"}, "/rev"),
        ({"front": sketched.FRONT, "grow": 1}, "/grow"),
        ({"front": sketched.FRONT, "photo": "pho_1"}, "/photo"),
    ],
)
def test_what_is_wrong_in_sketches_is_pointed_at(request_: dict[str, Any], pointer: str) -> None:
    with pytest.raises(TreestrokeError) as caught:
        tracer.sketch_answer(body(**request_))
    assert caught.value.pointer == pointer


def test_sketches_are_checked_before_they_are_accepted(photo: Path) -> None:
    tracer.check_drawing(None, Drawing(None, {"front": FRONT, "side": SIDE}))
    tracer.check_drawing(photo, Drawing(None, {"front": FRONT}))
    tracer.check_drawing(photo, Drawing(STROKES, {"side": SIDE}))
    flat = sketch_from({"branches": [{"points": [[5, 5], [5, 5]]}]})
    wide = sketch_from({**sketched.FRONT, "canvas": [400, 240]})
    for place, drawing, pointer in (
        (None, Drawing(None, {"front": flat}), "/sketches/front/branches/0"),
        (None, Drawing(None, {"front": FRONT, "side": flat}), "/sketches/side/branches/0"),
        (photo, Drawing(STROKES, {"side": flat}), "/sketches/side/branches/0"),
        (photo, Drawing(None, {"front": wide}), "/sketches/front"),
    ):
        with pytest.raises(StrokesError) as caught:
            tracer.check_drawing(place, drawing, ("sketches",))
        assert caught.value.pointer == pointer
