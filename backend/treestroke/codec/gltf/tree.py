"""A tree as glTF 2.0: which nodes, materials and movements its file holds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from treestroke.codec.gltf.book import TRANSLUCENT, Book
from treestroke.codec.gltf.compression import compressed
from treestroke.codec.gltf.levels import add_levels
from treestroke.codec.gltf.rig import add_wind
from treestroke.codec.skeleton import plain_camera
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import ALPHA_CUT, Surface
from treestroke.core.sway.wind import Skin, Wind

_CLAMP, _REPEAT = 33071, 10497
BARK_MATERIAL = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.95}}
LEAF_MATERIAL = {
    "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0},
    "alphaMode": "MASK",
    "alphaCutoff": ALPHA_CUT,
    "doubleSided": True,
    "extensions": {
        TRANSLUCENT: {"diffuseTransmissionFactor": 0.4, "diffuseTransmissionColorFactor": [1.0, 1.0, 0.6]},
    },
}
"""A leaf lets through nearly as much light as it throws back, of less blue (Woolley 1971)."""
IMPOSTOR_MATERIAL = {
    "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0},
    "alphaMode": "MASK",
    "alphaCutoff": ALPHA_CUT,
}
"""Seen from the front only: each picture belongs to one side of its plane."""
COLLISION_MATERIAL = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}}
Stuff = Literal["bark", "leaf", "impostor", "collision"]
MATERIALS: Mapping[Stuff, tuple[Mapping[str, Any], int]] = {
    "bark": (BARK_MATERIAL, _REPEAT),
    "leaf": (LEAF_MATERIAL, _CLAMP),
    "impostor": (IMPOSTOR_MATERIAL, _CLAMP),
    "collision": (COLLISION_MATERIAL, _REPEAT),
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
    coarser
        What readers of MSFT_lod show in its place where it is small, from finer to coarser.
    """

    stuff: Stuff
    surface: Surface
    skin: Skin | None = None
    suffix: str = ""
    coarser: "tuple[Part, ...]" = ()


def encode_glb(
    parts: Sequence[Part],
    camera: OrthographicCamera,
    *,
    generator: str,
    wind: Wind | None = None,
    compress: bool = False,
) -> bytes:
    """Write a tree as a self-contained GLB.

    Nodes, meshes and materials are named by their stuff; the scene's ``extras.photo`` holds the camera. The bark's
    texture is a JPEG that repeats, the leaves' a PNG with alpha, cut at `ALPHA_CUT`. Texture coordinates within
    0 to 1 become 16 bit, shades a grey COLOR_0 of 8 bit. Compressed, the file is about a third as large and asks
    readers for three extensions (`compression`). Equal input gives equal bytes.
    """
    book, head = write_book(parts, camera, generator, wind)
    return (compressed(book) if compress else book).glb(head)


def write_book(
    parts: Sequence[Part], camera: OrthographicCamera, generator: str, wind: Wind | None
) -> tuple[Book, dict[str, Any]]:
    """Fill the tables, and give what stands before them."""
    book = Book()
    roots = [_add(book, part, wind) for part in parts]
    for part, node in zip(parts, roots, strict=True):
        if part.coarser:
            ends = part.coarser[-1].stuff == "impostor"
            add_levels(book, node, [_add(book, level, wind) for level in part.coarser], ends)
    if wind is not None:
        # a mesh that follows bones stands beside them, for nothing else may move it
        roots.append(add_wind(book, wind))
    return book, head_of(roots, camera, generator)


def _add(book: Book, part: Part, wind: Wind | None) -> int:
    """Enter a part and give its node."""
    material, wrap = MATERIALS[part.stuff]
    name = part.stuff + part.suffix
    # An impostor is as clear between its leaves as they are: readers that go by names take it for leaves.
    worn = f"leaf_{name}" if part.stuff == "impostor" else name
    return book.add(name, part.surface, material, wrap, part.skin if wind else None, worn)


def head_of(roots: list[int], camera: OrthographicCamera, generator: str) -> dict[str, Any]:
    """Give what stands before the tables: one scene, and how the photo saw it."""
    scene = {"nodes": roots, "extras": {"photo": plain_camera(camera)}}
    return {"asset": {"version": "2.0", "generator": generator}, "scene": 0, "scenes": [scene]}
