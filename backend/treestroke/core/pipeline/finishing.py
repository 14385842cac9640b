"""The second half of all recipes: from a grown tree to a finished one."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from treestroke.core.geometry.camera import Camera, OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.mesh import Surface
from treestroke.core.grow.grown import Grown
from treestroke.core.leaf.leaves import Leaves, fruit_among, leaf_area
from treestroke.core.paint.atlas import Atlas
from treestroke.core.pipeline.clear_views import clear_views
from treestroke.core.pipeline.dressing import NO_PICTURES, OwnPictures, bark_surface, leaf_surface
from treestroke.core.pipeline.grown_tree import CapturedViews, Filmed, GrownTree, LiveTree, Reading
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.taken import Taken
from treestroke.core.progress import Report, silent
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import StrokeWarning
from treestroke.core.survey.measures import Measures, measure_tree
from treestroke.core.types import Floats

if TYPE_CHECKING:
    from treestroke.core.pipeline.tree_motion import TreeMotion


@dataclass(frozen=True, eq=False)
class TreeModel:
    """A finished tree: its surfaces in the world's frame, and what it was made from.

    Attributes
    ----------
    camera
        Camera of the picture at its own size.
    grown
        The skeleton, and how it grew.
    bark, leaf
        Its visible surfaces; ``leaf`` is None where it bears none.
    cards, atlas
        What the leaf surface was made from; both None where there is none.
    expected
        What its views should cover, each mask (h, w) at any size of its camera's picture: visible foliage and branches.
    taken
        What the tree is taken for.
    captured
        Where its photos were taken, of a tree that was measured from several.
    motion
        How it moves, of a tree that was filmed or whose example was.
    """

    camera: OrthographicCamera
    grown: Grown
    bark: Surface
    leaf: Surface | None
    cards: Leaves | None
    atlas: Atlas | None
    expected: tuple[Silhouette[Camera], ...]
    taken: Taken
    iterations: int
    branches: int
    measures: Measures
    score: dict[str, float]
    reading: Reading
    warnings: tuple[StrokeWarning, ...]
    captured: CapturedViews | None
    motion: "TreeMotion | None"


OnGrown = Callable[[LiveTree], None]
"""Called once, with the tree when growth ends."""


def ignore_grown(tree: LiveTree) -> None:
    """Ignore the grown tree."""


def finish(
    tree: GrownTree,
    settings: ModelSettings,
    rng: np.random.Generator,
    report: Report = silent,
    pictures: OwnPictures = NO_PICTURES,
) -> TreeModel:
    """Add leaves, fruit and bark to a grown tree, and measure it.

    ``report(stage, fraction)`` is called with the stages leaf and mesh, and motion where it was filmed.

    Raises
    ------
    ValueError
        A picture of a leaf or fruit has no pixels, or only transparent ones.
    """
    report("leaf", 0.0)
    tree = replace(tree, appearance=clear_views(tree.appearance, settings.light))
    leaf, leaf_cards, atlas = leaf_surface(tree, settings, pictures, rng, report)
    report("mesh", 0.0)
    bark = bark_surface(tree, settings, rng, report)
    report("mesh", 1.0)
    return TreeModel(
        camera=tree.camera,
        grown=tree.grown,
        bark=bark,
        leaf=leaf,
        cards=leaf_cards,
        atlas=atlas,
        expected=tree.expected,
        taken=tree.taken,
        iterations=settings.iterations,
        branches=_branch_count(tree.grown.skeleton),
        measures=_measures(tree, leaf_cards, atlas),
        score={**tree.score, "depth_over_width": _depth_over_width(bark, leaf)},
        reading=tree.reading,
        warnings=tree.warnings,
        captured=tree.captured,
        motion=_motion(tree, leaf_cards, rng, report),
    )


def _motion(tree: GrownTree, leaves: Leaves | None, rng: np.random.Generator, report: Report) -> "TreeMotion | None":
    """Move a tree that was filmed, or whose example was."""
    if tree.moves is None:
        return None
    from treestroke.core.pipeline.tree_motion import drawn_motion, filmed_motion  # with scipy, slow, and rarely of use

    report("motion", 0.0)
    joints = None if leaves is None else leaves.joints
    if isinstance(tree.moves, Filmed):
        return filmed_motion(tree.grown.skeleton, joints, tree.moves, tree.camera)
    return drawn_motion(tree.grown.skeleton, joints, tree.moves, rng.spawn(1)[0])


def _measures(tree: GrownTree, leaves: Leaves | None, atlas: Atlas | None) -> Measures:
    """Measure the tree as it was grown; fruit does not count as foliage."""
    if leaves is not None and atlas is not None:
        leaves = leaves.select(~fruit_among(leaves, atlas))
    crown = leaves.centres if leaves is not None and len(leaves) else None
    area = 0.0 if leaves is None or atlas is None else leaf_area(leaves, atlas)
    return measure_tree(tree.grown.skeleton, tree.stature, crown, area)


def _branch_count(tree: Skeleton) -> int:
    """Count a tree's branches: its stems and whatever leaves a fork."""
    counts = np.bincount(tree.parents[tree.parents >= 0], minlength=len(tree))
    return int((tree.parents < 0).sum() + np.maximum(counts - 1, 0).sum())


def _depth_over_width(bark: Surface, leaf: Surface | None) -> float:
    """Return the tree's depth over its width, each between the 2nd and 98th percentile of its (leaf) vertices."""
    points: Floats = (bark if leaf is None else leaf).mesh.positions.astype(np.float64)
    low, high = np.percentile(points[:, [0, 2]], [2, 98], axis=0)
    return float((high[1] - low[1]) / max(float(high[0] - low[0]), 1e-9))
