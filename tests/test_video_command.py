"""The command ``treestroke video`` and the library's `model_video`, in process."""

import io
import json
from pathlib import Path

import pytest
from tests.clips import STROKES, film, swaying

import treestroke
from treestroke.cli import main
from treestroke.codec.project import write_project

QUICK = ["--iterations", "5", "--leaf-density", "0.2"]


@pytest.fixture(scope="module")
def clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return film(tmp_path_factory.mktemp("clips") / "ash.avi", swaying(60), 60.0)


@pytest.fixture
def strokes(tmp_path: Path) -> Path:
    path = tmp_path / "outline.json"
    path.write_text(json.dumps({"frame": 4, **STROKES}))
    return path


@pytest.fixture(scope="module")
def glb(clip: Path) -> bytes:
    made = treestroke.model_video(clip, {"frame": 4, **STROKES}, {"iterations": 5, "leaf_density": 0.2}, seed=3)
    return made.glb


def test_a_clip_becomes_the_tree_that_the_library_makes(
    clip: Path, strokes: Path, glb: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, report = tmp_path / "tree.glb", tmp_path / "report.json"
    told = ["--out", str(out), "--report", str(report), "--seed", "3"]
    assert main(["video", str(clip), "--strokes", str(strokes), *told, *QUICK]) == 0
    assert out.read_bytes() == glb
    assert [one["code"] for one in json.loads(report.read_text())["warnings"]][:1] == ["clip_fast"]
    assert "treestroke: clip: it has 60 frames a second; one of 2 is taken" in capsys.readouterr().err


def test_a_project_of_a_clip_makes_the_same_tree(clip: Path, strokes: Path, glb: bytes, tmp_path: Path) -> None:
    project = tmp_path / "ash.treestroke"
    settings = {"iterations": 5, "leaf_density": 0.2, "seed": 3}
    with project.open("wb") as file:
        parts = {"clip": clip.read_bytes(), "frame_strokes": strokes.read_bytes()}
        write_project(file, {name: io.BytesIO(part) for name, part in parts.items()}, settings)
    assert main(["video", str(project), "--out", str(tmp_path / "tree.glb")]) == 0
    assert (tmp_path / "tree.glb").read_bytes() == glb


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"frame": 30}, "there is no frame 30, the clip has 30; choose one from 0 to 29"),
        ({"crown": {"points": [[0, 0], [1, 1]]}}, "at least 3 are needed"),
    ],
)
def test_faults_are_one_line(
    clip: Path, strokes: Path, changes: dict[str, object], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    strokes.write_text(json.dumps({"frame": 4, **STROKES, **changes}))
    out = strokes.with_name("tree.glb")
    assert main(["video", str(clip), "--strokes", str(strokes), "--out", str(out)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
    assert not out.exists()


def test_strokes_are_needed(clip: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["video", str(clip), "--out", str(tmp_path / "tree.glb")]) == 2
    assert "--strokes is missing" in capsys.readouterr().err


def test_a_photo_is_no_clip(
    maple_photo: Path, strokes: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["video", str(maple_photo), "--strokes", str(strokes), "--out", str(tmp_path / "tree.glb")]
    assert main(command) == 2
    assert "this is a still picture" in capsys.readouterr().err
