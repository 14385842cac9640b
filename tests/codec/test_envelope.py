"""Tests of the outlines that siblings fill, as files."""

import io
import json

import numpy as np
import pytest
from PIL import Image, ImageDraw

from treestroke.codec.envelope import encode_envelope, envelope_from, parse_envelope
from treestroke.core.errors import EnvelopeError
from treestroke.core.siblings.outlines import SHAPES

SQUARE = [[0, 0], [10, 0], [10, 10], [0, 10]]


def picture(mode: str, ground: tuple[int, ...], ink: tuple[int, ...], box: tuple[int, int, int, int]) -> bytes:
    """Draw an ellipse and a small dot on a ground, as PNG."""
    image = Image.new(mode, (120, 100), ground)
    draw = ImageDraw.Draw(image)
    draw.ellipse(box, fill=ink)
    draw.ellipse((2, 2, 8, 8), fill=ink)
    out = io.BytesIO()
    image.save(out, "PNG")
    return out.getvalue()


@pytest.mark.parametrize("name", SHAPES)
def test_a_name_is_an_outline(name: str) -> None:
    assert np.array_equal(envelope_from(name).points, SHAPES[name])


def test_points_and_the_crown_of_strokes_are_outlines() -> None:
    for value in ({"points": SQUARE}, {"crown": {"points": SQUARE}, "branches": []}):
        assert parse_envelope(json.dumps(value).encode(), "square.json").points.tolist() == SQUARE


def test_an_outline_is_read_back_as_it_was_written() -> None:
    envelope = envelope_from({"points": SQUARE, "on_ground": True})
    again = parse_envelope(encode_envelope(envelope), "again")
    assert again.on_ground
    assert np.array_equal(again.points, envelope.points)


@pytest.mark.parametrize(
    "shown",
    [
        picture("RGB", (255, 255, 255), (20, 20, 20), (30, 10, 90, 70)),
        picture("RGBA", (255, 255, 255, 0), (200, 250, 200, 255), (30, 10, 90, 70)),
    ],
    ids=["dark", "opaque"],
)
def test_the_largest_shape_of_a_picture_is_its_outline(shown: bytes) -> None:
    envelope = parse_envelope(shown, "shape.png")
    assert envelope.points.min(axis=0) == pytest.approx([30, 10], abs=1.5)
    assert envelope.points.max(axis=0) == pytest.approx([90, 70], abs=1.5)
    assert not envelope.on_ground


def test_a_shape_at_the_picture_s_lower_edge_stands_on_the_ground() -> None:
    assert parse_envelope(picture("RGB", (255, 255, 255), (0, 0, 0), (30, 30, 90, 110)), "shape.png").on_ground


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"{}", "no points"),
        (b"nothing", "JSON or PNG"),
        (b'{"points": [[0, 0], [1, 1], [2, 2], [3, 3]]}', "next to nothing"),
        (b"\x89PNG broken", "readable PNG"),
        (picture("RGB", (255, 255, 255), (250, 250, 250), (30, 10, 90, 70)), "no shape"),
    ],
)
def test_what_is_no_outline_is_refused_with_its_name(data: bytes, said: str) -> None:
    with pytest.raises(EnvelopeError, match=said) as refused:
        parse_envelope(data, "shape.png")
    assert str(refused.value).startswith("shape.png")


def test_an_unknown_name_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(EnvelopeError, match="heart, triangle, circle, pentagon"):
        envelope_from("star")
