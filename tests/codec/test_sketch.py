import base64
import io
import json
import struct
import zlib

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image
from tests.sketches import ARMS, SIZE, TRUNK, picture, sketch

from treestroke.codec.sketch import encode_sketch, parse_sketch, sketch_from
from treestroke.core.errors import StrokesError

GOOD = {"branches": [{"points": [[50, 95], [50, 5]], "width": 4}], "canvas": [100, 120]}
CROWN = {"points": [[10, 10], [90, 10], [90, 60], [10, 60]]}


def png(pixels: np.ndarray) -> bytes:
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, format="PNG")
    return out.getvalue()


def drawn(crown_gap: int = 0, crown: bool = True) -> np.ndarray:
    """Draw a tree in black on white (h, w, 3), a red ring of 250 px round its upper half."""
    pixels = np.repeat(picture(sketch(TRUNK, *ARMS), 3)[..., None], 3, axis=2)
    if crown:
        end = 360 - np.degrees(crown_gap / 250)
        cv2.ellipse(pixels, (450, 400), (250, 250), 20, 0, end, (255, 0, 0), 4, cv2.LINE_AA)
    return pixels


def test_lines_come_back_as_they_were() -> None:
    one = sketch(TRUNK, *ARMS, widths=(30,), crown=CROWN["points"])
    again = parse_sketch(encode_sketch(one), "sketch")
    assert again.canvas == SIZE
    assert again.crown is not None
    assert again.crown.points.tolist() == CROWN["points"]
    assert [b.points.tolist() for b in again.branches] == [b.points.tolist() for b in one.branches]
    assert [b.width for b in again.branches] == [30, None, None, None]


def test_a_crown_and_a_canvas_may_be_absent() -> None:
    read = sketch_from({"branches": [{"points": [[100, 400], [200, 20]]}]})
    assert read.crown is None
    assert read.canvas == (205, 419)


@pytest.mark.parametrize(
    ("value", "code", "pointer"),
    [
        ([], "wrong_type", ""),
        ({}, "trunk_missing", "/branches"),
        ({**GOOD, "erase": []}, "unknown_key", "/erase"),
        ({**GOOD, "scale": None}, "unknown_key", "/scale"),
        ({**GOOD, "picture": ""}, "unknown_key", "/branches"),
        ({**GOOD, "crown": {"points": [[1]]}}, "wrong_type", "/crown/points/0"),
        ({**GOOD, "branches": [{"points": [[1, 2], ["3", 4]]}]}, "wrong_type", "/branches/0/points/1"),
        ({**GOOD, "branches": GOOD["branches"] * 200}, "too_many_strokes", ""),
        ({**GOOD, "canvas": [100]}, "canvas_invalid", "/canvas"),
        ({**GOOD, "canvas": [100, 12.5]}, "canvas_invalid", "/canvas"),
        ({**GOOD, "canvas": [100, True]}, "canvas_invalid", "/canvas"),
        ({**GOOD, "canvas": [15, 100]}, "canvas_invalid", "/canvas"),
        ({**GOOD, "canvas": [100, 16385]}, "canvas_invalid", "/canvas"),
        ({**GOOD, "canvas": "A4"}, "wrong_type", "/canvas"),
        ({"branches": [{"points": [[1, 2], [3e9, 4]]}]}, "canvas_invalid", "/branches"),
        ({"picture": 5}, "wrong_type", "/picture"),
        ({"picture": "§"}, "sketch_unreadable", "/picture"),
        ({"picture": "\ud800"}, "wrong_type", "/picture"),
        ({**GOOD, "canvas": None}, "canvas_invalid", "/canvas"),
        ({"branches": [{"points": [[5, 5]]}]}, "stroke_too_short", "/branches/0"),
        ({"branches": [{"points": [[5, 5], [6, 6]], "width": 0}]}, "width_invalid", "/branches/0/width"),
        ({"picture": "AAAA"}, "sketch_unreadable", "/picture"),
    ],
)
def test_a_malformed_part_is_refused_by_name(value: object, code: str, pointer: str) -> None:
    with pytest.raises(StrokesError) as refused:
        parse_sketch(json.dumps(value).encode(), "front.json")
    assert (refused.value.code, refused.value.pointer) == (code, pointer)
    assert str(refused.value).startswith("front.json: ")


@pytest.mark.parametrize("data", [b"", b"{", b"\xff\xd8\xff", b"[" * 100_000, b"GIF89a"])
def test_what_is_neither_png_nor_json_is_refused(data: bytes) -> None:
    with pytest.raises(StrokesError, match=r"^front: the sketch is neither PNG nor JSON") as refused:
        parse_sketch(data, "front")
    assert refused.value.code == "malformed_json"


def test_dark_strokes_on_light_ground_are_ink() -> None:
    ink = parse_sketch(png(drawn(crown=False)), "front").ink
    assert ink is not None
    assert np.array_equal(ink, drawn(crown=False)[..., 0] < 128)


def test_light_strokes_on_dark_ground_are_ink() -> None:
    ink = parse_sketch(png(255 - drawn(crown=False)), "front").ink
    assert ink is not None
    assert abs(int(ink.sum()) - int((drawn(crown=False)[..., 0] < 128).sum())) < 0.02 * ink.sum()


def test_opaque_strokes_on_clear_ground_are_ink_of_any_colour() -> None:
    plain = drawn(crown=False)[..., 0]
    pixels = np.full((*plain.shape, 4), 255, dtype=np.uint8)
    pixels[..., 3] = 255 - plain
    read = parse_sketch(png(pixels), "front")
    assert read.ink is not None
    assert np.array_equal(read.ink, plain < 128)
    assert read.canvas == SIZE


@pytest.mark.parametrize("gap", [0, 8, 30])
def test_a_red_line_is_the_crown_even_with_a_small_gap(gap: int) -> None:
    crown = parse_sketch(png(drawn(gap)), "front").crown
    assert crown is not None
    away = np.abs(np.linalg.norm(crown.points - [450.5, 400.5], axis=1) - 250)
    assert np.median(away) < 1.5
    assert away.max() < 6


def test_the_crowns_line_is_no_ink_and_ink_goes_on_beneath_it() -> None:
    with_crown, without = (parse_sketch(png(drawn(crown=one)), "front").ink for one in (True, False))
    assert with_crown is not None
    assert without is not None
    count = cv2.connectedComponents(with_crown.astype(np.uint8))[0] - 1
    assert count == 1
    beside = with_crown & ~cv2.dilate(without.astype(np.uint8), np.ones((7, 7))).astype(bool)
    assert np.count_nonzero(beside) < 0.02 * np.count_nonzero(without)


def test_a_crown_that_is_not_closed_is_refused() -> None:
    with pytest.raises(StrokesError, match="the red line is not closed") as refused:
        parse_sketch(png(drawn(500)), "front")
    assert (refused.value.code, refused.value.pointer) == ("crown_open", "/crown")


def test_an_empty_picture_is_refused() -> None:
    for empty in (np.full((64, 64, 3), 255, np.uint8), np.zeros((64, 64, 4), np.uint8), np.zeros((64, 64), np.uint8)):
        with pytest.raises(StrokesError, match="shows no strokes") as refused:
            parse_sketch(png(empty), "front")
        assert refused.value.code == "sketch_empty"


def test_a_picture_comes_as_base_64_too() -> None:
    read = sketch_from({"picture": base64.b64encode(png(drawn())).decode()})
    assert read.ink is not None
    assert read.crown is not None


def test_a_pictures_size_is_judged_from_its_header() -> None:
    for width, height in ((15, 100), (16385, 20), (10_000, 10_000), (2**31 - 1, 2**31 - 1)):
        header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
        chunk = b"IHDR" + header
        data = b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + chunk + struct.pack(">I", zlib.crc32(chunk))
        with pytest.raises(StrokesError) as refused:
            parse_sketch(data, "front")
        assert refused.value.code in ("sketch_size", "sketch_unreadable")


@pytest.mark.parametrize("mode", ["1", "L", "LA", "P", "RGB", "RGBA", "I;16"])
def test_any_mode_of_png_is_read(mode: str) -> None:
    grey = Image.fromarray(drawn(crown=False)[..., 0])
    image = Image.fromarray(np.asarray(grey).astype(np.uint16) * 257) if mode == "I;16" else grey.convert(mode)
    out = io.BytesIO()
    image.save(out, format="PNG")
    ink = parse_sketch(out.getvalue(), "front").ink
    assert ink is not None
    assert 0.005 < ink.mean() < 0.02


@settings(deadline=None)
@given(st.binary(max_size=200), st.integers(0, 400))
def test_a_damaged_picture_is_read_or_refused_but_never_breaks(junk: bytes, at: int) -> None:
    whole = png(picture(sketch([[30, 60], [30, 5]], size=(64, 64)), 3))
    try:
        parse_sketch(whole[: max(at, 8)] + junk, "front")
    except StrokesError as error:
        assert "\n" not in str(error)


json_values = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["crown", "branches", "canvas", "picture", "points", "width"]), inner)
    ),
    max_leaves=8,
)


@given(json_values)
def test_any_json_is_read_or_refused_but_never_breaks(value: object) -> None:
    try:
        sketch_from(value)
    except StrokesError as error:
        assert "\n" not in str(error)


def test_a_picture_has_no_lines_to_write() -> None:
    with pytest.raises(ValueError, match="picture"):
        encode_sketch(parse_sketch(png(drawn()), "front"))
