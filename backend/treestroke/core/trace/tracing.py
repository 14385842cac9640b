"""From branch strokes to the visible branches, as a Skeleton in the photo.

Source: Tan et al. 2008, section 2. Strokes are pulled onto the branches in the photo, further limbs are found along
ribbons of wood, radii are measured where the photo shows them.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from treestroke.core.geometry.polyline import arc_lengths, normals
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.skeleton.edit import subskeleton
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.stroke_rules import TOUCH_SHARE, is_stem
from treestroke.core.strokes import Stroke, Strokes
from treestroke.core.trace.appearance import Odds, Surroundings, wood_odds
from treestroke.core.trace.crown_picture import CrownPicture
from treestroke.core.trace.found_limbs import find_limbs
from treestroke.core.trace.skeleton_builder import SkeletonBuilder, drop_subtrees, simplify
from treestroke.core.trace.snapping import blur, snap
from treestroke.core.trace.thickness import half_widths, non_increasing
from treestroke.core.types import Floats, Indices, Mask, Picture

REFERENCE_SIDE = 1500
"""Long side of a photo to which pixel figures refer, px."""
CONE, TAPER = 1.25, 0.75
"""A limb lies within a cone: its base has this multiple of the limb's first radius, and it loses this share of it over
the tree's height. So neighbours of its own colour do not widen the limb."""
STEADY = 4.0
"""Standard deviation, in steps of a line, over which its place in the wood is averaged."""
MIN_EXPECTED = 0.5
"""Least measured radius relative to the expected one: less is a sliver of the branch between leaves."""
MIN_SEEN = 4
"""Least number of places along a line where its width must be seen for it to count."""
GRAIN = 1.5
"""Standard deviation, px of a long side of 1500, over which branch odds are averaged: the grain of bark."""
GIANT_SHARE, GIANT_GRAIN = 0.4, 0.008
"""Greatest radius of a giant trunk, and the width of cracks in its bark that are closed, as shares of the height."""
FEW_SIDES, MOST_SIDES = 0.1, 0.7
"""A trunk is a giant if its sides are seen within the usual radius at fewer places below the crown than the first
share (a baobab 0.00; the 20 other photos 0.27 and more), and within a giant's at more than the second."""
GIANT_FREE = 0.2
"""Least length of a giant's stem below the crown, as a share of the height: over less, its ground may deceive."""
GIANT_STEADY = 20.0
"""Standard deviation, in steps of a line, over which a giant's is straightened: roots and buttresses do not bend it."""
MAX_SWELLING = 1.8
"""Greatest measured radius relative to the line's median: more is a shadow beside the branch."""
CHILD_RADIUS = 0.75
"""Radius of a branch relative to its parent where it is not seen (Tan et al. 2008, section 2)."""


@dataclass(frozen=True)
class TraceParams:
    """How branches are traced; px are those of a photo whose long side is 1500, shares are of the tree's height.

    Attributes
    ----------
    snap_share
        Greatest distance by which a stroke is pulled aside.
    tolerance_share
        Greatest distance by which simplification moves the line.
    trunk_share
        Radius of a trunk that the photo does not show (a diameter of 1/30).
    thickest_share
        Greatest usual radius of a trunk.
    thinnest_px
        Least radius of a traced branch.
    """

    snap_share: float = 0.015
    tolerance_share: float = 0.002
    trunk_share: float = 0.017
    thickest_share: float = 0.065
    thinnest_px: float = 1.5

    def __post_init__(self) -> None:
        if min(self.snap_share, self.trunk_share, self.thinnest_px) <= 0 or self.tolerance_share < 0:
            raise ValueError(f"tracing parameters must be positive: {self}")


@dataclass(frozen=True, eq=False)
class Traced:
    """The visible branches.

    Attributes
    ----------
    skeleton
        2D, photo px; joint 0 is the root.
    stroke
        (n,) index of the branch stroke that each joint follows, -1 where the tracer found it.
    measured
        (n,) mask of the joints whose radius the photo shows.
    wood
        (h, w) mask of the pixels that have the colours of branches, or lie on a limb that is seen.
    picture
        What the crown shows of limbs, whatever strokes are drawn.
    """

    skeleton: Skeleton
    stroke: Indices
    measured: Mask
    wood: Mask
    picture: CrownPicture

    @property
    def stroked(self) -> "Traced":
        """The branches that follow a stroke, without those that were found beside them."""
        skeleton, joints = subskeleton(self.skeleton, self.stroke >= 0)
        return replace(self, skeleton=skeleton, stroke=self.stroke[joints], measured=self.measured[joints])


@dataclass(frozen=True, eq=False)
class _Evidence:
    """What a stroke is judged by.

    Odds by the strokes' colours and the wood by them (h, w), to which a stroke is pulled; the wood by the crown's odds,
    whose width is measured; the crown (h, w), and the tree's height, px.
    """

    odds: Odds
    sure_wood: Mask
    wood: Mask
    crown: Mask
    height_px: float


@dataclass(frozen=True, eq=False)
class _SeenWidths:
    """Half-widths (n,) measured along a line, px, NaN where unseen, and a mask (n,) of the places below the crown."""

    halves: Floats
    bare: Mask


def trace_branches(
    photo: Picture,
    strokes: Strokes,
    surroundings: Surroundings,
    picture: CrownPicture,
    params: TraceParams = TraceParams(),
) -> Traced:
    """Trace the branches under and beside the branch strokes (one at least) of a photo (h, w, 3), sRGB.

    ``picture`` shows its crown. Every stroke is followed over its whole length; branches found beside the strokes are
    connected with them. Source: Tan et al. 2008, section 2, "Visible branch tracing".
    """
    height_px = picture.tree_px
    unit = max(photo.shape[:2]) / REFERENCE_SIDE
    odds = wood_odds(photo, [s.points for s in strokes.branches], max(1.0, 2.0 * unit), surroundings)
    smooth = _smoothed(odds.by_crown, unit)
    wood = smooth > 0
    builder = SkeletonBuilder()
    sure_wood = _smoothed(odds.by_strokes, unit) > 0
    evidence = _Evidence(odds.by_strokes, sure_wood, wood, surroundings.crown, height_px)
    _follow_strokes(builder, strokes.branches, evidence, params)
    thinnest_px = params.thinnest_px * height_px / REFERENCE_SIDE
    wood |= find_limbs(builder, picture, odds.by_crown, smooth, thinnest_px)
    skeleton, stroke = _erase(builder.skeleton(), np.array(builder.stroke), strokes.erase)
    skeleton, stroke = simplify(skeleton, stroke, params.tolerance_share * height_px)
    return Traced(skeleton, stroke, _on_wood(skeleton, wood), wood, picture)


def _smoothed(odds: Odds, unit: float) -> Odds:
    """Average log odds (h, w) over the grain of bark, in a photo whose long side is ``unit`` times 1500 px."""
    return np.asarray(cv2.GaussianBlur(odds, (0, 0), max(0.7, GRAIN * unit)), dtype=np.float32)


def _follow_strokes(
    builder: SkeletonBuilder, branches: tuple[Stroke, ...], evidence: _Evidence, params: TraceParams
) -> None:
    """Add each stroke's line, pulled onto its branch, to the skeleton."""
    height_px, wood = evidence.height_px, evidence.wood
    reach, step = params.snap_share * height_px, max(1.0, 0.006 * height_px)
    smooth_odds = np.asarray(cv2.GaussianBlur(evidence.odds, (0, 0), max(0.8, 0.3 * reach)), dtype=np.float32)
    root = branches[0].points[0]
    for index, stroke in enumerate(branches):
        start = root if index == 0 else None
        snapped = snap(stroke.points, smooth_odds, reach, step)
        line = _centre(snapped, evidence.sure_wood, params.thickest_share * height_px, start)
        stands = is_stem(stroke, branches[:index], height_px, TOUCH_SHARE * max(wood.shape))
        parent = -1 if stands else builder.nearest(line[0])
        parent_px = params.trunk_share * height_px / CHILD_RADIUS if stands else builder.radii[parent]
        widest = params.thickest_share * height_px if stands else 1.2 * parent_px
        below = np.logical_and.accumulate(~sample_nearest(evidence.crown, line, False))
        if stands and _is_giant(line[below], wood, widest, height_px):
            wood, widest = _without_cracks(wood, height_px), GIANT_SHARE * height_px
            line = _centre(blur(snapped, GIANT_STEADY), wood, widest, start, GIANT_STEADY)
        seen = _SeenWidths(half_widths(line, wood, widest)[0], below)
        radii = _radii(line, stroke.width, seen, parent_px, height_px)
        radii = np.maximum(radii, params.thinnest_px * height_px / REFERENCE_SIDE)
        if parent >= 0:
            line = np.concatenate([builder.points[parent][None], line])
            radii = np.concatenate([radii[:1], radii])
        builder.add_chain(parent, line, radii, stroke=index)


def _is_giant(below: Floats, wood: Mask, usual_px: float, height_px: float) -> bool:
    """Return whether the photo shows a stem, by its line (n, 2) below the crown, to be thicker than is usual."""
    if len(below) < MIN_SEEN or arc_lengths(below)[-1] < GIANT_FREE * height_px:
        return False
    if (~np.isnan(half_widths(below, wood, usual_px)[0])).mean() > FEW_SIDES:
        return False
    halves, _ = half_widths(below, _without_cracks(wood, height_px), GIANT_SHARE * height_px)
    return bool((~np.isnan(halves)).mean() > MOST_SIDES)


def _without_cracks(wood: Mask, height_px: float) -> Mask:
    """Close the cracks in the bark of a giant, a mask (h, w) of wood."""
    return np.asarray(cv2.GaussianBlur(wood.astype(np.float32), (0, 0), GIANT_GRAIN * height_px) > 0.5)


def _centre(line: Floats, wood: Mask, most_px: float, root: Floats | None, steady: float = STEADY) -> Floats:
    """Move a line (n, 2) to the middle of the wood where that is seen; it begins at its root, if there is one."""
    _, middles = half_widths(line, wood, most_px)
    moved = line + blur(np.nan_to_num(middles), steady)[:, None] * normals(line)
    if root is None:
        return moved
    hold = np.maximum(1 - arc_lengths(line) / (3 * most_px), 0.0)[:, None]
    return np.asarray(moved + hold * (root - moved[0]))


def _radii(line: Floats, width: float | None, seen: _SeenWidths, parent_px: float, height_px: float) -> Floats:
    """Return the radii (n,) along a line, px: drawn, else measured, else 75 % of the parent's; they never grow outward.

    Measurements on bare wood below the crown, if there are enough, take the place of slivers among leaves.
    """
    share = arc_lengths(line) / max(float(arc_lengths(line)[-1]), 1e-9)
    if width is not None:
        return width / 2 * (1 - 0.6 * share)
    places = np.flatnonzero(~np.isnan(seen.halves))
    if len(places) < MIN_SEEN:
        return CHILD_RADIUS * parent_px * (1 - 0.7 * share)
    bare = places[seen.bare[places]]
    usual = float(np.median(seen.halves[bare if len(bare) >= MIN_SEEN else places]))
    expected = (usual if len(bare) >= MIN_SEEN else CHILD_RADIUS * parent_px) * (1 - 0.7 * share)
    measured = np.minimum(seen.halves[places], MAX_SWELLING * usual)
    radii = np.interp(np.arange(len(line)), places, non_increasing(measured))
    radii = np.minimum(radii, CONE * radii[0] * np.maximum(1 - TAPER * arc_lengths(line) / height_px, 1 - TAPER))
    hidden = share > share[places[-1]]
    radii[hidden] *= 1 - 0.7 * (share[hidden] - share[places[-1]])
    return np.asarray(np.maximum(radii, MIN_EXPECTED * expected))


def _erase(skeleton: Skeleton, stroke: Indices, erase: tuple[Stroke, ...]) -> tuple[Skeleton, Indices]:
    """Drop the traced branches (not the stroked ones) that an erase stroke crosses, with their descendants."""
    found = np.flatnonzero((stroke < 0) & (skeleton.parents >= 0))
    start, end = skeleton.points[skeleton.parents[found]], skeleton.points[found]
    crossed = np.zeros(len(found), dtype=bool)
    for line in erase:
        for first, last in zip(line.points[:-1], line.points[1:], strict=True):
            crossed |= _cross(start, end, first, last)
    return drop_subtrees(skeleton, stroke, found[crossed])


def _cross(start: Floats, end: Floats, first: Floats, last: Floats) -> Mask:
    """Return a mask (n,) of the segments from (n, 2) to (n, 2) that cross the one from ``first`` to ``last`` (2,)."""
    apart = _side(start, end, first) * _side(start, end, last) <= 0
    return np.asarray(apart & (_side(first, last, start) * _side(first, last, end) <= 0))


def _side(origin: Floats, toward: Floats, point: Floats) -> Floats:
    """Return the cross product (...,) that tells on which side of a line, by two points (..., 2), a point lies."""
    along, away = toward - origin, point - origin
    return np.asarray(along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0])


def _on_wood(skeleton: Skeleton, wood: Mask) -> Mask:
    """Return a mask (n,) of the joints where the photo shows wood."""
    column, row = np.floor(skeleton.points).astype(np.int64).T
    inside = np.clip(row, 0, wood.shape[0] - 1), np.clip(column, 0, wood.shape[1] - 1)
    return np.asarray(wood[inside])
