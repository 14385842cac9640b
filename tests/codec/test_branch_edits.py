import json
from typing import Any

import pytest

from treestroke.codec.branch_edits import encode_edits, parse_edits
from treestroke.core.errors import StrokesError
from treestroke.core.skeleton.branch_edits import Add, Join, Move, Remove, SetRadius
from treestroke.limits import MAX_EDIT_POINTS, MAX_EDITS

HERE, THERE = [0.1, 2, -3.5], [1, 1e-3, 0]
EDITS: list[dict[str, Any]] = [
    {"do": "remove", "at": HERE},
    {"do": "add", "from": HERE, "points": [THERE, HERE], "radius": 0.2},
    {"do": "add", "from": HERE, "points": [THERE]},
    {"do": "move", "at": HERE, "to": THERE},
    {"do": "radius", "at": HERE, "radius": 2},
    {"do": "join", "at": HERE, "to": THERE},
]


def test_edits_come_back_as_they_were() -> None:
    found = parse_edits(json.dumps({"edits": EDITS}), "edits.json")
    assert [type(edit) for edit in found] == [Remove, Add, Add, Move, SetRadius, Join]
    assert json.loads(encode_edits(found)) == {"edits": EDITS}
    assert encode_edits(parse_edits(encode_edits(found), "x")) == encode_edits(found)


@pytest.mark.parametrize(
    ("edit", "code", "pointer"),
    [
        ({"do": "prune", "at": HERE}, "edit_unknown", "/edits/0"),
        ({"at": HERE}, "edit_unknown", "/edits/0"),
        ([], "wrong_type", "/edits/0"),
        ({"do": "remove"}, "missing_key", "/edits/0/at"),
        ({"do": "remove", "at": [1, 2]}, "wrong_type", "/edits/0/at"),
        ({"do": "remove", "at": [1, "2", 3]}, "wrong_type", "/edits/0/at"),
        ({"do": "remove", "at": [1, 2e9, 3]}, "wrong_type", "/edits/0/at"),
        ({"do": "remove", "at": HERE, "to": THERE}, "unknown_key", "/edits/0/to"),
        ({"do": "add", "from": HERE}, "missing_key", "/edits/0"),
        ({"do": "add", "from": HERE, "points": []}, "stroke_too_short", "/edits/0"),
        ({"do": "add", "from": HERE, "points": [[1, 2]]}, "wrong_type", "/edits/0/points/0"),
        ({"do": "add", "from": HERE, "points": [HERE] * (MAX_EDIT_POINTS + 1)}, "too_many_points", "/edits/0"),
        ({"do": "add", "start": HERE, "points": [HERE]}, "unknown_key", "/edits/0/start"),
        ({"do": "radius", "at": HERE, "radius": 0}, "radius_invalid", "/edits/0/radius"),
        ({"do": "radius", "at": HERE, "radius": "wide"}, "radius_invalid", "/edits/0/radius"),
        ({"do": "move", "at": HERE, "to": None}, "wrong_type", "/edits/0/to"),
    ],
)
def test_faults_are_told_by_code_and_place(edit: Any, code: str, pointer: str) -> None:
    with pytest.raises(StrokesError) as refused:
        parse_edits(json.dumps({"edits": [edit]}), "edits.json")
    assert (refused.value.code, refused.value.pointer) == (code, pointer)
    assert str(refused.value).startswith("edits.json: ")


def test_there_are_not_too_many_edits() -> None:
    with pytest.raises(StrokesError, match=f"there are {MAX_EDITS + 1}, at most {MAX_EDITS}") as refused:
        parse_edits(json.dumps({"edits": EDITS[:1] * (MAX_EDITS + 1)}), "edits.json")
    assert (refused.value.code, refused.value.pointer) == ("too_many_edits", "/edits")
    with pytest.raises(StrokesError, match="edits"):
        parse_edits("{}", "edits.json")
