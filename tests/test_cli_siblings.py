"""The command ``treestroke siblings``, and the settings that make siblings beside a tree."""

import io
import json
from pathlib import Path

import pytest
from PIL import Image, ImageDraw
from tests.conftest import EXAMPLES

import treestroke
from treestroke.cli import main
from treestroke.codec.project import write_project

QUICK = {"iterations": 5, "leaf_density": 0.2, "seed": 3}
FRONT = EXAMPLES / "sketches" / "pear.front.json"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    path = tmp_path / "pear.treestroke"
    with path.open("wb") as file:
        write_project(file, {"front": io.BytesIO(FRONT.read_bytes())}, QUICK)
    return path


def test_siblings_and_a_scene_are_written_and_the_tree_itself_is_not(project: Path, tmp_path: Path) -> None:
    out, scene, told = tmp_path / "new", tmp_path / "grove.glb", tmp_path / "report.json"
    argv = ["siblings", str(project), "--count", "2", "--out", str(out), "--scene", str(scene), "--report", str(told)]
    assert main(argv) == 0
    assert sorted(path.name for path in out.iterdir()) == ["pear.s1.glb", "pear.s2.glb"]
    assert scene.read_bytes().startswith(b"glTF")
    report = json.loads(told.read_text())
    assert (len(report["siblings"]), report["variants"], report["seed"]) == (2, [], 3)
    made = treestroke.siblings(project, 2, name="pear")
    assert made.files["pear.s1.glb"] == (out / "pear.s1.glb").read_bytes()
    assert made.files["pear.s1.glb"] != made.files["pear.s2.glb"]


def test_an_outline_of_a_picture_gives_another_tree(project: Path, tmp_path: Path) -> None:
    shape = Image.new("L", (80, 80), 255)
    ImageDraw.Draw(shape).polygon([(40, 5), (70, 70), (10, 70)], fill=0)
    shape.save(tmp_path / "shape.png")
    made = treestroke.siblings(project, outline=tmp_path / "shape.png")
    assert made.glb != treestroke.siblings(project).glb
    assert made.report["score"]["silhouette_iou"] > 0.7


def test_a_tree_is_made_with_its_siblings_beside_it(tmp_path: Path) -> None:
    settings = {**QUICK, "siblings": 1, "grove": True}
    seed = settings.pop("seed")
    made = treestroke.sketch(FRONT, settings=settings, seed=seed, name="pear")
    assert list(made.files) == ["pear.glb", "pear.s1.glb", "pear.grove.glb"]
    assert len(made.report["variants"]) == len(made.report["siblings"]) == 1


@pytest.mark.parametrize(
    ("argv", "said"),
    [
        (["tree.glb"], "NAME.treestroke"),
        (["PROJECT", "--count", "17"], "count: at most 16"),
        (["PROJECT", "--count", "0"], "count: 0 is not allowed"),
        (["PROJECT", "--count", "many"], "count: many is not allowed"),
        (["PROJECT", "--outline", "nothing.png"], "nothing.png: there is no such file"),
        (["PROJECT", "--scene", "missing/grove.glb"], "there is no folder"),
    ],
)
def test_what_cannot_be_made_is_one_line(
    project: Path, tmp_path: Path, argv: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    named = [str(project) if part == "PROJECT" else part for part in argv]
    assert main(["siblings", *named, "--out", str(tmp_path / "new")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
