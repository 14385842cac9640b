"""A tree as glTF 2.0: the nodes, materials and animations of its file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from treestroke.codec.cameras import plain_cameras
from treestroke.codec.gltf.compression import compressed
from treestroke.codec.gltf.document import TRANSLUCENT, Document, Material
from treestroke.codec.gltf.levels import add_levels
from treestroke.codec.gltf.rig import add_motion
from treestroke.codec.motion import plain_motion
from treestroke.codec.skeleton import plain_camera
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import ALPHA_CUT, Surface
from treestroke.core.pipeline.grown_tree import CapturedViews
from treestroke.core.sway.motion import Motion, Skin

if TYPE_CHECKING:
    from treestroke.core.pipeline.tree_motion import TreeMotion

_CLAMP, _REPEAT = 33071, 10497  # a sampler's wrapS and wrapT
MaterialName = Literal["bark", "leaf", "impostor", "collision"]
MATERIALS: Mapping[MaterialName, Material] = {
    "bark": Material({"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.95}}, _REPEAT),
    # A leaf transmits nearly as much light as it reflects, with less blue (Woolley 1971).
    "leaf": Material(
        {
            "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0},
            "alphaMode": "MASK",
            "alphaCutoff": ALPHA_CUT,
            "doubleSided": True,
            "extensions": {
                TRANSLUCENT: {"diffuseTransmissionFactor": 0.4, "diffuseTransmissionColorFactor": [1.0, 1.0, 0.6]},
            },
        },
        _CLAMP,
    ),
    # Single-sided: each picture belongs to one side of its plane.
    "impostor": Material(
        {
            "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0},
            "alphaMode": "MASK",
            "alphaCutoff": ALPHA_CUT,
        },
        _CLAMP,
    ),
    "collision": Material({"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}}, _REPEAT),
}


@dataclass(frozen=True, eq=False)
class Provenance:
    """Where a tree's file comes from: the program that wrote it, the photos or the clip that it was measured from."""

    generator: str
    captured: CapturedViews | None = None
    motion: "TreeMotion | None" = None


@dataclass(frozen=True, eq=False)
class Part:
    """One node of the scene.

    Attributes
    ----------
    material
        The name of its material, which also names its node and mesh.
    surface
        Its triangles and textures.
    skin
        How its vertices follow the bones, or None where nothing moves.
    suffix
        Added to the names of its node, mesh and material, such as ``_lod1``.
    coarser
        The nodes that readers of MSFT_lod show in its place where it is small, from finer to coarser.
    """

    material: MaterialName
    surface: Surface
    skin: Skin | None = None
    suffix: str = ""
    coarser: "tuple[Part, ...]" = ()


def encode_glb(
    parts: Sequence[Part],
    camera: OrthographicCamera,
    *,
    provenance: Provenance,
    motion: Motion | None = None,
    compress: bool = False,
) -> bytes:
    """Encode a tree as a self-contained GLB.

    Nodes, meshes and materials are named by their material; the scene's ``extras.photo`` holds the camera,
    ``extras.cameras`` those of a capture's photos, ``extras.motion`` what a clip showed. The bark's
    texture is a JPEG that repeats, the leaves' a PNG with alpha, cut at `ALPHA_CUT`. Texture coordinates within
    0 to 1 become 16 bit, shades a grey COLOR_0 of 8 bit. Compressed, the file is about a third as large and requires
    three extensions of its readers (`compression`). Equal input gives equal bytes.
    """
    document, head = build_document(parts, camera, provenance, motion)
    return (compressed(document) if compress else document).glb(head)


def build_document(
    parts: Sequence[Part], camera: OrthographicCamera, provenance: Provenance, motion: Motion | None
) -> tuple[Document, dict[str, Any]]:
    """Build the document of a tree, and the entries of its JSON that come before the tables."""
    document = Document()
    roots = [_add(document, part, motion) for part in parts]
    for part, node in zip(parts, roots, strict=True):
        if part.coarser:
            ends = part.coarser[-1].material == "impostor"
            add_levels(document, node, [_add(document, level, motion) for level in part.coarser], ends)
    if motion is not None:
        # a skinned mesh stands beside its bones, for no other node may move it
        roots.append(add_motion(document, motion))
    return document, head_of(roots, camera, provenance)


def _add(document: Document, part: Part, motion: Motion | None) -> int:
    """Add a part and return the index of its node."""
    name = part.material + part.suffix
    # An impostor is transparent between its leaves: readers that recognise leaves by name must cut it as they do those.
    material_name = f"leaf_{name}" if part.material == "impostor" else name
    return document.add(name, part.surface, MATERIALS[part.material], part.skin if motion else None, material_name)


def head_of(roots: list[int], camera: OrthographicCamera, provenance: Provenance) -> dict[str, Any]:
    """Return the entries before the tables: the asset, and one scene with the cameras."""
    cameras = {} if provenance.captured is None else {"cameras": plain_cameras(provenance.captured)}
    motion = {} if provenance.motion is None else {"motion": plain_motion(provenance.motion)}
    scene = {"nodes": roots, "extras": {"photo": plain_camera(camera), **cameras, **motion}}
    return {"asset": {"version": "2.0", "generator": provenance.generator}, "scene": 0, "scenes": [scene]}
