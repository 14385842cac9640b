"""From branch strokes to the visible branches, as a Skeleton in the photo.

Source: Tan et al. 2008, section 2. Strokes are pulled onto the branches in the photo, further limbs are found along
ribbons of wood, radii are measured where the photo shows them.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from treestroke.core.geometry.polyline import arc_lengths, normals, resample
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.skeleton.edit import subskeleton
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.stroke_rules import TOUCH_SHARE, is_stem
from treestroke.core.strokes import Stroke, Strokes
from treestroke.core.trace.appearance import Odds, Surroundings, wood_odds
from treestroke.core.trace.bare_crown import TOLERANCE_PX, find_twigs, odds_of_share
from treestroke.core.trace.crown_picture import CrownPicture
from treestroke.core.trace.foot import flared, leaves_photo
from treestroke.core.trace.found_limbs import drawn_ribbons, find_limbs
from treestroke.core.trace.giant import fork_of, is_giant, upright
from treestroke.core.trace.shaded import shade_under
from treestroke.core.trace.skeleton_builder import SkeletonBuilder, drop_subtrees, simplify
from treestroke.core.trace.snapping import blur, snap
from treestroke.core.trace.stem_sides import FEWEST_BARE, bare_stem, joined
from treestroke.core.trace.stroke_radii import drawn_radii, limb_radii, stem_radii
from treestroke.core.trace.thickness import half_widths, to_edges
from treestroke.core.types import Floats, Indices, Mask, Picture

REFERENCE_SIDE = 1500
"""Long side of a photo to which pixel figures refer, px."""
CLEAR, BULKY = 0.7, 1.3
"""Share of a stem below the crown where its width must be seen by the colours of wood, up to such a multiple of the
greatest usual one, for its foot to be looked at (0.78 and more on 28 photos; less where all around it has its colours).
"""
STEADY = 4.0
"""Standard deviation, in steps of a line, over which its place in the wood is averaged."""
GRAIN = 1.5
"""Standard deviation, px of a long side of 1500, over which branch odds are averaged: the grain of bark."""
BLURRED = 4.5
"""How far a Gaussian blur reaches, in standard deviations."""

BESIDE = 0.45
"""A stem begins where its stroke does, up to this share of its radius beside the middle of the wood, or of the greatest
usual radius if it is a giant."""


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
    whole
        Whether all wood of a bare crown was traced.
    """

    skeleton: Skeleton
    stroke: Indices
    measured: Mask
    wood: Mask
    picture: CrownPicture
    whole: bool = False

    @property
    def stroked(self) -> "Traced":
        """The branches that follow a stroke, without those that were found beside them."""
        skeleton, joints = subskeleton(self.skeleton, self.stroke >= 0)
        return replace(self, skeleton=skeleton, stroke=self.stroke[joints], measured=self.measured[joints])


@dataclass(frozen=True, eq=False)
class _Evidence:
    """What a stroke is judged by.

    The photo (h, w, 3); odds by the strokes' colours and the wood by them (h, w), to which a stroke is pulled; the wood
    by the crown's odds, whose width is measured; the crown (h, w), the tree's height, px, and whether it was cut out.
    """

    photo: Picture
    odds: Odds
    sure_wood: Mask
    wood: Mask
    crown: Mask
    height_px: float
    cut_out: bool


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
    bare_wood, lines = surroundings.bare_wood, [stroke.points for stroke in strokes.branches]
    odds = wood_odds(photo, lines, max(1.0, 2.0 * unit), surroundings)
    if bare_wood is not None:
        odds = odds_of_share(odds, bare_wood, surroundings.crown)
    smooth = _smoothed(odds.by_crown, unit)
    wood = smooth > 0
    builder = SkeletonBuilder()
    sure_wood = _smoothed(odds.by_strokes, unit) > 0
    crown, cut_out = surroundings.crown, surroundings.cut_out
    evidence = _Evidence(photo, odds.by_strokes, sure_wood, wood, crown, height_px, cut_out)
    _follow_strokes(builder, strokes.branches, evidence, params)
    # The crown's own odds may miss a limb's shady side.
    wood |= sure_wood & drawn_ribbons(*builder.arrays(), wood.shape)
    if bare_wood is None and not surroundings.broad:
        wood &= ~shade_under(builder.strokes(), smooth, crown)
    if bare_wood is None:
        thinnest_px = params.thinnest_px * height_px / REFERENCE_SIDE
        wood |= find_limbs(builder, picture, odds.by_crown, smooth, thinnest_px)
    else:
        find_twigs(builder, bare_wood, surroundings.crown, height_px)
    skeleton, stroke = _erase(builder.skeleton(), np.array(builder.stroke), strokes.erase)
    tolerance_px = params.tolerance_share * height_px if bare_wood is None else TOLERANCE_PX
    skeleton, stroke = simplify(skeleton, stroke, tolerance_px)
    return Traced(skeleton, stroke, _on_wood(skeleton, wood), wood, picture, bare_wood is not None)


def _smoothed(odds: Odds, unit: float) -> Odds:
    """Average log odds (h, w) over the grain of bark, in a photo whose long side is ``unit`` times 1500 px."""
    return np.asarray(cv2.GaussianBlur(odds, (0, 0), max(0.7, GRAIN * unit)), dtype=np.float32)


def _follow_strokes(
    builder: SkeletonBuilder, branches: tuple[Stroke, ...], evidence: _Evidence, params: TraceParams
) -> None:
    """Add each stroke's line, pulled onto its branch, to the skeleton."""
    height_px = evidence.height_px
    reach, step = params.snap_share * height_px, max(1.0, 0.006 * height_px)
    for index, stroke in enumerate(branches):
        line, parent = _snapped(stroke.points, evidence.odds, reach, step), -1
        if is_stem(stroke, branches[:index], height_px, TOUCH_SHARE * max(evidence.wood.shape)):
            line, radii = _stem(line, stroke.points[0], evidence, params)
        else:
            parent, line, radii = _limb(builder, line, evidence, params)
        if stroke.width is not None:
            radii = drawn_radii(line, stroke.width)
        radii = np.maximum(radii, params.thinnest_px * height_px / REFERENCE_SIDE)
        builder.add_chain(parent, line, radii, stroke=index)


def _snapped(line: Floats, odds: Odds, reach: float, step: float) -> Floats:
    """Snap a stroke (n, 2), px, to log odds (h, w) averaged over a branch's width, which are needed around it alone."""
    sigma = max(0.8, 0.3 * reach)
    beside = int(np.ceil(reach + BLURRED * sigma)) + 1
    low = np.maximum(np.floor(line.min(axis=0)).astype(np.int64) - beside, 0)
    high = np.ceil(line.max(axis=0)).astype(np.int64) + beside
    box = slice(low[1], high[1]), slice(low[0], high[0])
    smooth = np.zeros_like(odds)
    smooth[box] = cv2.GaussianBlur(odds[box], (0, 0), sigma)
    return snap(line, smooth, reach, step)


def _stem(line: Floats, root: Floats, evidence: _Evidence, params: TraceParams) -> tuple[Floats, Floats]:
    """Return the line (n, 2) and the radii (n,), px, of a stem whose stroke is a line (n, 2) from a root (2,).

    It begins at the root, to which it leads over the height of its radius, or as low where the root is far beside the
    middle of the wood.
    """
    height_px, widest = evidence.height_px, params.thickest_share * evidence.height_px
    centred = _centre(line, evidence, widest)
    centred[0, 1] = root[1]
    bare = np.logical_and.accumulate(~sample_nearest(evidence.crown, centred, False))
    sides = half_widths(centred, evidence.wood, widest)
    seen = ~np.isnan(half_widths(centred[bare], evidence.wood, BULKY * widest)[0]) if bare.sum() > 1 else bare[:0]
    if is_giant(centred[bare], evidence.wood, widest, height_px):
        centred, level = upright(centred, bare, evidence.wood, height_px)
        halves = np.where(bare, level, half_widths(centred, evidence.wood, widest)[0])
    else:
        halves, _ = to_edges(centred, sides, evidence.photo, widest)
        if bare.sum() >= FEWEST_BARE:
            known = sides[0][bare & ~np.isnan(sides[0])]
            usual = float(np.median(known)) if len(known) else params.trunk_share * height_px
            reach = usual + params.snap_share * height_px
            below, halves[bare] = bare_stem(line[bare], evidence.photo, usual, reach)
            centred = joined(below, centred)
            centred[0, 1] = root[1]
    radii = stem_radii(centred, halves, bare, height_px, params.trunk_share * height_px)
    aside = root[0] - centred[0, 0]
    if abs(aside) < BESIDE * min(radii[0], widest):
        centred[:, 0] += aside * np.clip(1 - arc_lengths(centred) / radii[0], 0.0, 1.0)
    cut = leaves_photo(centred, radii, evidence.photo) and not evidence.cut_out
    return centred, radii if cut or seen.sum() <= CLEAR * len(seen) else flared(centred, radii, evidence.photo)


def _limb(
    builder: SkeletonBuilder, line: Floats, evidence: _Evidence, params: TraceParams
) -> tuple[int, Floats, Floats]:
    """Return the joint at which a limb begins, its line (n, 2) from there, and its radii (n,)."""
    line = _centre(line, evidence, params.thickest_share * evidence.height_px)
    parent = builder.nearest(line[0])
    parent_px = builder.radii[parent]
    axis = builder.stem_below(parent)
    points, radii = builder.arrays()
    away = np.hypot(*(line[:, None] - points[axis]).transpose(2, 0, 1)) - radii[axis]
    inside = np.logical_and.accumulate((away < 0).any(axis=1))
    halves, _ = to_edges(line, half_widths(line, evidence.wood, 1.2 * parent_px), evidence.photo, 1.2 * parent_px)
    widths = limb_radii(line, np.where(inside, np.nan, halves), parent_px)
    if parent_px > params.thickest_share * evidence.height_px and not inside.all():
        parent = int(axis[fork_of(line[~inside], points[axis], float(widths[~inside][0]))])
        within = resample(np.vstack([points[parent], line[~inside][0]]), GRAIN)[1:-1]
        line = np.concatenate([within, line[~inside]])
        widths = np.concatenate([np.full(len(within), widths[~inside][0]), widths[~inside]])
    return parent, np.concatenate([points[parent][None], line]), np.concatenate([widths[:1], widths])


def _centre(line: Floats, evidence: _Evidence, most_px: float) -> Floats:
    """Move a line (n, 2) to the middle of the wood where that is seen."""
    _, middles = to_edges(line, half_widths(line, evidence.sure_wood, most_px), evidence.photo, most_px)
    return np.asarray(line + blur(np.nan_to_num(middles), STEADY)[:, None] * normals(line))


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
