import json
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from treestroke.codec.strokes import (
    encode_frame_strokes,
    encode_strokes,
    parse_frame_strokes,
    parse_strokes,
    strokes_from,
)
from treestroke.core.errors import StrokesError
from treestroke.core.strokes import same_strokes

SQUARE = [[10, 10], [90, 10], [90, 60], [10, 60]]
GOOD = {"crown": {"points": SQUARE}, "branches": [{"points": [[50, 95], [50, 60]], "width": 4}]}


def test_a_real_stroke_file_comes_back_as_it_was(maple_strokes: Path) -> None:
    read = parse_strokes(maple_strokes.read_bytes(), "strokes")
    again = parse_strokes(encode_strokes(read), "strokes")
    assert np.array_equal(read.crown.points, again.crown.points)
    assert [b.points.tolist() for b in read.branches] == [b.points.tolist() for b in again.branches]


def test_branches_and_erase_may_be_absent() -> None:
    strokes = strokes_from({"crown": {"points": SQUARE}})
    assert strokes.branches == strokes.erase == ()


def test_a_known_length_is_kept() -> None:
    strokes = strokes_from({**GOOD, "scale": {"points": [[1, 2], [3, 4]], "metres": 1.8}})
    again = parse_strokes(encode_strokes(strokes), "strokes")
    assert again.scale is not None
    assert (again.scale.points.tolist(), again.scale.metres) == ([[1, 2], [3, 4]], 1.8)
    assert strokes_from(GOOD).scale is None


def test_a_width_is_kept() -> None:
    assert strokes_from(GOOD).branches[0].width == 4.0


@pytest.mark.parametrize("crown", ["[" + "[]," * 2_300_000 + "[]]", '"' + "\N{DECIDUOUS TREE}" * 300_000 + '"'])
def test_more_than_the_longest_strokes_need_is_not_read(crown: str) -> None:
    text = f'{{"crown": {crown}}}'.encode()
    tracemalloc.start()
    with pytest.raises(StrokesError, match=r"^oak: ") as refused:
        parse_strokes(text, "oak")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert refused.value.code in ("too_many_points", "malformed_json")
    assert peak < 100_000


def test_a_byte_order_mark_is_forgiven() -> None:
    assert parse_strokes(b"\xef\xbb\xbf" + json.dumps(GOOD).encode(), "strokes").branches


@pytest.mark.parametrize(
    ("value", "where"),
    [
        ([], "strokes"),
        ({}, "crown"),
        ({**GOOD, "leaves": []}, "'leaves'"),
        ({**GOOD, "crown": SQUARE}, "crown"),
        ({**GOOD, "crown": {}}, "crown"),
        ({**GOOD, "crown": {"points": SQUARE, "width": 3}}, "'width'"),
        ({**GOOD, "branches": {}}, "branches"),
        ({**GOOD, "scale": None}, "scale"),
        ({**GOOD, "scale": {"points": [[1, 2], [3, 4]]}}, "scale: it has no metres"),
        ({**GOOD, "scale": {"points": [[1, 2], [3, 4]], "metres": "2"}}, "scale/metres"),
        ({**GOOD, "scale": {"points": [[1, 2], [3]], "metres": 2}}, "scale/points/1"),
        ({**GOOD, "scale": {"points": [[1, 2], [3, 4]], "metres": 2, "unit": "m"}}, "'unit'"),
        ({**GOOD, "branches": [{"points": [[1, 2], [3]]}]}, "branches/0/points/1"),
        ({**GOOD, "branches": [{"points": [[1, 2], ["3", 4]]}]}, "branches/0/points/1"),
        ({**GOOD, "branches": [{"points": [[1, 2], [True, 4]]}]}, "branches/0/points/1"),
        ({**GOOD, "branches": [{"points": [[1, 2], [None, 4]]}]}, "branches/0/points/1"),
        ({**GOOD, "branches": [{"points": "line"}]}, "branches/0/points"),
        ({**GOOD, "branches": [{"points": SQUARE, "width": "3"}]}, "branches/0/width"),
        ({**GOOD, "branches": [{"points": SQUARE, "colour": 1}]}, "branches/0"),
        ({**GOOD, "erase": [{"points": SQUARE, "width": 3}]}, "erase/0"),
        ({**GOOD, "erase": None}, "erase"),
    ],
)
def test_a_malformed_part_is_refused_by_name(value: object, where: str) -> None:
    with pytest.raises(StrokesError, match=where) as refused:
        parse_strokes(json.dumps(value), "oak.json")
    assert str(refused.value).startswith("oak.json: ")


@pytest.mark.parametrize("token", ["NaN", "Infinity", "-Infinity", "1e999", "1" + "0" * 400])
def test_a_number_that_is_not_finite_is_refused(token: str) -> None:
    with pytest.raises(StrokesError, match="no number|not finite"):
        parse_strokes('{"crown": {"points": [[1, 2], [3, 4], [5, TOKEN]]}}'.replace("TOKEN", token), "strokes")


def refusal(value: object) -> StrokesError:
    with pytest.raises(StrokesError) as refused:
        parse_strokes(value if isinstance(value, str | bytes) else json.dumps(value), "oak.json")
    return refused.value


@pytest.mark.parametrize(
    ("value", "code", "pointer"),
    [
        ([], "wrong_type", ""),
        ({}, "crown_missing", "/crown"),
        ({**GOOD, "le/aves": []}, "unknown_key", "/le~1aves"),
        ({**GOOD, "crown": {}}, "missing_key", "/crown"),
        ({**GOOD, "branches": [{"points": [[1, 2], [3]]}]}, "wrong_type", "/branches/0/points/1"),
        ({**GOOD, "branches": [{"points": SQUARE, "width": "3"}]}, "wrong_type", "/branches/0/width"),
        ({**GOOD, "branches": [{"points": SQUARE, "colour": 1}]}, "unknown_key", "/branches/0/colour"),
        ({**GOOD, "branches": GOOD["branches"] * 200}, "too_many_strokes", ""),
        ({**GOOD, "erase": [{"points": [[1, 1]] * 10_001}]}, "too_many_points", "/erase/0"),
        ('{"crown": {"points": [[1, NaN]]}}', "non_finite_number", "/crown/points/0"),
        ('{"crown": {"points": [[1, 2], [1e999, 0]]}}', "non_finite_number", "/crown/points/1"),
        ('{"crown": {"points": [[1, -NUMBER]]}}'.replace("NUMBER", "7" * 5000), "non_finite_number", "/crown/points/0"),
        ({**GOOD, "crown": {"points": SQUARE[:2]}}, "stroke_too_short", "/crown"),
        ({**GOOD, "scale": {"points": SQUARE, "metres": 2}}, "scale_invalid", "/scale/points"),
        ({**GOOD, "scale": {"points": SQUARE[:2], "metres": 0}}, "scale_invalid", "/scale/metres"),
        ({**GOOD, "branches": [None]}, "wrong_type", "/branches/0"),
        ({**GOOD, "crown": None}, "wrong_type", "/crown"),
        ("{", "malformed_json", ""),
        (b"\xff", "malformed_json", ""),
        ("[" * 100_000, "malformed_json", ""),
        ('{"crown": 1, "crown": 2}', "malformed_json", ""),
    ],
)
def test_a_refusal_says_what_and_where_for_programs(value: object, code: str, pointer: str) -> None:
    error = refusal(value)
    assert (error.code, error.pointer) == (code, pointer)
    assert str(error).startswith("oak.json: ")


@pytest.mark.parametrize("key", [r"\u0000", r"\ud800", r"\ud800/~", "k" * 100_000])
def test_any_key_makes_a_message_that_can_be_written(key: str) -> None:
    error = refusal('{"crown": {"points": []}, "KEY": 1}'.replace("KEY", key))
    assert error.code == "unknown_key"
    assert len(str(error).encode()) < 200
    assert error.pointer.encode()


@pytest.mark.parametrize("text", ["", "{", b"\xff\xfe\x00", "[" * 100_000, '{"crown": 1,}'])
def test_what_is_no_json_is_refused_in_one_line(text: str | bytes) -> None:
    with pytest.raises(StrokesError, match="not valid JSON") as refused:
        parse_strokes(text, "strokes")
    assert "\n" not in str(refused.value)


def test_too_many_strokes_are_refused() -> None:
    with pytest.raises(StrokesError, match="200 branches, at most 199"):
        strokes_from({**GOOD, "branches": GOOD["branches"] * 200})


def test_too_many_points_are_refused() -> None:
    with pytest.raises(StrokesError, match="branches/0: it has 10001 points"):
        strokes_from({**GOOD, "branches": [{"points": [[1, 1]] * 10_001}]})


json_values = st.recursive(
    st.none() | st.booleans() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["crown", "points", "width", "x"]), inner)
    ),
    max_leaves=8,
)


@given(json_values)
def test_any_json_is_read_or_refused_but_never_breaks(value: object) -> None:
    try:
        strokes_from(value)
    except StrokesError as error:
        assert "\n" not in str(error)


def test_strokes_over_a_frame_come_back() -> None:
    crown = {"points": [[0, 0], [9, 0], [9, 9]]}
    drawn = parse_frame_strokes(json.dumps({"frame": 12, "crown": crown}), "strokes.json")
    assert (drawn.frame, drawn.strokes.branches) == (12, ())
    again = parse_frame_strokes(encode_frame_strokes(drawn), "strokes.json")
    assert again.frame == 12
    assert same_strokes(again.strokes, drawn.strokes)
    assert parse_frame_strokes(json.dumps({"crown": crown}), "strokes.json").frame == 0


@pytest.mark.parametrize("frame", [-1, 1.5, "2", None, True, 10_000])
def test_a_frame_is_a_whole_number(frame: object) -> None:
    text = json.dumps({"frame": frame, "crown": {"points": [[0, 0], [9, 0], [9, 9]]}})
    with pytest.raises(StrokesError) as refusal:
        parse_frame_strokes(text, "strokes.json")
    assert refusal.value.pointer == "/frame"
