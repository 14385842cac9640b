from pathlib import Path

import numpy as np
import pytest

from treestroke.codec.image import decode_stored, encode_stored
from treestroke.core.errors import PhotoError, StrokesError
from treestroke.service.inputs import load_photo, load_settings, load_strokes


def test_path_bytes_and_pixels_give_the_same_photo(maple_photo: Path) -> None:
    by_path = load_photo(maple_photo)
    assert np.array_equal(by_path, load_photo(maple_photo.read_bytes()))
    assert np.array_equal(by_path, load_photo(by_path))
    assert np.array_equal(by_path, load_photo(str(maple_photo)))


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((80, 80), np.uint8),
        np.zeros((80, 80, 4), np.uint8),
        np.zeros((80, 80, 3)),
        np.zeros((8, 8, 3), np.uint8),
    ],
)
def test_an_array_that_is_no_photo_is_refused(array: np.ndarray) -> None:
    with pytest.raises(PhotoError, match="^photo: "):
        load_photo(array)


def test_a_stored_photo_is_let_in_whatever_its_size(maple_photo: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stored = encode_stored(load_photo(maple_photo))
    monkeypatch.setattr("treestroke.codec.image.MAX_BYTES", len(stored) - 1)
    assert np.array_equal(load_photo(stored), decode_stored(bytes(stored)))
    with pytest.raises(PhotoError) as refused:
        load_photo(bytes(stored))
    assert refused.value.code == "photo_too_large_file"


def test_path_mapping_and_values_give_the_same_strokes(maple_strokes: Path) -> None:
    by_path = load_strokes(maple_strokes)
    mapping = {"crown": {"points": by_path.crown.points.tolist()}}
    assert np.array_equal(load_strokes(mapping).crown.points, by_path.crown.points)
    assert load_strokes(by_path) is by_path


@pytest.mark.parametrize("path", ["missing.jpg", ".", "with\0zero"])
def test_a_path_that_cannot_be_read_is_refused(path: str) -> None:
    with pytest.raises(PhotoError):
        load_photo(path)
    with pytest.raises(StrokesError):
        load_strokes(path)


def test_no_settings_are_the_defaults() -> None:
    assert load_settings(None) == load_settings({}) == load_settings(load_settings({"height": 10}))
