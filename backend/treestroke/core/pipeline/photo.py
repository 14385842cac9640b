"""System A: a 3D tree from one photo and a few strokes (Tan et al. 2008). The recipe reads top to bottom."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.envelope import Envelope
from treestroke.core.geometry.mesh import Surface
from treestroke.core.geometry.polyline import Floats, Indices
from treestroke.core.grow.replacement import Grown
from treestroke.core.leaf.area import leaf_area
from treestroke.core.leaf.atlas import Atlas
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.pipeline.dressing import bark_surface, first_stem, leaf_surface
from treestroke.core.pipeline.growing import BULGE, GrownTree, LiveTree, Seen, grow_tree, see
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sight import WORKING_SIDE, Mask, Photo
from treestroke.core.progress import Report, silent
from treestroke.core.segment.foliage import Foliage
from treestroke.core.segment.kind import Kind
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Strokes, StrokeWarning
from treestroke.core.survey.measures import BREAST_HEIGHT, ENDS_PX, Measures, Scale, measure_tree


@dataclass(frozen=True, eq=False)
class PhotoTrace:
    """What strokes and photo tell together, in photo px.

    Attributes
    ----------
    foliage
        (h, w) leaf pixels.
    seen
        What both of them show, at the working size.
    skeleton
        The visible branches; None without a branch stroke.
    stroke
        (n,) index of the stroke that each joint follows, -1 where it was found.
    warnings
        What was mended.
    """

    foliage: Mask
    seen: Seen
    skeleton: Skeleton | None
    stroke: Indices
    warnings: tuple[StrokeWarning, ...]


@dataclass(frozen=True, eq=False)
class TreeModel:
    """A finished tree: its surfaces in the world's frame, and what it was made from.

    Attributes
    ----------
    camera
        That of the photo at its own size.
    grown
        The skeleton, and how it grew.
    envelope
        The crown's solid.
    bark, leaf
        What is seen of it; no leaf where it bears none.
    cards, atlas
        What the leaf surface was made from; both None where there is none.
    likeness
        (h, w), at the working size, what the front view should cover: foliage and traced branches.
    """

    camera: Camera
    grown: Grown
    envelope: Envelope
    bark: Surface
    leaf: Surface | None
    cards: Leaves | None
    atlas: Atlas | None
    likeness: Mask
    foliage_kind: Kind
    iterations: int
    branches: int
    measures: Measures
    score: dict[str, float]
    warnings: tuple[StrokeWarning, ...]


OnGrown = Callable[[LiveTree], None]
"""Called once, with the tree as it stands when growth ends."""


def unseen(tree: LiveTree) -> None:
    """Show a grown tree to nobody."""


def trace_photo(photo: Photo, strokes: Strokes, known: Foliage | None = None) -> PhotoTrace:
    """Find the foliage and the visible branches of a photo (h, w, 3), sRGB.

    ``known`` is the foliage that an earlier trace of the same photo has seen in the same crown: it is kept, so that one
    more branch stroke is answered at once.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    """
    return _in_photo(see(photo, strokes, known))


def grow_photo(traced: PhotoTrace, settings: ModelSettings, rng: np.random.Generator) -> LiveTree | None:
    """Let what was traced grow as `model_photo` does; nothing grows without a branch stroke."""
    return None if traced.seen.traced is None else grow_tree(traced.seen, settings, rng).live


def model_photo(
    seen: Seen,
    settings: ModelSettings,
    rng: np.random.Generator,
    report: Report = silent,
    on_grown: OnGrown = unseen,
    leaf_picture: NDArray[np.uint8] | None = None,
) -> TreeModel:
    """Turn what was seen in a photo into a tree; other seeds give other trees of the same photo.

    ``report(stage, fraction)`` is called with the stages lift, grow, leaf and mesh; ``on_grown`` with the grown tree,
    before it has leaves and bark. ``leaf_picture`` (h, w, 4), sRGB with straight alpha, stalk down, is drawn instead of
    the species' leaf.

    Raises
    ------
    ValueError
        Nothing was traced, or the picture of a leaf is none or transparent.
    """
    tree = grow_tree(seen, settings, rng, report)
    on_grown(tree.live)
    report("leaf", 0.0)
    leaf, sprays, atlas = leaf_surface(seen, tree, settings, leaf_picture, rng, report)
    report("mesh", 0.0)
    bark = bark_surface(seen, tree, settings, rng, report)
    report("mesh", 1.0)
    grown = tree.grown
    return TreeModel(
        camera=tree.camera,
        grown=grown,
        envelope=tree.envelope,
        bark=bark,
        leaf=leaf,
        cards=sprays,
        atlas=atlas,
        likeness=tree.leafy | tree.wood,
        foliage_kind=tree.kind,
        iterations=settings.iterations,
        branches=_branch_count(grown.skeleton),
        measures=_measures(seen, tree, sprays, atlas),
        score={"attractors_reached": grown.attractors_reached, "depth_over_width": _depth_over_width(bark, leaf)},
        warnings=seen.sight.warnings,
    )


def _in_photo(seen: Seen) -> PhotoTrace:
    """Bring what was seen to the photo's own size."""
    scale, foliage, traced = seen.sight.scale, seen.foliage, seen.traced
    mask = cv2.resize(foliage.mask.astype(np.uint8), seen.sight.size, interpolation=cv2.INTER_NEAREST).astype(bool)
    if traced is None:
        return PhotoTrace(mask, seen, None, np.empty(0, dtype=np.int64), seen.sight.warnings)
    small = traced.skeleton
    full = Skeleton(small.points / scale, small.radii / scale, small.parents)
    return PhotoTrace(mask, seen, full, traced.stroke, seen.sight.warnings)


def _measures(seen: Seen, tree: GrownTree, leaves: Leaves | None, atlas: Atlas | None) -> Measures:
    """Measure the tree as it was grown, by the scale that the strokes or the height set."""
    sight, metres = seen.sight, tree.envelope.camera.metres_per_pixel
    known, error = sight.strokes.scale, 0.0
    if known is not None:
        ends_px = ENDS_PX * max(sight.photo.shape) / WORKING_SIDE
        error = min(0.9, ends_px / float(np.hypot(*(known.points[1] - known.points[0]))))
    scale = Scale(metres * sight.scale, known is not None, error)
    crown = None if leaves is None else leaves.centres
    area = 0.0 if leaves is None or atlas is None else leaf_area(leaves, atlas)
    unbulged = tree.envelope.widened(1 / BULGE)
    height = sight.height_px(seen.foliage.mask) * metres
    return measure_tree(tree.grown.skeleton, height, _trunk_seen(tree, metres), crown, area, unbulged, scale)


def _trunk_seen(tree: GrownTree, metres_per_pixel: float) -> bool:
    """Tell whether the photo shows how thick the trunk is at breast height."""
    trunk = first_stem(tree.traced)
    heights = (tree.traced.skeleton.points[trunk[0], 1] - tree.traced.skeleton.points[trunk, 1]) * metres_per_pixel
    return bool(tree.traced.measured[trunk[np.abs(heights - BREAST_HEIGHT).argmin()]])


def _branch_count(tree: Skeleton) -> int:
    """Count a tree's branches: its stems and whatever leaves a fork."""
    counts = np.bincount(tree.parents[tree.parents >= 0], minlength=len(tree))
    return int((tree.parents < 0).sum() + np.maximum(counts - 1, 0).sum())


def _depth_over_width(bark: Surface, leaf: Surface | None) -> float:
    """Compare the tree's depth with its width, 2nd to 98th percentile of its (leaf) vertices."""
    points: Floats = (bark if leaf is None else leaf).mesh.positions.astype(np.float64)
    low, high = np.percentile(points[:, [0, 2]], [2, 98], axis=0)
    return float((high[1] - low[1]) / max(float(high[0] - low[0]), 1e-9))
