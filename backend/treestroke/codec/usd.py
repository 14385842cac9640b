"""A tree as USDZ, for Apple's viewers and film tools, by the optional package usd-core."""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from zipfile import ZipFile, ZipInfo

import numpy as np

from treestroke.codec.gltf.document import NORMAL_MAP_QUALITY, encode_picture
from treestroke.codec.skeleton import plain_camera
from treestroke.core.errors import SettingsError
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import ALPHA_CUT, Mesh, Surface

_ALIGNED = 64  # bytes: alignment of each file's content in a package, by the USDZ specification
_LOCAL_HEADER, _EXTRA_HEADER = 30, 4  # bytes of the zip headers before a file's name and before the padding
_PADDING_ID = b"\x86\x19"  # of the extra field that holds the padding
_MISSING = "usdz needs the package usd-core; install it by `pip install treestroke[usd]` or `make usd`"


@dataclass(frozen=True)
class _Image:
    """A texture file in the package, and how it is read: its wrap mode and colour space."""

    file: str
    wrap: str
    colour_space: str


def has_usd() -> bool:
    """Return whether USDZ can be written here."""
    return find_spec("pxr") is not None


def require_usd() -> None:
    """Raise unless USDZ can be written here.

    Raises
    ------
    SettingsError
        The optional package usd-core is not installed.
    """
    if not has_usd():
        raise SettingsError.at(("files",), _MISSING, "usd_missing")


def encode_usdz(bark: Surface, leaf: Surface | None, camera: OrthographicCamera, stem: str) -> bytes:
    """Encode a tree as a USDZ package: metres, Y up, UsdPreviewSurface, one mesh each for bark and leaf.

    The layer's custom data hold the photo's camera. Shades of leaves are left out: UsdPreviewSurface cannot multiply
    textures by vertex colours. Equal input gives equal bytes.

    Raises
    ------
    SettingsError
        The optional package usd-core is not installed.
    """
    require_usd()
    name = re.sub(r"^(?=\d)|\W", "_", stem, flags=re.ASCII)
    surfaces = {"bark": bark} if leaf is None else {"bark": bark, "leaf": leaf}
    pictures: dict[str, bytes] = {}
    for part, surface in surfaces.items():
        pictures[_texture_file(part, surface)] = encode_picture(surface.texture)[1]
        if surface.normal_map is not None:
            pictures[_normal_map_file(part)] = encode_picture(surface.normal_map, NORMAL_MAP_QUALITY)[1]
    return package({f"{name}.usdc": _layer(name, surfaces, camera), **pictures})


def _texture_file(part: str, surface: Surface) -> str:
    return f"textures/{part}.{'png' if surface.texture.shape[2] == 4 else 'jpg'}"


def _normal_map_file(part: str) -> str:
    return f"textures/{part}_relief.jpg"


def _layer(name: str, surfaces: Mapping[str, Surface], camera: OrthographicCamera) -> bytes:
    """Encode the scene as binary USD."""
    from pxr import Kind, Usd, UsdGeom

    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, f"/{name}")
    prim = root.GetPrim()
    Usd.ModelAPI(prim).SetKind(Kind.Tokens.component)
    stage.SetDefaultPrim(prim)
    layer = stage.GetRootLayer()
    layer.customLayerData = {"photo": json.dumps(plain_camera(camera))}
    for part, surface in surfaces.items():
        _add_surface(stage, f"/{name}", part, surface)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "tree.usdc"
        layer.Export(str(path))
        return path.read_bytes()


def _add_surface(stage: Any, root: str, part: str, surface: Surface) -> None:
    """Add a mesh with its material."""
    from pxr import UsdShade

    material = _material(stage, f"{root}/materials/{part}", part, surface)
    shape = _shape(stage, f"{root}/{part}", surface.mesh)
    shape.CreateDoubleSidedAttr(surface.texture.shape[2] == 4)
    prim = shape.GetPrim()
    UsdShade.MaterialBindingAPI.Apply(prim).Bind(material)


def _shape(stage: Any, path: str, mesh: Mesh) -> Any:
    """Add a mesh; v is upward, as in USD."""
    from pxr import Sdf, UsdGeom, Vt

    shape = UsdGeom.Mesh.Define(stage, path)
    points = np.ascontiguousarray(mesh.positions, dtype=np.float32)
    normals = np.ascontiguousarray(mesh.normals, dtype=np.float32)
    upward = np.ascontiguousarray(mesh.uvs * np.array([1, -1]) + np.array([0, 1]), dtype=np.float32)
    corners = np.ascontiguousarray(mesh.triangles.ravel(), dtype=np.int32)
    shape.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    shape.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    shape.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(mesh.triangles), 3, dtype=np.int32)))
    shape.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners))
    shape.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.stack([points.min(axis=0), points.max(axis=0)])))
    shape.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(normals))
    shape.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    primvars = UsdGeom.PrimvarsAPI(shape)
    st = primvars.CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex)
    st.Set(Vt.Vec2fArray.FromNumpy(upward))
    return shape


def _material(stage: Any, path: str, part: str, surface: Surface) -> Any:
    """Add a material with a texture, cut by its alpha where it has one, and a normal map."""
    from pxr import Sdf, UsdShade

    kinds = Sdf.ValueTypeNames
    cut = surface.texture.shape[2] == 4
    material = UsdShade.Material.Define(stage, path)
    shader = _shader(stage, f"{path}/surface", "UsdPreviewSurface")
    reader = _shader(stage, f"{path}/st", "UsdPrimvarReader_float2")
    reader.CreateInput("varname", kinds.String).Set("st")
    st = reader.CreateOutput("result", kinds.Float2)
    image = _Image(_texture_file(part, surface), "clamp" if cut else "repeat", "sRGB")
    picture = _texture(stage, f"{path}/picture", image, st)
    shader.CreateInput("diffuseColor", kinds.Color3f).ConnectToSource(picture.CreateOutput("rgb", kinds.Float3))
    shader.CreateInput("roughness", kinds.Float).Set(1.0)
    shader.CreateInput("metallic", kinds.Float).Set(0.0)
    if cut:
        shader.CreateInput("opacity", kinds.Float).ConnectToSource(picture.CreateOutput("a", kinds.Float))
        shader.CreateInput("opacityThreshold", kinds.Float).Set(ALPHA_CUT)
    if surface.normal_map is not None:
        normals = _texture(stage, f"{path}/relief", _Image(_normal_map_file(part), "repeat", "raw"), st)
        normals.CreateInput("scale", kinds.Float4).Set((2.0, 2.0, 2.0, 1.0))
        normals.CreateInput("bias", kinds.Float4).Set((-1.0, -1.0, -1.0, 0.0))
        shader.CreateInput("normal", kinds.Normal3f).ConnectToSource(normals.CreateOutput("rgb", kinds.Float3))
    material.CreateSurfaceOutput().ConnectToSource(shader.CreateOutput("surface", kinds.Token))
    return material


def _texture(stage: Any, path: str, image: _Image, st: Any) -> Any:
    """Add a shader that reads an image at the texture coordinates ``st``."""
    from pxr import Sdf

    texture = _shader(stage, path, "UsdUVTexture")
    texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(Sdf.AssetPath(image.file))
    texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(st)
    texture.CreateInput("sourceColorSpace", Sdf.ValueTypeNames.Token).Set(image.colour_space)
    for side in ("wrapS", "wrapT"):
        texture.CreateInput(side, Sdf.ValueTypeNames.Token).Set(image.wrap)
    return texture


def _shader(stage: Any, path: str, kind: str) -> Any:
    from pxr import UsdShade

    shader = UsdShade.Shader.Define(stage, path)
    shader.CreateIdAttr(kind)
    return shader


def package(files: Mapping[str, bytes]) -> bytes:
    """Pack files, the scene first, as USDZ: a zip without compression, each content at a multiple of 64 bytes.

    Equal files give equal bytes.
    """
    out = BytesIO()
    with ZipFile(out, "w") as package:
        for name, content in files.items():
            entry = ZipInfo(name)
            entry.create_system = 0
            start = out.tell() + _LOCAL_HEADER + len(name.encode()) + _EXTRA_HEADER
            padding = -start % _ALIGNED
            entry.extra = _PADDING_ID + padding.to_bytes(2, "little") + bytes(padding)
            package.writestr(entry, content)
    return out.getvalue()
