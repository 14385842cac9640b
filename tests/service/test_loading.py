import json
from pathlib import Path

import numpy as np
import pytest
from tests.api import sketched

from treestroke.codec.image import decode_stored, encode_stored
from treestroke.codec.inputs import Inputs
from treestroke.core.errors import FruitError, LeafError, PhotoError, StrokesError
from treestroke.core.strokes import same_stroke
from treestroke.service.loading import load_cutout, load_parts, load_photo, load_settings, load_sketch, load_strokes


def test_path_bytes_and_pixels_give_the_same_photo(maple_photo: Path) -> None:
    by_path = load_photo(maple_photo)
    assert np.array_equal(by_path, load_photo(maple_photo.read_bytes()))
    assert np.array_equal(by_path, load_photo(by_path))
    assert np.array_equal(by_path, load_photo(str(maple_photo)))


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((80, 80), np.uint8),
        np.zeros((80, 80, 2), np.uint8),
        np.zeros((80, 80, 3)),
        np.zeros((8, 8, 3), np.uint8),
    ],
)
def test_an_array_that_is_no_photo_is_refused(array: np.ndarray) -> None:
    with pytest.raises(PhotoError, match="^photo: "):
        load_photo(array)


def test_a_stored_photo_is_let_in_whatever_its_size(maple_photo: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stored = encode_stored(load_photo(maple_photo))
    monkeypatch.setattr("treestroke.codec.image.MAX_PHOTO_BYTES", len(stored) - 1)
    assert np.array_equal(load_photo(stored), decode_stored(bytes(stored)))
    with pytest.raises(PhotoError) as refused:
        load_photo(bytes(stored))
    assert refused.value.code == "photo_too_large_file"


def test_path_mapping_and_values_give_the_same_strokes(maple_strokes: Path) -> None:
    by_path = load_strokes(maple_strokes)
    mapping = {"crown": {"points": by_path.crown.points.tolist()}}
    assert np.array_equal(load_strokes(mapping).crown.points, by_path.crown.points)
    assert load_strokes(by_path) is by_path


def test_path_bytes_mapping_and_values_give_the_same_sketch(tmp_path: Path) -> None:
    path = tmp_path / "front.json"
    path.write_text(json.dumps(sketched.FRONT))
    by_path = load_sketch(path, "front")
    for given in (str(path), path.read_bytes(), sketched.FRONT):
        again = load_sketch(given, "front")
        assert again.canvas == by_path.canvas
        assert all(map(same_stroke, again.branches, by_path.branches))
    assert load_sketch(by_path, "front") is by_path


def test_a_sketch_may_be_a_picture(tmp_path: Path) -> None:
    path = tmp_path / "front.png"
    path.write_bytes(sketched.png(sketched.FRONT))
    by_path, by_mapping = load_sketch(path, "front").ink, load_sketch(sketched.pictured(sketched.FRONT), "front").ink
    assert by_path is not None
    assert np.array_equal(by_path, by_mapping)


@pytest.mark.parametrize("sketch", [{}, b"{}", b"[", {"picture": "x"}, {"branches": []}])
def test_a_sketch_that_is_none_is_refused_by_its_name(sketch: dict[str, object] | bytes) -> None:
    with pytest.raises(StrokesError, match="^side: "):
        load_sketch(sketch, "side")


def test_leaf_and_fruit_are_read_alike(tmp_path: Path) -> None:
    path = tmp_path / "berry.png"
    path.write_bytes(sketched.berry())
    assert np.array_equal(load_cutout(path, "fruit"), load_cutout(sketched.berry(), "leaf"))
    for name, refusal in (("fruit", FruitError), ("leaf", LeafError)):
        for picture in (b"no picture", tmp_path / "missing.png"):
            with pytest.raises(refusal):
                load_cutout(picture, name)


def test_all_parts_are_decoded_the_photo_last(maple_photo: Path, maple_strokes: Path) -> None:
    inputs = Inputs.of(
        {"photo": maple_photo, "strokes": maple_strokes, "side": sketched.SIDE, "leaf": sketched.berry()}
    )
    loaded = load_parts(inputs)
    assert list(loaded) == ["strokes", "side", "leaf", "photo"]
    assert np.array_equal(loaded["photo"], load_photo(maple_photo))
    assert loaded["side"].canvas == load_sketch(sketched.SIDE, "side").canvas


@pytest.mark.parametrize("path", ["missing.jpg", ".", "with\0zero"])
def test_a_path_that_cannot_be_read_is_refused(path: str) -> None:
    with pytest.raises(PhotoError):
        load_photo(path)
    with pytest.raises(StrokesError):
        load_strokes(path)
    with pytest.raises(StrokesError):
        load_sketch(path, "front")


def test_no_settings_are_the_defaults() -> None:
    assert load_settings(None) == load_settings({}) == load_settings(load_settings({"height": 10}))
