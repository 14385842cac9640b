import json
from typing import Any

import pytest

from treestroke.codec.capture_strokes import capture_strokes_from, parse_capture_strokes
from treestroke.core.errors import StrokesError
from treestroke.core.strokes import CameraDistance, LengthInPhoto

CROWN = {"points": [[10, 10], [90, 10], [90, 60], [10, 60]]}
TRUNK = {"points": [[50, 95], [50, 60]], "width": 4}
FRONT = {"photo": "b.jpg", "crown": CROWN, "branches": [TRUNK]}
BESIDE = {"photo": "a.jpg", "crown": CROWN, "erase": [{"points": [[1, 2], [3, 4]]}]}
LINE = {"photo": "a.jpg", "points": [[1, 2], [3, 4]], "metres": 1.8}


def test_views_keep_their_photos_and_order() -> None:
    drawn = capture_strokes_from({"views": [BESIDE, FRONT]})
    assert list(drawn.by_photo) == ["a.jpg", "b.jpg"]
    assert drawn.by_photo["b.jpg"].branches[0].width == 4.0
    assert drawn.by_photo["a.jpg"].erase[0].points.tolist() == [[1, 2], [3, 4]]
    assert drawn.scale is None


def test_the_front_is_the_first_view_with_a_trunk() -> None:
    assert capture_strokes_from({"views": [BESIDE, FRONT]}).first == "b.jpg"


def test_the_scale_is_a_drawn_length_or_a_distance_of_cameras() -> None:
    line = capture_strokes_from({"views": [FRONT], "scale": LINE}).scale
    assert isinstance(line, LengthInPhoto)
    assert (line.photo, line.length.points.tolist(), line.length.metres) == ("a.jpg", [[1, 2], [3, 4]], 1.8)
    apart = capture_strokes_from({"views": [FRONT], "scale": {"photos": ["a.jpg", "b.jpg"], "metres": 3}}).scale
    assert apart == CameraDistance(("a.jpg", "b.jpg"), 3.0)


@pytest.mark.parametrize(
    ("value", "code", "pointer"),
    [
        ([], "wrong_type", ""),
        ({}, "missing_key", "/views"),
        ({"views": []}, "wrong_type", "/views"),
        ({"views": [FRONT], "crown": CROWN}, "unknown_key", "/crown"),
        ({"views": [{**FRONT, "crwn": CROWN}]}, "unknown_key", "/views/0/crwn"),
        ({"views": [FRONT, {"photo": "a.jpg"}]}, "crown_missing", "/views/1/crown"),
        ({"views": [FRONT, FRONT]}, "photo_twice", "/views/1/photo"),
        ({"views": [FRONT], "scale": {"photos": ["a.jpg"], "metres": 3}}, "wrong_type", "/scale/photos"),
        ({"views": [FRONT], "scale": {**LINE, "metres": -2}}, "scale_invalid", "/scale/metres"),
    ],
)
def test_faults_are_told_by_code_and_place(value: Any, code: str, pointer: str) -> None:
    with pytest.raises(StrokesError) as refused:
        parse_capture_strokes(json.dumps(value), "oak.json")
    assert (refused.value.code, refused.value.pointer) == (code, pointer)
    assert str(refused.value).startswith("oak.json: ")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("text", ["", '{"views": [', "oak"])
def test_what_is_no_json_is_refused(text: str) -> None:
    with pytest.raises(StrokesError, match=r"^oak\.json: the strokes are not valid JSON") as refused:
        parse_capture_strokes(text, "oak.json")
    assert refused.value.code == "malformed_json"
