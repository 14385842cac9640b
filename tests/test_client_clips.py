"""The client's calls about clips against a real service."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.clips import STROKES, film, swaying
from tests.running import serving

from treestroke import client_clips
from treestroke.client import Client, ServiceError
from treestroke.clip_schemas import ClipInfo

PATIENCE_SECONDS = 600
"""Emergency exit of what is waited for."""


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    with serving(tmp_path_factory.mktemp("service") / "data", tracers=1) as address, Client(address) as client:
        yield client


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return film(tmp_path_factory.mktemp("clips") / "ash.avi", swaying(45))


@pytest.fixture(scope="module")
def clip(client: Client, path: Path) -> ClipInfo:
    return client.upload_clip(path)


def test_a_clip_goes_up_in_pieces(client: Client, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_clips, "_PIECE", 40_000)
    fractions: list[float] = []
    clip = client.upload_clip(path, fractions.append)
    assert (clip.name, clip.bytes, clip.frames) == ("ash.avi", path.stat().st_size, 45)
    assert len(fractions) == -(-clip.bytes // 40_000)
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    client.delete_clip(clip)
    with pytest.raises(ServiceError, match="clip_not_found"):
        client.clip(clip)


def test_clips_are_found_and_shown(client: Client, clip: ClipInfo) -> None:
    assert client.clip(clip.id) == clip
    assert clip in list(client.clips())
    assert client.clip_frame(clip, 3, height=60).startswith(b"\xff\xd8")
    with pytest.raises(ServiceError, match="frame_not_found"):
        client.clip_frame(clip, 45)


def test_a_clip_is_traced_and_becomes_a_tree(client: Client, clip: ClipInfo, tmp_path: Path) -> None:
    drawn = {"frame": 2, **STROKES}
    found = client.trace_clip(clip, drawn, rev=4)
    assert (found.rev, found.frame, found.tracks.frames_per_second) == (4, 2, 30.0)
    model = client.grow_clip(clip, drawn, {"iterations": 5}, name="Ash")
    made = client.wait(model, timeout=PATIENCE_SECONDS)
    assert (made.status, made.clip, made.name) == ("succeeded", clip.id, "Ash")
    client.download(made, tmp_path / "ash.glb")


def test_what_is_no_clip_is_refused(client: Client, tmp_path: Path) -> None:
    (tmp_path / "a.mp4").write_bytes(b"")
    with pytest.raises(ServiceError, match="the file is empty"):
        client.upload_clip(tmp_path / "a.mp4")
