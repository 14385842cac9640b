"""Siblings of a tree: grown, finished and written, alone or as a grove."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from treestroke.codec.gltf.grove import encode_grove
from treestroke.codec.gltf.tree import MaterialName, Part, Provenance
from treestroke.core.geometry.mesh import Surface
from treestroke.core.pipeline.dressing import OwnPictures
from treestroke.core.pipeline.finishing import TreeModel, finish
from treestroke.core.pipeline.grown_tree import GrownTree
from treestroke.core.pipeline.levels import Level, levels
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.progress import Report
from treestroke.core.siblings.grove import crown_radius, plant
from treestroke.core.siblings.outlines import Envelope
from treestroke.core.types import Floats
from treestroke.service.engine_version import GENERATOR
from treestroke.service.files import Bundle, tree_files

WHOLE = 3
"""Most different trees of a grove that stand there in full detail; of more, the first level of detail does."""


@dataclass(frozen=True, eq=False)
class SiblingsOrder:
    """What siblings are to be like: the outline that they fill, if any, and pictures of their leaf and fruit."""

    envelope: Envelope | None
    pictures: OwnPictures


def grown_siblings(
    example: GrownTree, order: SiblingsOrder, settings: ModelSettings, seed: int, report: Report
) -> Iterator[TreeModel]:
    """Grow and finish as many siblings of a tree as the settings ask for, each by random numbers of its own."""
    from treestroke.core.pipeline.siblings import grow_sibling, learn  # with scipy, slow, and rarely of use

    learnt = learn(example, settings.light)
    for number in range(1, settings.siblings + 1):
        rng = np.random.default_rng((seed, number))
        grown = grow_sibling(learnt, settings, rng, report, order.envelope)
        yield finish(grown, settings, rng, report, order.pictures)


def sibling_files(trees: Sequence[TreeModel], settings: ModelSettings, name: str, report: Report) -> dict[str, Bundle]:
    """Return the files of siblings, by bundle; the names of the first one's begin with ``NAME.s1``."""
    bundles: dict[str, Bundle] = {}
    for number, tree in enumerate(trees, start=1):
        bundles |= tree_files(tree, settings, f"{name}.s{number}", GENERATOR, report)
    return bundles


def grove_glb(trees: Sequence[TreeModel], count: int, settings: ModelSettings, seed: int, report: Report) -> bytes:
    """Return a GLB of ``count`` trees beside each other: those given, and the same again, turned."""
    radii = np.array([max(crown_radius(_points(tree)), 0.1) for tree in trees])
    grove = plant(radii, count, np.random.default_rng((seed, 0)))
    fine = len(trees) <= WHOLE
    shown = [Level(tree.bark, tree.leaf) if fine else levels(tree, report).lod1 for tree in trees]
    parts = [_parts(level) for level in shown]
    provenance = Provenance(GENERATOR, trees[0].captured)
    return encode_grove(parts, grove, trees[0].camera, provenance=provenance, compress=settings.compress)


def _parts(level: Level) -> list[Part]:
    surfaces: list[tuple[MaterialName, Surface | None]] = [("bark", level.bark), ("leaf", level.leaf)]
    return [Part(material, surface) for material, surface in surfaces if surface is not None]


def _points(tree: TreeModel) -> Floats:
    surfaces = [tree.bark] if tree.leaf is None else [tree.bark, tree.leaf]
    return np.vstack([surface.mesh.positions for surface in surfaces]).astype(np.float64)
