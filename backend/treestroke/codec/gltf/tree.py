"""A tree as glTF 2.0: which nodes, materials and movements its file holds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from treestroke.codec.gltf.book import Book
from treestroke.codec.skeleton import plain_camera
from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.mesh import ALPHA_CUT, Surface
from treestroke.core.sway.wind import Skin, Wind

_CLAMP, _REPEAT = 33071, 10497
BARK_MATERIAL = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.95}}
LEAF_MATERIAL = {
    "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0},
    "alphaMode": "MASK",
    "alphaCutoff": ALPHA_CUT,
    "doubleSided": True,
}
Stuff = Literal["bark", "leaf"]
_MATERIALS: Mapping[Stuff, tuple[Mapping[str, Any], int]] = {
    "bark": (BARK_MATERIAL, _REPEAT),
    "leaf": (LEAF_MATERIAL, _CLAMP),
}


@dataclass(frozen=True, eq=False)
class Part:
    """One node of the scene.

    Attributes
    ----------
    stuff
        What it is made of.
    surface
        Its triangles and textures.
    skin
        How it follows the wind's bones, or None where nothing moves.
    suffix
        Stands behind the name of its node, mesh and material: ``_lod1``.
    """

    stuff: Stuff
    surface: Surface
    skin: Skin | None = None
    suffix: str = ""


def encode_glb(parts: Sequence[Part], camera: Camera, *, generator: str, wind: Wind | None = None) -> bytes:
    """Write a tree as a self-contained GLB.

    Nodes, meshes and materials are named by their stuff; the scene's ``extras.photo`` holds the camera. The bark's
    texture is a JPEG that repeats, the leaves' a PNG with alpha, cut at `ALPHA_CUT`. Texture coordinates within
    0 to 1 become 16 bit, shades a grey COLOR_0 of 8 bit. Equal input gives equal bytes.
    """
    book = Book()
    for part in parts:
        material, wrap = _MATERIALS[part.stuff]
        book.add(part.stuff + part.suffix, part.surface, material, wrap)
    scene = {"nodes": list(range(len(book.tables["nodes"]))), "extras": {"photo": plain_camera(camera)}}
    return book.glb({"asset": {"version": "2.0", "generator": generator}, "scene": 0, "scenes": [scene]})
