from pathlib import Path

import cv2
import numpy as np
import pytest
from tests.clips import SYNTHETIC_ASH, Frame, film, swaying
from tests.gifs import write_gif

from treestroke.core.errors import ClipError
from treestroke.engines.reel import Reel, grey, size_of, upright


def read(path: Path) -> tuple[Reel, list[Frame]]:
    reel = Reel(path)
    return reel, list(reel.frames())


def codes(reel: Reel) -> list[str]:
    return [note.code for note in reel.notes]


@pytest.mark.parametrize(
    ("name", "codec"), [("a.avi", "MJPG"), ("a.mp4", "mp4v"), ("a.mov", "mp4v"), ("a.webm", "VP80")]
)
def test_frames_come_back_one_by_one(tmp_path: Path, name: str, codec: str) -> None:
    filmed = swaying(28)
    reel, frames = read(film(tmp_path / name, filmed, codec=codec))
    assert reel.frames_per_second == pytest.approx(30.0, rel=0.01)
    assert len(frames) == 28
    assert codes(reel) == []
    nearest = [int(np.argmin([np.abs(one.astype(int) - two).mean() for two in filmed])) for one in frames]
    assert nearest == list(range(28))


def test_h264_is_read() -> None:
    reel, frames = read(SYNTHETIC_ASH)
    assert (len(frames), reel.frames_per_second, frames[0].shape) == (120, 30.0, (480, 640, 3))


def test_a_gif_is_read_by_its_times(tmp_path: Path) -> None:
    write_gif(tmp_path / "a.gif", swaying(30), [50] * 30)
    reel, frames = read(tmp_path / "a.gif")
    assert (len(frames), reel.frames_per_second) == (30, pytest.approx(20.0))


def test_a_variable_rate_becomes_even(tmp_path: Path) -> None:
    times_ms = [50] * 20 + [150] * 10
    write_gif(tmp_path / "a.gif", swaying(30), times_ms)
    reel, frames = read(tmp_path / "a.gif")
    assert reel.frames_per_second == pytest.approx(20.0)
    assert len(frames) == pytest.approx(20 + 30, abs=3)
    assert (frames[-5] == frames[-6]).all() or (frames[-6] == frames[-7]).all()
    assert codes(reel) == ["clip_uneven"]


@pytest.mark.parametrize(("rate", "step"), [(30.0, 1), (31.0, 1), (50.0, 2), (60.0, 2), (120.0, 4)])
def test_of_fast_clips_one_frame_of_several_is_taken(tmp_path: Path, rate: float, step: int) -> None:
    filmed = swaying(48)
    reel, frames = read(film(tmp_path / "a.avi", filmed, rate))
    assert (reel.step, len(frames)) == (step, 48 // step)
    assert reel.frames_per_second == pytest.approx(rate / step)
    assert codes(reel) == ([] if step == 1 else ["clip_fast"])
    assert np.abs(frames[5].astype(int) - filmed[5 * step]).mean() < 6


def test_what_is_longer_than_a_minute_is_left_out(tmp_path: Path) -> None:
    reel, frames = read(film(tmp_path / "a.avi", swaying(150, (32, 24), rate=2.0), 2.0))
    assert len(frames) == 120
    assert codes(reel) == ["clip_long"]


def test_a_file_that_is_damaged_at_its_end_is_used_as_far_as_it_goes(tmp_path: Path) -> None:
    whole = film(tmp_path / "a.avi", swaying(60)).read_bytes()
    (tmp_path / "half.avi").write_bytes(whole[: len(whole) // 2])
    reel, frames = read(tmp_path / "half.avi")
    assert 24 <= len(frames) <= 32
    assert codes(reel) == ["clip_cut_short"]


def test_rotation_in_the_file_is_obeyed(tmp_path: Path) -> None:
    turned = quarter_turned(film(tmp_path / "a.mp4", swaying(30), codec="mp4v").read_bytes())
    (tmp_path / "b.mp4").write_bytes(turned)
    _, frames = read(tmp_path / "b.mp4")
    assert frames[0].shape == (160, 120, 3)
    wanted = cv2.rotate(swaying(1)[0], cv2.ROTATE_90_CLOCKWISE)
    assert np.abs(frames[0].astype(int) - wanted).mean() < 6


def quarter_turned(mp4: bytes) -> bytes:
    """Turn an MP4 a quarter clockwise by the matrix of its track (ISO 14496-12, 8.3.2)."""
    matrix = mp4.index(b"tkhd") + 4 + 40
    one = (1 << 16).to_bytes(4, "big", signed=True)
    minus = (-(1 << 16)).to_bytes(4, "big", signed=True)
    return mp4[:matrix] + bytes(4) + one + bytes(4) + minus + mp4[matrix + 16 :]


@pytest.mark.parametrize("content", [b"RIFF\0\0\0\0AVI " + bytes(200), b"\0\0\0\x18ftypisom" + bytes(500)])
def test_a_file_without_a_picture_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a").write_bytes(content)
    with pytest.raises(ClipError, match="damaged or has no picture") as refusal:
        Reel(tmp_path / "a")
    assert refusal.value.code == "clip_unreadable"


def test_reading_goes_on_and_begins_again(tmp_path: Path) -> None:
    path = film(tmp_path / "a.avi", swaying(30))
    _, frames = read(path)
    reel = Reel(path)
    reel.skip(10)
    assert (next(reel.frames()) == frames[10]).all()
    assert reel.at == 11
    reel.rewind()
    assert (next(reel.frames()) == frames[0]).all()


def test_pictures_are_kept_within_bounds() -> None:
    wide = np.zeros((30, 5000, 3), dtype=np.uint8)
    wide[..., 0] = 200
    assert size_of(wide) == (4096, 25)
    assert upright(wide).shape == (25, 4096, 3)
    assert (upright(wide)[0, 0] == (0, 0, 200)).all()
    assert grey(wide).shape == (4, 640)
