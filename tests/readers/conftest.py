"""One tree in every format, for readers that are not ours (make readers)."""

import os
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import treestroke
from treestroke.codec.gltf.instances import encode_instanced
from treestroke.codec.gltf.loose import encode_gltf
from treestroke.codec.gltf.tree import Part, Provenance, encode_glb
from treestroke.codec.obj import encode_obj
from treestroke.codec.ply import encode_ply
from treestroke.codec.usd import encode_usdz
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.progress import silent
from treestroke.core.sway.skinning import skin
from treestroke.core.sway.wind import wind_of
from treestroke.service.files import tree_files

ROOT = Path(__file__).parents[2]
BLENDER = ROOT / ".venv-bpy" / "bin" / "python"
USD = ROOT / ".venv-usd" / "lib" / f"python{sys.version_info.major}.{sys.version_info.minor}" / "site-packages"
EXAMPLE = ROOT / "examples" / "burr_oak_dusk.jpg"


@dataclass(frozen=True)
class Shelf:
    """A tree and the folder of its files."""

    tree: TreeModel
    folder: Path

    def triangles(self) -> dict[str, int]:
        """Count the triangles of bark and leaf."""
        assert self.tree.leaf is not None
        return {"bark": len(self.tree.bark.mesh.triangles), "leaf": len(self.tree.leaf.mesh.triangles)}

    def box(self) -> np.ndarray:
        """Give the lowest and the highest corner around bark and leaves (2, 3), metres, Y up."""
        assert self.tree.leaf is not None
        points = np.concatenate([self.tree.bark.mesh.positions, self.tree.leaf.mesh.positions])
        return np.stack([points.min(axis=0), points.max(axis=0)])


def missing(what: str) -> None:
    """Tell that a reader is missing: in CI that is a failure."""
    assert os.environ.get("CI") != "true", what
    pytest.skip(what)


@pytest.fixture(scope="session")
def shelf(tmp_path_factory: pytest.TempPathFactory) -> Shelf:
    """Write an example in all of glTF's forms, as OBJ and as PLY."""
    tree = treestroke.model(EXAMPLE, EXAMPLE.with_suffix(".strokes.json")).tree
    folder = tmp_path_factory.mktemp("readers")
    for name, content in _files(tree).items():
        (folder / name).write_bytes(content)
    return Shelf(tree, folder)


@pytest.fixture(scope="session")
def usdz(shelf: Shelf) -> Path:
    """Write the example as USDZ, with usd-core from its own environment."""
    if not USD.is_dir():
        missing("usd-core is not installed: run `make readers`")
    assert shelf.tree.leaf is not None
    sys.path.append(str(USD))
    (shelf.folder / "tree.usdz").write_bytes(encode_usdz(shelf.tree.bark, shelf.tree.leaf, shelf.tree.camera, "tree"))
    return shelf.folder / "tree.usdz"


def _files(tree: TreeModel) -> dict[str, bytes]:
    assert tree.leaf is not None
    assert tree.cards is not None
    assert tree.atlas is not None
    wind = wind_of(tree.grown.skeleton, ("breeze", "gust"), tree.cards.joints)
    still = [Part("bark", tree.bark), Part("leaf", tree.leaf)]
    bark, leaf = skin(wind.rig, tree.bark.mesh, leaves=False), skin(wind.rig, tree.leaf.mesh, leaves=True)
    moving = [Part("bark", tree.bark, bark), Part("leaf", tree.leaf, leaf)]
    return {
        "plain.glb": encode_glb(still, tree.camera, provenance=Provenance("test")),
        "wind.glb": encode_glb(moving, tree.camera, provenance=Provenance("test"), motion=wind),
        "compressed.glb": encode_glb(still, tree.camera, provenance=Provenance("test"), compress=True),
        "compressed_wind.glb": encode_glb(
            moving, tree.camera, provenance=Provenance("test"), motion=wind, compress=True
        ),
        "instanced.glb": encode_instanced(still[0], tree.cards, tree.atlas, tree.camera, provenance=Provenance("test")),
        **encode_gltf(still, tree.camera, provenance=Provenance("test"), stem="loose"),
        **encode_obj(tree.bark, tree.leaf, "tree"),
        "tree.ply": encode_ply(tree.bark, tree.cards, tree.atlas),
        **_written(tree, "one", ModelSettings(lod="one", wind="all")),
        **_written(tree, "levels", ModelSettings(lod="files", wind="all", files=("collision",))),
    }


def _written(tree: TreeModel, name: str, settings: ModelSettings) -> dict[str, bytes]:
    bundles = tree_files(tree, settings, name, "test", silent)
    return {file: content for bundle in bundles.values() for file, content in bundle.items()}
