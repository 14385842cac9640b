"""What Blender reads of a tree's files, and what it drops."""

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.readers.conftest import BLENDER, Shelf, missing

pytestmark = pytest.mark.readers
FILES = ["plain.glb", "wind.glb", "compressed.glb", "instanced.glb", "loose.gltf", "tree.obj", "tree.ply"]
WHOLE = ["plain.glb", "wind.glb", "loose.gltf", "tree.obj", "tree.usdz"]


@pytest.fixture(scope="module")
def found(shelf: Shelf, usdz: Path) -> dict[str, dict[str, Any]]:
    """Let Blender open all files, one after the other."""
    if not BLENDER.is_file():
        missing("Blender's bpy is not installed: run `make readers`")
    script = Path(__file__).parent / "blender_reads.py"
    names = [*FILES, usdz.name]
    run = subprocess.run([BLENDER, script, *(shelf.folder / name for name in names)], capture_output=True, check=False)
    lines = [line.removeprefix("READ ") for line in run.stdout.decode().splitlines() if line.startswith("READ ")]
    assert len(lines) == len(names), run.stderr.decode()
    return dict(zip(names, map(json.loads, lines), strict=True))


def upright(box: np.ndarray) -> np.ndarray:
    """Turn a box from Y up to Blender's Z up."""
    (x0, y0, z0), (x1, y1, z1) = box
    return np.array([[x0, -z1, y0], [x1, -z0, y1]])


@pytest.mark.parametrize("name", WHOLE)
def test_blender_reads_all_triangles_in_their_place(found: dict[str, Any], shelf: Shelf, name: str) -> None:
    assert {mesh["material"]: mesh["triangles"] for mesh in found[name]["meshes"]} == shelf.triangles()
    assert all(mesh["uvs"] == 1 for mesh in found[name]["meshes"])
    sway = 0.5 if name == "wind.glb" else 0.0  # Blender shows the first frame of a clip, not the rest
    assert np.allclose(found[name]["box"], upright(shelf.box()), atol=0.01 + sway)


@pytest.mark.parametrize("name", WHOLE)
def test_blender_reads_pictures_and_cuts_the_leaves(found: dict[str, Any], shelf: Shelf, name: str) -> None:
    bark, leaf = found[name]["materials"]["bark"], found[name]["materials"]["leaf"]
    assert (bark["coloured"], bark["cut"], leaf["coloured"], leaf["cut"]) == (True, False, True, True)
    assert bark["relief"] == (shelf.tree.bark.normal_map is not None and name != "tree.obj")  # OBJ has none


def test_blender_drops_the_light_that_falls_through_leaves(found: dict[str, Any]) -> None:
    assert found["plain.glb"]["materials"]["leaf"]["transmission"] == 0


def test_blender_reads_shades_of_gltf_only(found: dict[str, Any]) -> None:
    shaded = {name: sum(mesh["colours"] for mesh in found[name]["meshes"]) for name in WHOLE}
    assert shaded == {"plain.glb": 1, "wind.glb": 1, "loose.gltf": 1, "tree.obj": 0, "tree.usdz": 0}


def test_blender_reads_bones_and_clips(found: dict[str, Any]) -> None:
    assert found["wind.glb"]["bones"] > 10
    assert [name.split("_")[0] for name in found["wind.glb"]["actions"]] == ["breeze", "gust"]
    assert all(mesh["skinned"] for mesh in found["wind.glb"]["meshes"])


def test_blender_reads_a_ply_lying_down_and_without_labels(found: dict[str, Any], shelf: Shelf) -> None:
    (mesh,) = found["tree.ply"]["meshes"]
    assert (mesh["triangles"], mesh["colours"]) == (sum(shelf.triangles().values()), 1)
    assert found["tree.ply"]["box"][1][1] > 0.95 * shelf.box()[1, 1]  # Y is still up


def test_blender_reads_instances_as_single_leaves_without_shades(found: dict[str, Any], shelf: Shelf) -> None:
    leaves = [mesh for mesh in found["instanced.glb"]["meshes"] if mesh["material"] == "leaf"]
    assert sum(mesh["triangles"] for mesh in leaves) >= shelf.triangles()["leaf"]
    assert {mesh["colours"] for mesh in leaves} == {0}
    assert np.allclose(found["instanced.glb"]["box"], upright(shelf.box()), atol=0.01)


def test_blender_refuses_meshopt(found: dict[str, Any]) -> None:
    assert "EXT_meshopt_compression" in found["compressed.glb"]["refused"]
