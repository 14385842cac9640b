"""The files of a tree that its settings ask for."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from treestroke.codec.gltf.instances import encode_instanced
from treestroke.codec.gltf.loose import encode_gltf
from treestroke.codec.gltf.tree import MaterialName, Part, Provenance, encode_glb
from treestroke.codec.obj import encode_obj
from treestroke.codec.ply import encode_ply
from treestroke.codec.skeleton_files import encode_csv, encode_skeleton_json, encode_swc
from treestroke.codec.usd import encode_usdz, has_usd, require_usd
from treestroke.core.geometry.mesh import Surface
from treestroke.core.mesh.collision_hulls import collision_hulls
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.pipeline.levels import Level, Levels, levels
from treestroke.core.pipeline.settings import FILES, ModelSettings
from treestroke.core.progress import Report
from treestroke.core.sway.motion import Motion
from treestroke.core.sway.skinning import skin
from treestroke.core.sway.wind import blown, wind_of

Bundle = Mapping[str, bytes]
"""Files that belong together, by name; the first refers to the others."""
ENDINGS = {
    "gltf": "gltf",
    "obj": "obj",
    "usdz": "usdz",
    "ply": "ply",
    "instanced": "instanced.glb",
    "collision": "collision.glb",
    "json": "skeleton.json",
    "swc": "swc",
    "csv": "skeleton.csv",
}
"""Endings of the names of further files, by the setting's name for them."""
ANIMATIONS = {"none": (), "breeze": ("breeze",), "all": ("breeze", "gust")}
"""Animations for each value of the setting ``wind``."""
PLAIN = np.full((1, 1, 3), 128, dtype=np.uint8)
"""Texture (1, 1, 3), sRGB 0 to 255, of the collision solid, which is never drawn."""


def tree_files(
    tree: TreeModel, settings: ModelSettings, name: str, generator: str, report: Report
) -> dict[str, Bundle]:
    """Return a tree's files: its GLB, its levels of detail and the further files that the settings name, by bundle.

    All names begin with ``name``. ``report`` is called with the stages levels (if there are any) and write.
    """
    writer = _Writer(tree, settings, name, generator, _motion(tree, settings))
    coarse = None if settings.lod == "none" else levels(tree, report)
    recipes = writer.glbs(coarse) | {f"{name}.{ENDINGS[kind]}": partial(writer.other, kind) for kind in settings.files}
    bundles = {}
    for done, (bundle, make) in enumerate(recipes.items()):
        report("write", done / len(recipes))
        bundles[bundle] = make()
    report("write", 1.0)
    return bundles


def check_files(settings: ModelSettings) -> None:
    """Check that the packages which the files need are installed.

    Raises
    ------
    SettingsError
        A package is missing.
    """
    if "usdz" in settings.files:
        require_usd()


def files_on_offer() -> tuple[str, ...]:
    """Return the names of the further files that the installed packages can write."""
    return tuple(file for file in FILES if file != "usdz" or has_usd())


def _motion(tree: TreeModel, settings: ModelSettings) -> Motion | None:
    """Return what moves a tree: as it was filmed, and as the setting ``wind`` wants it."""
    names = ANIMATIONS[settings.wind]
    if tree.motion is not None:
        return Motion(tree.motion.rig, (tree.motion.animation, *blown(tree.motion.rig, names)))
    return wind_of(tree.grown.skeleton, names, None if tree.cards is None else tree.cards.joints) if names else None


def _with_coarser(fine: list[Part], coarser: list[list[Part]], impostor: Part) -> list[Part]:
    """Return the parts with the parts that replace them at a distance; the impostor replaces the last one."""
    found = []
    for part in fine:
        same = tuple(other for level in coarser for other in level if other.material == part.material)
        found.append(replace(part, coarser=(*same, impostor) if part is fine[-1] else same))
    return found


class _Writer:
    """Writes the files of one tree; all their names begin alike."""

    def __init__(
        self, tree: TreeModel, settings: ModelSettings, name: str, generator: str, motion: Motion | None
    ) -> None:
        self._tree, self._settings, self._name = tree, settings, name
        self._motion = motion
        self._provenance = Provenance(generator, tree.captured, tree.motion)

    def glbs(self, coarse: Levels | None) -> dict[str, Callable[[], Bundle]]:
        """Return functions that write the GLB and its levels of detail, as files of their own or in the one file."""
        fine = self._parts(Level(self._tree.bark, self._tree.leaf))
        if coarse is None:
            return self._glb("", fine)
        coarser = [self._parts(level, f"_lod{at}") for at, level in enumerate((coarse.lod1, coarse.lod2), start=1)]
        impostor = Part("impostor", coarse.impostor)
        if self._settings.lod == "one":
            return self._glb("", _with_coarser(fine, coarser, impostor))
        files = {"": fine, ".lod1": coarser[0], ".lod2": coarser[1], ".impostor": [impostor]}
        return {bundle: make for infix, parts in files.items() for bundle, make in self._glb(infix, parts).items()}

    def other(self, kind: str) -> Bundle:
        """Return the tree in another format."""
        tree, name = self._tree, self._name
        file = f"{name}.{ENDINGS[kind]}"
        match kind:
            case "gltf":
                parts = self._parts(Level(tree.bark, tree.leaf))
                return encode_gltf(parts, tree.camera, provenance=self._provenance, stem=name, motion=self._motion)
            case "obj":
                return encode_obj(tree.bark, tree.leaf, name)
            case "usdz":
                return {file: encode_usdz(tree.bark, tree.leaf, tree.camera, name)}
            case "ply":
                return {file: encode_ply(tree.bark, tree.cards, tree.atlas)}
            case "instanced":
                return {file: self._instanced()}
            case "collision":
                solid = Part("collision", Surface(collision_hulls(tree.grown.skeleton), PLAIN))
                return {file: encode_glb([solid], tree.camera, provenance=self._provenance)}
            case "json":
                return {file: encode_skeleton_json(tree.grown.skeleton, tree.grown.born, tree.camera)}
            case "swc":
                return {file: encode_swc(tree.grown.skeleton)}
            case _:
                return {file: encode_csv(tree.grown.skeleton, tree.grown.born)}

    def _instanced(self) -> bytes:
        """Return a GLB with leaves as instances; without leaves, of the bark alone."""
        tree, bark = self._tree, Part("bark", self._tree.bark)
        if tree.cards is None or tree.atlas is None:
            return encode_glb([bark], tree.camera, provenance=self._provenance)
        return encode_instanced(bark, tree.cards, tree.atlas, tree.camera, provenance=self._provenance)

    def _glb(self, infix: str, parts: list[Part]) -> dict[str, Callable[[], Bundle]]:
        file = f"{self._name}{infix}.glb"
        return {file: lambda: {file: self._encoded(parts)}}

    def _encoded(self, parts: list[Part]) -> bytes:
        motion = self._motion if any(part.skin is not None for part in parts) else None
        compress = self._settings.compress
        return encode_glb(parts, self._tree.camera, provenance=self._provenance, motion=motion, compress=compress)

    def _parts(self, level: Level, suffix: str = "") -> list[Part]:
        surfaces: list[tuple[MaterialName, Surface | None]] = [("bark", level.bark), ("leaf", level.leaf)]
        return [self._part(material, surface, suffix) for material, surface in surfaces if surface is not None]

    def _part(self, material: MaterialName, surface: Surface, suffix: str) -> Part:
        weights = None if self._motion is None else skin(self._motion.rig, surface.mesh, leaves=material == "leaf")
        return Part(material, surface, weights, suffix)
