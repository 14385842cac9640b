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
from treestroke.core.leaf.atlas import Atlas, leaf_atlas
from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.leaf.placement import LeafParams, place_leaves
from treestroke.core.mesh.bark import BarkParams, bark_texture
from treestroke.core.mesh.tubes import tubes
from treestroke.core.pipeline.growing import GrownTree, LiveTree, Seen, drawn_depth, grow_tree, see
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sight import Mask, Photo, Sight
from treestroke.core.progress import Report, silent
from treestroke.core.segment.foliage import Foliage
from treestroke.core.segment.kind import Kind
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Strokes, StrokeWarning
from treestroke.core.trace.tracing import Traced

BARE_BREADTH = 0.5
"""Of a visible branch's width: no leaf hangs before it there. More would show sky where the grown wood is thinner."""


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
    photo: Photo,
    strokes: Strokes,
    settings: ModelSettings,
    rng: np.random.Generator,
    report: Report = silent,
    on_grown: OnGrown = unseen,
) -> TreeModel:
    """Turn a photo (h, w, 3), sRGB, and its strokes (one branch at least) into a tree.

    ``report(stage, fraction)`` is called with the stages foliage, trace, lift, grow, leaf and mesh; ``on_grown`` with
    the grown tree, before it has leaves and bark.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    """
    seen = see(photo, strokes, None, report)
    sight, foliage = seen.sight, seen.foliage
    tree = grow_tree(seen, settings, rng, report)
    on_grown(tree.live)
    report("leaf", 0.0)
    leaf, sprays, atlas = _leaf(sight, foliage, _front(foliage, tree), tree, settings, rng, report)
    report("mesh", 0.0)
    wrapping = tubes(tree.grown.skeleton)
    report("mesh", 0.6)
    bark = Surface(wrapping, _bark_texture(sight, tree.traced, rng))
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
        likeness=foliage.mask | tree.wood,
        foliage_kind=tree.kind,
        iterations=settings.iterations,
        branches=_branch_count(grown.skeleton),
        score={"attractors_reached": grown.attractors_reached, "depth_over_width": _depth_over_width(bark, leaf)},
        warnings=sight.warnings,
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


def _leaf(
    sight: Sight,
    foliage: Foliage,
    front: NDArray[np.float32],
    tree: GrownTree,
    settings: ModelSettings,
    rng: np.random.Generator,
    report: Report,
) -> tuple[Surface, Leaves, Atlas] | tuple[None, None, None]:
    """Hang leaves on the grown tree: their surface, and what it is made from."""
    kind, leafy = tree.kind, np.isposinf(front)
    if kind == "bare" or settings.leaf_density == 0 or not leafy.any():
        return None, None, None
    pure = foliage.pure & leafy
    coloured = pure if pure.sum() > 0.1 * leafy.sum() else leafy
    atlas = leaf_atlas(sight.photo, coloured, kind, rng)
    report("leaf", 0.2)
    params = LeafParams(settings.leaf_size, settings.leaf_density, kind=kind)
    leaves = place_leaves(tree.grown.skeleton, front, tree.envelope, sight.photo, atlas, params, rng, report)
    return (Surface(cards(leaves, atlas), atlas.image), leaves, atlas) if len(leaves) else (None, None, None)


def _front(foliage: Foliage, tree: GrownTree) -> NDArray[np.float32]:
    """World Z (h, w), metres, behind which leaves may lie: infinite in the foliage, that of the wood where it is seen.

    What is a leaf by its colour hangs before the wood.
    """
    traced = tree.traced
    what = tree.visible, traced.measured[tree.owner], tree.depth_m, foliage.mask.shape
    wood, middle = drawn_depth(*what, 1.0), drawn_depth(*what, BARE_BREADTH)
    front = np.where(np.isnan(wood) | ~foliage.region, -np.inf, wood)
    front[foliage.mask & (np.isnan(middle) | (foliage.pure & ~traced.wood))] = np.inf
    return front.astype(np.float32)


def _bark_texture(sight: Sight, traced: Traced, rng: np.random.Generator) -> Photo:
    """Read the bark off the first stem's visible pixels."""
    trunk = _trunk(traced)
    radii = np.where(traced.measured[trunk], traced.skeleton.radii[trunk], 0.0)
    return bark_texture(sight.photo, traced.skeleton.points[trunk], radii, BarkParams(), rng)


def _trunk(traced: Traced) -> Indices:
    """Joints under the first stroke, root first."""
    return np.flatnonzero(traced.stroke == 0)


def _branch_count(tree: Skeleton) -> int:
    """Count a tree's branches: its stems and whatever leaves a fork."""
    counts = np.bincount(tree.parents[tree.parents >= 0], minlength=len(tree))
    return int((tree.parents < 0).sum() + np.maximum(counts - 1, 0).sum())


def _depth_over_width(bark: Surface, leaf: Surface | None) -> float:
    """Compare the tree's depth with its width, 2nd to 98th percentile of its (leaf) vertices."""
    points: Floats = (bark if leaf is None else leaf).mesh.positions.astype(np.float64)
    low, high = np.percentile(points[:, [0, 2]], [2, 98], axis=0)
    return float((high[1] - low[1]) / max(float(high[0] - low[0]), 1e-9))
