"""A tree as Wavefront OBJ, with its material file and pictures."""

from collections.abc import Iterable
from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from treestroke.codec.gltf.book import encode_picture
from treestroke.core.geometry.mesh import Mesh, Surface

_MATERIAL = "newmtl {name}\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {stem}_{picture}\n"
_CUT = "map_d {stem}_leaf_alpha.png\n"


def encode_obj(bark: Surface, leaf: Surface | None, stem: str) -> dict[str, bytes]:
    """Write a tree as ``stem.obj``, ``stem.mtl`` and its pictures: bytes by name.

    Objects and materials are named bark and leaf; metres, Y up, v upward as OBJ has it. ``stem_leaf_alpha.png`` holds
    the alpha both as its grey and as its alpha, since readers of map_d take either. Shades and relief are left out.
    """
    worn = {"bark": bark} if leaf is None else {"bark": bark, "leaf": leaf}
    names = {"bark": "bark.jpg", "leaf": "leaf.png"}
    files = {f"{stem}_{names[name]}": encode_picture(surface.texture)[1] for name, surface in worn.items()}
    materials = [_MATERIAL.format(name=name, stem=stem, picture=names[name]) for name in worn]
    if leaf is not None:
        files[f"{stem}_leaf_alpha.png"] = _alpha_picture(leaf.texture)
        materials.append(_CUT.format(stem=stem))
    text, first = [f"mtllib {stem}.mtl\n"], 1
    for name, surface in worn.items():
        text += _object(name, surface.mesh, first)
        first += len(surface.mesh.positions)
    return {f"{stem}.obj": "".join(text).encode(), f"{stem}.mtl": "".join(materials).encode(), **files}


def _object(name: str, mesh: Mesh, first: int) -> Iterable[str]:
    """Write one object, whose vertices are counted from ``first`` on."""
    upward = np.stack([mesh.uvs[:, 0], 1.0 - mesh.uvs[:, 1].astype(np.float64)], axis=1)
    corners = [f"{index}/{index}/{index}" for index in range(first, first + len(mesh.positions))]
    yield f"o {name}\n"
    yield _rows("v %.5f %.5f %.5f\n", mesh.positions)
    yield _rows("vt %.5f %.5f\n", upward)
    yield _rows("vn %.3f %.3f %.3f\n", mesh.normals)
    yield f"usemtl {name}\ns off\n"
    named = map(corners.__getitem__, mesh.triangles.ravel().tolist())
    yield "f %s %s %s\n" * len(mesh.triangles) % tuple(named)


def _rows(row: str, values: NDArray[np.floating]) -> str:
    """Write values (n, c) by one pattern a row, all at once."""
    return row * len(values) % tuple(values.ravel().tolist())


def _alpha_picture(texture: NDArray[np.uint8]) -> bytes:
    out = BytesIO()
    Image.fromarray(np.repeat(texture[..., 3:], 2, axis=2)).save(out, "PNG")
    return out.getvalue()
