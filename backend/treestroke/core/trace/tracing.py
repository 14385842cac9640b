"""From branch strokes to the visible branches, as a Skeleton in the photo.

Source: Tan et al. 2008, section 2. Strokes are pulled onto the branches that they mean, forks are found by the circle
tracer, radii are measured where the photo shows them.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import arc_lengths, normals
from treestroke.core.imaging.mixture import Mixture
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Stroke, Strokes
from treestroke.core.trace.appearance import branch_odds
from treestroke.core.trace.circle import Circle, trace_forks
from treestroke.core.trace.draft import Draft, simplify, without, without_spurs
from treestroke.core.trace.snapping import blurred, snap
from treestroke.core.trace.thickness import half_widths
from treestroke.core.types import Floats, Indices

REFERENCE_SIDE = 1500
CONE, TAPER = 1.25, 0.75
"""A limb lies within a cone that has lost the taper at the tree's height: neighbours of its own colour widen what is
measured, never the limb itself."""
STEADY = 4.0
"""Steps of a line over which its place in the wood is averaged."""
LEAST = 0.5
"""Of the radius that is expected unseen: less is a sliver of the branch between leaves."""
FEWEST_SEEN = 4
"""Places along a line where its width must be seen for it to count."""
GRAIN = 1.5
"""Bark's grain, px at a long side of 1500: colours are judged together over it."""
SWELLING = 1.8
"""A measured radius beyond this many times the line's usual one is a shadow beside the branch."""


@dataclass(frozen=True)
class TraceParams:
    """How branches are traced; px are those of a photo whose long side is 1500.

    Attributes
    ----------
    circle_px
        Radius of the circle tracer's circle.
    snap_share
        How far a stroke may be pulled aside, as a share of the tree's height.
    tolerance_share
        How far simplification may move the line, as a share of the tree's height.
    stem_share
        A later stroke that starts this near the root, as a share of the tree's height, is a stem of its own.
    trunk_share
        Radius of a trunk that the photo does not show, as a share of the tree's height (a diameter of 1/30).
    thickest_share
        Greatest radius that is believed of a trunk, as a share of the tree's height.
    thinnest_px
        Least radius of a traced branch.
    """

    circle_px: float = 50.0
    snap_share: float = 0.015
    tolerance_share: float = 0.002
    stem_share: float = 0.03
    trunk_share: float = 0.017
    thickest_share: float = 0.065
    thinnest_px: float = 1.5

    def __post_init__(self) -> None:
        if min(self.circle_px, self.snap_share, self.trunk_share, self.thinnest_px) <= 0 or self.tolerance_share < 0:
            raise ValueError(f"tracing parameters must be positive: {self}")


@dataclass(frozen=True, eq=False)
class Traced:
    """The visible branches.

    Attributes
    ----------
    skeleton
        In photo px; joint 0 is the root.
    stroke
        (n,) index of the branch stroke that each joint follows, -1 where the tracer found it.
    measured
        (n,) whether the photo showed the radius there.
    wood
        (h, w) pixels that have the colours of branches.
    """

    skeleton: Skeleton
    stroke: Indices
    measured: NDArray[np.bool_]
    wood: NDArray[np.bool_]


def trace_branches(
    photo: NDArray[np.uint8],
    strokes: Strokes,
    leaf: Mixture,
    ground: Mixture,
    crown: NDArray[np.bool_],
    height_px: float,
    params: TraceParams = TraceParams(),
) -> Traced:
    """Trace the branches under and beside the branch strokes (one at least) of a photo (h, w, 3), sRGB.

    ``leaf`` and ``ground`` are the colours of leaves and of what is behind them, ``crown`` (h, w) is where leaves may
    be; ``height_px`` is the tree's height, px. Every stroke is followed over its whole length; what the tracer finds
    beside them hangs together with them.
    """
    unit = max(photo.shape[:2]) / REFERENCE_SIDE
    odds = branch_odds(photo, [s.points for s in strokes.branches], max(1.0, 2.0 * unit), leaf, ground, crown)
    wood = cv2.GaussianBlur(odds, (0, 0), max(0.7, GRAIN * unit)) > 0
    draft = Draft()
    _follow_strokes(draft, strokes.branches, odds, wood, crown, height_px, params)
    seeds = _seeds(draft, params.circle_px * unit)
    trace_forks(draft, Circle(params.circle_px * unit, wood), seeds)
    skeleton, stroke = _erased(draft.skeleton(), np.array(draft.stroke), strokes.erase)
    skeleton, stroke = without_spurs(skeleton, stroke, 1.6 * params.circle_px * unit)
    skeleton, stroke = simplify(skeleton, stroke, params.tolerance_share * height_px)
    return Traced(skeleton, stroke, _seen(skeleton, wood), wood)


def _follow_strokes(
    draft: Draft,
    branches: tuple[Stroke, ...],
    odds: NDArray[np.float32],
    wood: NDArray[np.bool_],
    crown: NDArray[np.bool_],
    height_px: float,
    params: TraceParams,
) -> None:
    """Add each stroke's line, pulled onto its branch, to the draft."""
    reach, step = params.snap_share * height_px, max(1.0, 0.006 * height_px)
    evidence = np.asarray(cv2.GaussianBlur(odds, (0, 0), max(0.8, 0.3 * reach)), dtype=np.float32)
    root = branches[0].points[0]
    for index, stroke in enumerate(branches):
        start = root if index == 0 else None
        line = _centred(snap(stroke.points, evidence, reach, step), wood, params.thickest_share * height_px, start)
        stem = index == 0 or float(np.linalg.norm(stroke.points[0] - root)) <= params.stem_share * height_px
        parent = -1 if stem else draft.nearest(line[0])
        bearer = params.trunk_share * height_px / 0.75 if stem else draft.radii[parent]
        most = params.thickest_share * height_px if stem else 1.2 * bearer
        bare = ~sample_nearest(crown, line, False)
        radii = _radii(line, stroke.width, half_widths(line, wood, most)[0], bare, bearer, height_px)
        radii = np.maximum(radii, params.thinnest_px * height_px / REFERENCE_SIDE)
        if parent >= 0:
            line = np.concatenate([draft.points[parent][None], line])
            radii = np.concatenate([radii[:1], radii])
        draft.grow(parent, line, radii, stroke=index)


def _centred(line: Floats, wood: NDArray[np.bool_], most_px: float, root: Floats | None) -> Floats:
    """Move a line (n, 2) to the middle of the wood that it runs in, where that is seen; it begins at its root."""
    _, middles = half_widths(line, wood, most_px)
    moved = line + blurred(np.nan_to_num(middles), STEADY)[:, None] * normals(line)
    if root is None:
        return moved
    hold = np.maximum(1 - arc_lengths(line) / (3 * most_px), 0.0)[:, None]
    return np.asarray(moved + hold * (root - moved[0]))


def _radii(
    line: Floats, width: float | None, measured: Floats, bare: NDArray[np.bool_], bearer: float, height_px: float
) -> Floats:
    """Radius (n,) along a line: drawn, else measured, else 75 % of its bearer's; it tapers and never swells outward.

    What was measured where the wood is ``bare`` (n,), out of the crown, is believed rather than slivers among leaves.
    """
    share = arc_lengths(line) / max(float(arc_lengths(line)[-1]), 1e-9)
    if width is not None:
        return width / 2 * (1 - 0.6 * share)
    places = np.flatnonzero(~np.isnan(measured))
    if len(places) < FEWEST_SEEN:
        return 0.75 * bearer * (1 - 0.7 * share)
    sure = places[bare[places]]
    usual = float(np.median(measured[sure if len(sure) >= FEWEST_SEEN else places]))
    expected = (usual if len(sure) >= FEWEST_SEEN else 0.75 * bearer) * (1 - 0.7 * share)
    seen = np.minimum(measured[places], SWELLING * usual)
    radii = np.interp(np.arange(len(line)), places, _falling(seen))
    radii = np.minimum(radii, CONE * radii[0] * np.maximum(1 - TAPER * arc_lengths(line) / height_px, 1 - TAPER))
    hidden = share > share[places[-1]]
    radii[hidden] *= 1 - 0.7 * (share[hidden] - share[places[-1]])
    return np.asarray(np.maximum(radii, LEAST * expected))


def _falling(values: Floats) -> Floats:
    """Give the values (n,) nearest to the given ones that never rise (the min-max formula of isotonic regression)."""
    count = np.arange(len(values))
    sums = np.concatenate([[0.0], np.cumsum(values)])
    means = (sums[None, 1:] - sums[:-1, None]) / np.maximum(count[None] - count[:, None] + 1, 1)
    means[count[:, None] > count[None]] = -np.inf
    onward = np.maximum.accumulate(means[:, ::-1], axis=1)[:, ::-1]
    return np.asarray(np.minimum.accumulate(onward, axis=0).diagonal())


def _seeds(draft: Draft, radius_px: float) -> list[int]:
    """Pick joints a third of the circle's radius apart, bottom to top, stroke by stroke."""
    points = np.array(draft.points)
    step = float(np.median(np.linalg.norm(np.diff(points, axis=0), axis=1))) if len(points) > 1 else radius_px
    return list(range(0, len(points), max(1, int(radius_px / (3 * max(step, 1e-6))))))


def _erased(skeleton: Skeleton, stroke: Indices, erase: tuple[Stroke, ...]) -> tuple[Skeleton, Indices]:
    """Drop the traced branches, not the stroked ones, that an erase stroke crosses, with their descendants."""
    found = np.flatnonzero((stroke < 0) & (skeleton.parents >= 0))
    start, end = skeleton.points[skeleton.parents[found]], skeleton.points[found]
    crossed = np.zeros(len(found), dtype=bool)
    for line in erase:
        for first, last in zip(line.points[:-1], line.points[1:], strict=True):
            crossed |= _cross(start, end, first, last)
    return without(skeleton, stroke, found[crossed])


def _cross(start: Floats, end: Floats, first: Floats, last: Floats) -> NDArray[np.bool_]:
    """Tell which straight pieces (n, 2) to (n, 2) cross the piece from ``first`` to ``last``."""

    def side(origin: Floats, toward: Floats, point: Floats) -> Floats:
        way, away = toward - origin, point - origin
        return np.asarray(way[..., 0] * away[..., 1] - way[..., 1] * away[..., 0])

    apart = side(start, end, first) * side(start, end, last) <= 0
    return np.asarray(apart & (side(first, last, start) * side(first, last, end) <= 0))


def _seen(skeleton: Skeleton, wood: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Tell at which joints the photo shows wood."""
    column, row = np.floor(skeleton.points).astype(np.int64).T
    inside = np.clip(row, 0, wood.shape[0] - 1), np.clip(column, 0, wood.shape[1] - 1)
    return np.asarray(wood[inside])
