from pathlib import Path

import numpy as np
import pytest
from tests.clips import film, swaying

from treestroke.core.errors import ClipError
from treestroke.service import clip_loading
from treestroke.service.clip_loading import StoredClip, load_clip


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return film(tmp_path_factory.mktemp("clips") / "ash.avi", swaying(60))


def test_a_path_bytes_and_a_stored_file_give_the_same_frames(path: Path) -> None:
    videos = [load_clip(clip, 10) for clip in (path, path.read_bytes(), StoredClip(path))]
    assert all((video.frames == videos[0].frames).all() for video in videos)
    assert all((video.picture == videos[0].picture).all() for video in videos)
    assert videos[0].frames.shape == (60, 120, 160)
    assert (videos[0].frames_per_second, videos[0].chosen, videos[0].notes) == (30.0, 10, ())
    assert load_clip(videos[0], 3) is videos[0]


def test_the_part_between_cuts_is_the_video(tmp_path: Path) -> None:
    dark = [(frame // 2).astype(np.uint8) for frame in swaying(60)]
    video = load_clip(film(tmp_path / "cut.avi", [*swaying(60), *dark]), 70)
    assert (len(video.frames), video.chosen) == (60, 10)
    assert [note.code for note in video.notes] == ["clip_cut"]
    assert np.abs(video.picture.astype(int) - dark[10][..., ::-1]).mean() < 6


@pytest.mark.parametrize(
    ("name", "content", "code", "said"),
    [
        ("a.txt", b"no video", "clip_format", r"a\.txt: this is not a video"),
        ("a.jpg", b"\xff\xd8\xff" + bytes(99), "clip_format", "still picture"),
        ("a.avi", b"RIFF\0\0\0\0AVI " + bytes(99), "clip_unreadable", r"a\.avi: it is damaged"),
    ],
)
def test_files_that_cannot_be_used_are_named(tmp_path: Path, name: str, content: bytes, code: str, said: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ClipError, match=said) as refusal:
        load_clip(tmp_path / name, 0)
    assert refusal.value.code == code


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ClipError, match="there is no such file; check the path"):
        load_clip(tmp_path / "none.mp4", 0)


def test_a_file_that_is_too_large_is_refused(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clip_loading, "MAX_CLIP_BYTES", 1000)
    with pytest.raises(ClipError, match="make it shorter or smaller") as refusal:
        load_clip(path, 0)
    assert refusal.value.code == "clip_too_large"
