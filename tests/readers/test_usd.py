"""What usd-core reads of a tree's USDZ."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.readers.conftest import Shelf

from treestroke.codec.usd import encode_usdz

pytestmark = pytest.mark.readers


@pytest.fixture
def stage(usdz: Path) -> Any:
    from pxr import Usd

    return Usd.Stage.Open(str(usdz))


def test_the_stage_is_upright_and_in_metres(stage: Any) -> None:
    from pxr import UsdGeom

    assert UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1
    assert stage.GetDefaultPrim().GetPath() == "/tree"


@pytest.mark.parametrize("name", ["bark", "leaf"])
def test_meshes_return(stage: Any, shelf: Shelf, name: str) -> None:
    from pxr import UsdGeom

    surface = getattr(shelf.tree, name)
    prim = stage.GetPrimAtPath(f"/tree/{name}")
    mesh = UsdGeom.Mesh(prim)
    uvs = np.array(UsdGeom.PrimvarsAPI(prim).GetPrimvar("st").Get())
    assert np.array_equal(np.array(mesh.GetPointsAttr().Get()), surface.mesh.positions)
    assert np.array_equal(np.array(mesh.GetFaceVertexIndicesAttr().Get()), surface.mesh.triangles.ravel())
    assert np.array_equal(np.array(mesh.GetNormalsAttr().Get()), surface.mesh.normals)
    assert np.allclose(uvs, surface.mesh.uvs * [1, -1] + [0, 1], atol=1e-5)
    assert mesh.GetDoubleSidedAttr().Get() == (name == "leaf")


@pytest.mark.parametrize("name", ["bark", "leaf"])
def test_pictures_are_found_in_the_package(stage: Any, name: str) -> None:
    from pxr import UsdShade

    prim = stage.GetPrimAtPath(f"/tree/{name}")
    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
    surface, _, _ = material.ComputeSurfaceSource()
    assert surface.GetIdAttr().Get() == "UsdPreviewSurface"
    picture = UsdShade.Shader(stage.GetPrimAtPath(f"/tree/materials/{name}/picture"))
    assert (
        picture.GetInput("file")
        .Get()
        .resolvedPath.endswith(f"tree.usdz[textures/{name}.{'jpg' if name == 'bark' else 'png'}]")
    )
    assert (surface.GetInput("opacityThreshold").Get() if name == "leaf" else 0.3) == pytest.approx(0.3)


def test_usd_s_own_rules_are_kept(usdz: Path) -> None:
    from pxr import Usd, UsdValidation

    known = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(known.GetOrLoadAllValidators())
    errors = context.Validate(Usd.Stage.Open(str(usdz)))
    assert [f"{one.GetName()}: {one.GetMessage()}" for one in errors] == []


def test_equal_trees_give_equal_packages(shelf: Shelf, usdz: Path) -> None:
    assert shelf.tree.leaf is not None
    again = encode_usdz(shelf.tree.bark, shelf.tree.leaf, shelf.tree.camera, "tree")
    assert again == usdz.read_bytes()
