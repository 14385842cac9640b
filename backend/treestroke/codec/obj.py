"""A tree as Wavefront OBJ, with its material file and pictures.

Written by ourselves: trimesh's OBJ writer recomputes the normals of several objects, so that leaves would lose
theirs, which lean out of the crown; it knows no ``map_d``; and it takes more than twice as long.
"""

from collections.abc import Iterator
from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from treestroke.codec.gltf.document import encode_picture
from treestroke.core.geometry.mesh import Mesh, Surface

_PICTURES = {"bark": "bark.jpg", "leaf": "leaf.png"}
_MATERIAL = "newmtl {name}\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {stem}_{picture}\n"
_ALPHA = "map_d {stem}_leaf_alpha.png\n"


def encode_obj(bark: Surface, leaf: Surface | None, stem: str) -> dict[str, bytes]:
    """Encode a tree as ``stem.obj``, ``stem.mtl`` and its pictures: bytes by name.

    Objects and materials are named bark and leaf; metres, Y up, v upward as in OBJ. ``stem_leaf_alpha.png`` holds the
    alpha both as its grey and as its alpha, since readers of ``map_d`` take either. Shades and normal maps are left
    out. Equal input gives equal bytes.
    """
    surfaces = {"bark": bark} if leaf is None else {"bark": bark, "leaf": leaf}
    files = {f"{stem}_{_PICTURES[name]}": encode_picture(surface.texture)[1] for name, surface in surfaces.items()}
    materials = [_MATERIAL.format(name=name, stem=stem, picture=_PICTURES[name]) for name in surfaces]
    if leaf is not None:
        files[f"{stem}_leaf_alpha.png"] = _alpha_picture(leaf.texture)
        materials.append(_ALPHA.format(stem=stem))
    text, first = [f"mtllib {stem}.mtl\n"], 1
    for name, surface in surfaces.items():
        text += _object(name, surface.mesh, first)
        first += len(surface.mesh.positions)
    return {f"{stem}.obj": "".join(text).encode(), f"{stem}.mtl": "".join(materials).encode(), **files}


def _object(name: str, mesh: Mesh, first: int) -> Iterator[str]:
    """Format one object; ``first`` is the number of its first vertex, from 1."""
    upward = np.stack([mesh.uvs[:, 0], 1.0 - mesh.uvs[:, 1].astype(np.float64)], axis=1)
    corners = [f"{number}/{number}/{number}" for number in range(first, first + len(mesh.positions))]
    yield f"o {name}\n"
    yield _rows("v %.5f %.5f %.5f\n", mesh.positions)
    yield _rows("vt %.5f %.5f\n", upward)
    yield _rows("vn %.3f %.3f %.3f\n", mesh.normals)
    yield f"usemtl {name}\ns off\n"
    of_faces = map(corners.__getitem__, mesh.triangles.ravel().tolist())
    yield "f %s %s %s\n" * len(mesh.triangles) % tuple(of_faces)


def _rows(row: str, values: NDArray[np.floating]) -> str:
    """Format values (n, c), one row a line, in a single operation: several times as fast as one by one."""
    return row * len(values) % tuple(values.ravel().tolist())


def _alpha_picture(texture: NDArray[np.uint8]) -> bytes:
    """Encode the alpha of a texture (h, w, 4) as PNG, in both the grey and the alpha channel."""
    out = BytesIO()
    Image.fromarray(np.repeat(texture[..., 3:], 2, axis=2)).save(out, "PNG")
    return out.getvalue()
