import os
import tempfile
from pathlib import Path

import numpy as np
import pytest
from tests.clips import SYNTHETIC_ASH, film, swaying

from treestroke.core.errors import ClipError
from treestroke.engines import decoding
from treestroke.engines.child import Bounds
from treestroke.engines.decoding import decode, read_footage, read_picture
from treestroke.engines.reel import Reel


@pytest.fixture(scope="module")
def clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return film(tmp_path_factory.mktemp("clips") / "a.avi", swaying(60))


def test_a_child_reads_what_this_process_reads(clip: Path) -> None:
    fractions: list[float] = []
    footage, picture = decode(clip, 7, "clip", lambda _, fraction: fractions.append(fraction))
    here = read_footage(clip)
    assert footage.frames.shape == (60, 120, 160)
    assert (footage.frames == here.frames).all()
    assert (footage.frames_per_second, footage.size_px, footage.notes) == (30.0, (160, 120), ())
    assert (picture == read_picture(Reel(clip), 7)).all()
    assert fractions == sorted(fractions)


def test_the_chosen_frame_has_the_colours_of_the_picture(clip: Path) -> None:
    _, picture = decode(clip, 59, "clip")
    assert np.abs(picture.astype(int) - swaying(60)[59][..., ::-1]).mean() < 6


def test_the_synthetic_ash_is_read() -> None:
    footage, picture = decode(SYNTHETIC_ASH, 0, "clip")
    assert footage.frames.shape == (120, 480, 640)
    assert picture.shape == (480, 640, 3)


@pytest.mark.parametrize(
    ("count", "rate", "code"), [(1, 30.0, "clip_picture"), (23, 10.0, "clip_short"), (24, 30.0, "clip_short")]
)
def test_short_clips_are_refused(tmp_path: Path, count: int, rate: float, code: str) -> None:
    with pytest.raises(ClipError) as refusal:
        read_footage(film(tmp_path / "a.avi", swaying(count), rate))
    assert refusal.value.code == code


def test_a_frame_that_is_not_there_is_named(clip: Path) -> None:
    with pytest.raises(ClipError, match="there is no frame 60, the clip has 60") as refusal:
        decode(clip, 60, "clip")
    assert (refusal.value.code, refusal.value.pointer) == ("frame_missing", "/frame")


@pytest.mark.parametrize(
    ("bounds", "said"), [(Bounds(0.05, 2**32), "takes too long"), (Bounds(60.0, 2**28), "memory|cannot be decoded")]
)
def test_a_decoding_beyond_its_bounds_is_ended(
    clip: Path, bounds: Bounds, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(decoding, "DECODE_BOUNDS", bounds)
    with pytest.raises(ClipError, match=said):
        decode(clip, 0, "clip")


def test_no_file_is_left_behind(clip: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    footage = read_footage(clip)
    assert os.listdir(tmp_path) == []
    assert footage.frames[59].any()
