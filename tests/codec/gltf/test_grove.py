"""Tests of several trees in one GLB."""

import json
import struct
from typing import Any

import numpy as np
from tests.builders import fork, stick

from treestroke.codec.gltf.grove import encode_grove
from treestroke.codec.gltf.tree import Part, Provenance
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Surface
from treestroke.core.mesh.tubes import tubes
from treestroke.core.siblings.grove import Grove

CAMERA = OrthographicCamera(100, 100, 0.05, (50.0, 95.0))
PLAIN = np.full((4, 4, 3), 120, dtype=np.uint8)
GROVE = Grove(np.array([0, 1, 0]), np.array([[0.0, 0.0], [4.0, 1.0], [-3.0, 2.0]]), np.array([0.0, 0.0, np.pi / 2]))


def encoded() -> bytes:
    trees = [[Part("bark", Surface(tubes(tree), PLAIN))] for tree in (fork(), stick())]
    return encode_grove(trees, GROVE, CAMERA, provenance=Provenance("test"))


def document() -> dict[str, Any]:
    content = encoded()
    (length,) = struct.unpack("<I", content[12:16])
    return json.loads(content[20 : 20 + length])


def test_trees_that_stand_twice_share_their_mesh() -> None:
    found = document()
    assert len(found["meshes"]) == 2
    placed = [found["nodes"][node] for node in found["scenes"][0]["nodes"]]
    meshes = [found["nodes"][node["children"][0]]["mesh"] for node in placed]
    assert meshes[0] == meshes[2] != meshes[1]


def test_every_tree_stands_at_its_place_and_is_turned_there() -> None:
    found = document()
    placed = [found["nodes"][node] for node in found["scenes"][0]["nodes"]]
    assert [node["translation"] for node in placed] == [[0.0, 0.0, 0.0], [4.0, 0.0, 1.0], [-3.0, 0.0, 2.0]]
    assert "rotation" not in placed[0]
    assert np.allclose(placed[2]["rotation"], [0, np.sqrt(0.5), 0, np.sqrt(0.5)])


def test_no_node_has_two_parents() -> None:
    found = document()
    children = [child for node in found["nodes"] for child in node.get("children", [])]
    assert len(children) == len(set(children))


def test_the_same_grove_has_the_same_bytes() -> None:
    assert encoded() == encoded()
