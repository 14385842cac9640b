"""System A: a 3D tree from one photo and a few strokes (Tan et al. 2008). The recipe reads top to bottom."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.envelope import Envelope, envelope_of_mask
from treestroke.core.geometry.mesh import Surface
from treestroke.core.geometry.polyline import Floats, Indices
from treestroke.core.grow.library import choose_library
from treestroke.core.grow.params import growth_for
from treestroke.core.grow.replacement import Grown, grow
from treestroke.core.leaf.atlas import leaf_atlas
from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.placement import LeafParams, place_leaves
from treestroke.core.lift.spread import lift
from treestroke.core.mesh.bark import BarkParams, bark_texture
from treestroke.core.mesh.tubes import tubes
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.progress import Report, silent
from treestroke.core.segment.foliage import Foliage, segment_foliage
from treestroke.core.segment.kind import Kind, foliage_kind
from treestroke.core.skeleton.edit import densified
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.stroke_rules import mend_strokes
from treestroke.core.strokes import Stroke, Strokes, StrokeWarning
from treestroke.core.trace.tracing import Traced, trace_branches

Photo = NDArray[np.uint8]
Mask = NDArray[np.bool_]

WORKING_SIDE = 1600
"""Long side, px, to which a larger photo is reduced: the paper's constants are for about 1500."""
JOINT_SHARE = 0.015
"""Of the tree's height: joints this near let growth cut a straight trunk where it likes."""
BULGE = 1.08
"""Radius of the crown's sections over half their width in the photo. A crown is no turned solid: away from the outline
that the photo shows some limbs reach further (4 trees known in 3D; 1.15 is too deep again for a slim one)."""
BARE_BREADTH = 0.5
"""Of a visible branch's width: no leaf hangs before it there. More would show sky where the grown wood is thinner."""
CLOSED_SHARE = {"leaves": 0.015, "needles": 0.035, "bare": 0.05}
"""Of the crown's size: holes and bays of the foliage this wide are no gaps in the crown for a branch."""


@dataclass(frozen=True, eq=False)
class PhotoTrace:
    """What strokes and photo tell together, in photo px.

    Attributes
    ----------
    foliage
        (h, w) leaf pixels.
    found
        The foliage with its colour models, at the working size.
    skeleton
        The visible branches; None without a branch stroke.
    stroke
        (n,) index of the stroke that each joint follows, -1 where it was found.
    warnings
        What was mended.
    """

    foliage: Mask
    found: Foliage
    skeleton: Skeleton | None
    stroke: Indices
    warnings: tuple[StrokeWarning, ...]


@dataclass(frozen=True, eq=False)
class TreeModel:
    """A finished tree: its surfaces in the world's frame, and what it was made from.

    ``likeness`` (h, w), at the working size, is what the front view should cover: foliage and traced branches.
    """

    camera: Camera
    grown: Grown
    bark: Surface
    leaf: Surface | None
    likeness: Mask
    foliage_kind: Kind
    iterations: int
    branches: int
    leaves: int
    score: dict[str, float]
    warnings: tuple[StrokeWarning, ...]


@dataclass(frozen=True, eq=False)
class _Sight:
    """The working copy of a photo: reduced by ``scale`` (1 or less), with mended strokes to match."""

    photo: Photo
    strokes: Strokes
    scale: float
    warnings: tuple[StrokeWarning, ...]


def trace_photo(photo: Photo, strokes: Strokes, known: Foliage | None = None) -> PhotoTrace:
    """Find the foliage and the visible branches of a photo (h, w, 3), sRGB.

    ``known`` is what an earlier trace ``found`` in the same photo with the same crown: it is kept, so that one more
    branch stroke is answered at once.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    """
    sight = _look(photo, strokes)
    foliage = known or segment_foliage(sight.photo, sight.strokes.crown.points)
    size = (photo.shape[1], photo.shape[0])
    mask = cv2.resize(foliage.mask.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST).astype(bool)
    if not strokes.branches:
        return PhotoTrace(mask, foliage, None, np.empty(0, dtype=np.int64), sight.warnings)
    traced = _trace(sight, foliage)
    full = Skeleton(traced.skeleton.points / sight.scale, traced.skeleton.radii / sight.scale, traced.skeleton.parents)
    return PhotoTrace(mask, foliage, full, traced.stroke, sight.warnings)


def model_photo(
    photo: Photo, strokes: Strokes, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> TreeModel:
    """Turn a photo (h, w, 3), sRGB, and its strokes (one branch at least) into a tree.

    ``report(stage, fraction)`` is called with the stages foliage, trace, lift, grow, leaf and mesh.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    """
    report("foliage", 0.0)
    sight = _look(photo, strokes)
    foliage = segment_foliage(sight.photo, sight.strokes.crown.points)
    kind = _kind(sight, foliage, settings)
    report("trace", 0.0)
    traced = _trace(sight, foliage)
    report("lift", 0.0)
    wood = _drawn(traced.skeleton, foliage.mask.shape)
    crown = _closed(foliage.mask | (wood & foliage.region), kind)
    camera = _camera(sight, foliage.mask, settings.height)
    envelope = envelope_of_mask(crown, camera)
    envelope = replace(envelope, radius_px=BULGE * envelope.radius_px)
    dense, owner = densified(traced.skeleton, JOINT_SHARE * _height_px(sight, foliage.mask))
    lifted = lift(dense, traced.stroke[owner], envelope, rng)
    report("grow", 0.0)
    library = choose_library(settings.library, kind, lifted)
    grown = grow(lifted, crown, envelope, library, growth_for(kind, settings.iterations), rng, report)
    report("leaf", 0.0)
    front = _front(foliage, traced.wood, dense, traced.measured[owner], lifted.points[:, 2])
    leaf, count = _leaf(sight, foliage, front, grown, envelope, kind, settings, rng, report)
    report("mesh", 0.0)
    bark = Surface(tubes(grown.skeleton), _bark_texture(sight, traced, rng))
    report("mesh", 1.0)
    return TreeModel(
        camera=_unreduced(camera, photo, sight.scale),
        grown=grown,
        bark=bark,
        leaf=leaf,
        likeness=foliage.mask | wood,
        foliage_kind=kind,
        iterations=settings.iterations,
        branches=_branch_count(grown.skeleton),
        leaves=count,
        score={"attractors_reached": grown.attractors_reached, "depth_over_width": _depth_over_width(bark, leaf)},
        warnings=sight.warnings,
    )


def _look(photo: Photo, strokes: Strokes) -> _Sight:
    """Mend the strokes and reduce a large photo, strokes and all."""
    height, width = photo.shape[:2]
    mended = mend_strokes(strokes, width, height)
    scale = min(1.0, WORKING_SIDE / max(height, width))
    if scale == 1.0:
        return _Sight(photo, mended.strokes, 1.0, mended.warnings)
    size = (max(1, round(width * scale)), max(1, round(height * scale)))
    small = cv2.resize(photo, size, interpolation=cv2.INTER_AREA)

    def reduced(strokes: tuple[Stroke, ...]) -> tuple[Stroke, ...]:
        return tuple(Stroke(s.points * scale, None if s.width is None else s.width * scale) for s in strokes)

    given = mended.strokes
    fitted = Strokes(reduced((given.crown,))[0], reduced(given.branches), reduced(given.erase))
    return _Sight(np.asarray(small, dtype=np.uint8), fitted, scale, mended.warnings)


def _trace(sight: _Sight, foliage: Foliage) -> Traced:
    """Trace the visible branches of a photo whose foliage is known."""
    height_px = _height_px(sight, foliage.mask)
    return trace_branches(sight.photo, sight.strokes, foliage.leaf, foliage.ground, foliage.region, height_px)


def _height_px(sight: _Sight, mask: Mask) -> float:
    """Measure the tree, px, from its root to its topmost leaf, or to the crown's top where there is no leaf."""
    rows = np.flatnonzero(mask.any(axis=1))
    top = float(rows[0]) if rows.size else float(sight.strokes.crown.points[:, 1].min())
    return max(float(sight.strokes.branches[0].points[0, 1]) - top, 1.0)


def _camera(sight: _Sight, mask: Mask, height_m: float) -> Camera:
    """Set the scale by the tree's height."""
    root = sight.strokes.branches[0].points[0]
    scale = height_m / _height_px(sight, mask)
    return Camera(sight.photo.shape[1], sight.photo.shape[0], scale, (float(root[0]), float(root[1])))


def _unreduced(camera: Camera, photo: Photo, scale: float) -> Camera:
    """Give the same camera for the photo at its own size."""
    root_x, root_y = camera.root_px
    return replace(
        camera,
        width=photo.shape[1],
        height=photo.shape[0],
        metres_per_pixel=camera.metres_per_pixel * scale,
        root_px=(root_x / scale, root_y / scale),
    )


def _kind(sight: _Sight, foliage: Foliage, settings: ModelSettings) -> Kind:
    """Take the kind that was asked for, or judge by the picture."""
    if settings.foliage == "auto":
        return foliage_kind(sight.photo, foliage.mask, foliage.region, sight.strokes.branches[0].points)
    kinds: dict[str, Kind] = {"leaves": "leaves", "needles": "needles", "bare": "bare"}
    return kinds[settings.foliage]


def _closed(mask: Mask, kind: Kind) -> Mask:
    """Close small holes and bays of a foliage mask."""
    size = max(3, int(2 * CLOSED_SHARE[kind] * np.sqrt(mask.sum())) | 1)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    edge = cv2.copyMakeBorder(mask.astype(np.uint8), size, size, size, size, cv2.BORDER_CONSTANT, value=0)
    return cv2.morphologyEx(edge, cv2.MORPH_CLOSE, kernel)[size:-size, size:-size].astype(bool)


def _leaf(
    sight: _Sight,
    foliage: Foliage,
    front: NDArray[np.float32],
    grown: Grown,
    envelope: Envelope,
    kind: Kind,
    settings: ModelSettings,
    rng: np.random.Generator,
    report: Report,
) -> tuple[Surface | None, int]:
    """Hang leaves on the grown tree: their surface and their number."""
    if kind == "bare" or settings.leaf_density == 0 or not np.isposinf(front).any():
        return None, 0
    leafy = np.isposinf(front)
    pure = foliage.pure & leafy
    coloured = pure if pure.sum() > 0.1 * leafy.sum() else leafy
    atlas = leaf_atlas(sight.photo, coloured, kind, rng)
    params = LeafParams(settings.leaf_size, settings.leaf_density, kind=kind)
    leaves = place_leaves(grown.skeleton, front, envelope, sight.photo, atlas, params, rng, report)
    return (Surface(cards(leaves, atlas), atlas.image), len(leaves)) if len(leaves) else (None, 0)


def _front(foliage: Foliage, woody: Mask, tree: Skeleton, seen: Mask, depth_m: Floats) -> NDArray[np.float32]:
    """World Z (h, w), metres, behind which leaves may lie: infinite in the foliage, that of the wood where it is seen.

    ``woody`` (h, w) has the colours of branches, ``tree`` is the traced skeleton, px, ``seen`` (n,) where it shows,
    ``depth_m`` (n,) its world Z. What is a leaf by its colour hangs before the wood.
    """
    wood = _drawn_depth(tree, seen, depth_m, foliage.mask.shape, 1.0)
    middle = _drawn_depth(tree, seen, depth_m, foliage.mask.shape, BARE_BREADTH)
    front = np.where(np.isnan(wood) | ~foliage.region, -np.inf, wood)
    front[foliage.mask & (np.isnan(middle) | (foliage.pure & ~woody))] = np.inf
    return front.astype(np.float32)


def _drawn(tree: Skeleton, shape: tuple[int, ...]) -> Mask:
    """Draw a traced skeleton as wide as its wood."""
    return ~np.isnan(_drawn_depth(tree, np.ones(len(tree), dtype=bool), np.zeros(len(tree)), shape, 1.0))


def _drawn_depth(
    tree: Skeleton, shown: Mask, depth_m: Floats, shape: tuple[int, ...], breadth: float
) -> NDArray[np.float32]:
    """Draw the depth of a skeleton's edges whose both joints are ``shown`` (n,), ``breadth`` times as wide as the wood.

    NaN where nothing is drawn.
    """
    drawn = np.full(shape, np.nan, np.float32)
    for joint, parent in enumerate(tree.parents.tolist()):
        if parent >= 0 and shown[joint] and shown[parent]:
            ends = [tuple(np.round((tree.points[at] - 0.5) * 16).astype(int).tolist()) for at in (parent, joint)]
            width = max(1, int(breadth * (tree.radii[joint] + tree.radii[parent])))
            cv2.line(drawn, ends[0], ends[1], float(depth_m[joint]), width, cv2.LINE_8, 4)
    return drawn


def _bark_texture(sight: _Sight, traced: Traced, rng: np.random.Generator) -> Photo:
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
