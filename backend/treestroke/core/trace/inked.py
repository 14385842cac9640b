"""From the picture of a sketch to branches that grow from one another.

Source: the two-sketch paper, section 4, which see `centre_lines`. Beyond it: small gaps are bridged, loops are cut
where the way round is longest, lines that cross pass each other, and the ends that thinning eats are put back.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.errors import StrokesError
from treestroke.core.geometry.polyline import arc_lengths, place_at, places_along, resample, simplified, smoothed
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.strokes import StrokeWarning
from treestroke.core.trace.centre_lines import Graph, graph_of, thinned, with_crossings_joined, without_spurs
from treestroke.core.trace.foot import stood
from treestroke.core.trace.gaps import bridge_gaps
from treestroke.core.trace.lines import Line, check_length, tree_height
from treestroke.core.trace.spanning import Path, paths_of
from treestroke.core.types import Floats, Mask

WORKED_SIDE = 1600
"""Long side, px, at which a picture is worked on."""
WORKED_HALF_WIDTH = 32.0
"""Px, the greatest of a stroke that is worked on."""
PINHOLE = 0.004
"""Of the long side: smaller holes in the ink are none."""
PEN_PX = 3.5
"""Strokes whose usual width is no more are a pen's, which tells no radius."""
WIDEST = 0.15
"""Of the long side: a wider patch is no stroke."""
MOST_PIXELS, MOST_ARCS = 100_000, 3_000
"""Of thinned lines, and pieces of them between two forks."""
HALF_PIXEL = 0.25
"""By how much, on average, the distance from a stroke's middle pixel to the ground exceeds its half width."""
AHEAD = 3.0
"""Half widths of a line's end that its ink is followed further at most."""
OUT_PX = 1.0
"""As near to its bearer's line a branch that is led back meets it."""
PULLED = 0.6
"""Of the ink's half width at a fork: as far as a line there is pulled aside."""
BENT = 0.7
"""Of its own half width: as far from where a branch comes out of its bearer thinning bends it."""
CLEAR = 1.25
"""Of its half width: as far from its bearer's line a branch shows its own."""
SMOOTH_PX, SMOOTH_RADII_PX = 1.5, 6.0
BEND_PX = 0.5
"""As far as a line may leave its pixels' middles."""


def follow_ink(ink: Mask) -> tuple[list[Line], float, tuple[StrokeWarning, ...]]:
    """Follow the strokes of a picture (h, w); give lines, the tree's height, px, and what was mended, too.

    The root is the lowest end of the largest drawing.

    Raises
    ------
    StrokesError
        Nothing is drawn, what is drawn is no strokes, or they are no tree.
    """
    small, half_widths, scale = _reduced(ink)
    lines = thinned(small)
    _check_amount(int(lines.sum()), MOST_PIXELS)
    lines, in_trunk, joined = bridge_gaps(lines, small, half_widths)
    # Of a stroke an even number of pixels wide, or of a thinned line beside its middle, the neighbour knows the width.
    graph = graph_of(lines, np.asarray(cv2.dilate(half_widths, np.ones((3, 3), np.uint8)), dtype=np.float32))
    _check_amount(len(graph.arcs), MOST_ARCS)
    graph = with_crossings_joined(without_spurs(graph))
    if not graph.arcs:
        what = "the picture has dots but no strokes; draw the trunk and the main branches as lines"
        raise StrokesError(what, code="sketch_empty")
    paths, cuts = paths_of(graph, _root(graph, in_trunk))
    pen = 2 * float(np.median(half_widths[lines & small])) <= PEN_PX
    drawn = _drawn(paths, small, pen, scale)
    canvas = ink.shape[1], ink.shape[0]
    height = tree_height(drawn[0].points[0], np.concatenate([line.points for line in drawn]), canvas)
    check_length(sum(float(arc_lengths(line.points)[-1]) for line in drawn), height)
    return (
        drawn,
        height,
        (*(_told(p * scale, "branch_joined") for p in joined), *(_told(p * scale, "loop_cut") for p in cuts)),
    )


def _check_amount(count: int, most: int) -> None:
    if count > most:
        what = "the picture has more lines than a sketch; draw the main branches only"
        raise StrokesError(what, code="too_many_strokes")


def _reduced(ink: Mask) -> tuple[Mask, NDArray[np.float32], Floats]:
    """Bring ink to the size that is worked on: give it, its half widths there, px, and the canvas px of its pixels.

    Thinning wide strokes takes long, and what is wide need not be seen as finely.
    """
    small = _shrunk(ink, max(1.0, max(ink.shape) / WORKED_SIDE))
    half_widths = _half_widths(small)
    widest = float(half_widths.max())
    if 2 * widest > WIDEST * max(small.shape):
        what = f"the picture has a patch wider than {WIDEST:.0%} of it, which is no stroke; draw branches as lines"
        raise StrokesError(what, code="sketch_filled")
    if widest > WORKED_HALF_WIDTH:
        small = _shrunk(ink, max(ink.shape) / max(small.shape) * widest / WORKED_HALF_WIDTH)
        half_widths = _half_widths(small)
    return small, half_widths, np.array(ink.shape[::-1]) / np.array(small.shape[::-1])


def _shrunk(ink: Mask, factor: float) -> Mask:
    """Make ink smaller: a pixel is ink where the thinnest line would make it so; fill pinholes."""
    if not ink.any():
        raise StrokesError("the picture shows no strokes; draw the tree's main branches", code="sketch_empty")
    height, width = ink.shape
    size = max(1, round(width / factor)), max(1, round(height / factor))
    share = cv2.resize(ink.astype(np.uint8) * 255, size, interpolation=cv2.INTER_AREA)
    small = np.asarray(share > 127 / factor)
    _, labels, stats, _ = cv2.connectedComponentsWithStats((~small).astype(np.uint8), connectivity=4)
    holes = stats[:, cv2.CC_STAT_AREA] <= (PINHOLE * max(size)) ** 2
    holes[0] = False
    return np.asarray(small | holes[labels])


def _half_widths(ink: Mask) -> NDArray[np.float32]:
    """Measure from each pixel of the ink (h, w) to its edge, px; 0 on the ground."""
    framed = cv2.copyMakeBorder(ink.astype(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    away = cv2.distanceTransform(framed, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    return np.asarray(np.maximum(away - HALF_PIXEL, 0.0), dtype=np.float32)


def _root(graph: Graph, in_trunk: Mask) -> int:
    """Find the lowest end of the drawing that has the trunk; of one without ends, its lowest fork."""
    places = {node: graph.place(node) for node in sorted(graph.at)}
    own = [node for node, place in places.items() if sample_nearest(in_trunk, place, False)] or list(places)
    ends = [node for node in own if len(graph.at[node]) == 1] or own
    return max(ends, key=lambda node: (places[node][1] + graph.radius(node), -node))


def _drawn(paths: list[Path], ink: Mask, pen: bool, scale: Floats) -> list[Line]:
    """Give each path as a line in px of the canvas: smooth, with its ends put back."""
    drawn: list[Line] = []
    for path in paths:
        points, radii = _smooth(path)
        points, radii = _lengthened(points, radii, ink, root=path.bearer < 0, tip=not path.cut)
        place = 0.0
        if path.bearer >= 0:
            bearer = drawn[path.bearer]
            line = bearer.points / scale
            points, radii = _led_out(points, radii, line, bearer.radii / scale.mean())
            place = float(places_along(bearer.points, points[:1] * scale)[0][0])
            points[0] = place_at(bearer.points, place) / scale
        kept = simplified(np.column_stack([points, radii]), BEND_PX)
        wide = np.zeros(len(kept)) if pen else radii[kept] * float(scale.mean())
        drawn.append(Line(points[kept] * scale, wide, path.bearer, place))
    return drawn


def _led_out(points: Floats, radii: Floats, bearer: Floats, bearer_radii: Floats) -> tuple[Floats, Floats]:
    """Let a branch begin where it would if it came straight from its bearer's line, not where thinning bends it to."""
    places, gaps = places_along(bearer, points[: round(AHEAD * float(bearer_radii.max())) + 2])
    within = np.interp(places, arc_lengths(bearer), bearer_radii)
    out = int(np.argmax(gaps > within))
    if out == 0 or out + 2 >= len(points):
        return points, radii
    wide = float(within[out])
    clear = int(np.argmax(gaps > CLEAR * within))
    radii = np.where(np.arange(len(radii)) < clear, radii[clear], radii)
    out = min(out + round(BENT * float(radii[out])), len(points) - 2)
    way = points[out] - points[min(len(points) - 1, out + round(3 * float(radii[out]) + 4))]
    way = way / max(float(np.linalg.norm(way)), 1e-9)
    back = points[out] + np.arange(0.0, 2.0 * wide + 1, 0.5)[:, None] * way
    met = places_along(bearer, back)[1] < OUT_PX
    bud = back[int(met.argmax())] if met.any() else place_at(bearer, places_along(bearer, points[out : out + 1])[0][0])
    return np.vstack([bud, points[out:]]), np.append(radii[out], radii[out:])


def _smooth(path: Path) -> tuple[Floats, Floats]:
    """Take the pixels' steps out of a path; its ends stay; at forks, where ink is wider and pulls it, straight."""
    dense = resample(np.column_stack([path.points, path.radii]), 1.0)
    points, radii = dense[:, :2], dense[:, 2]
    at_fork, pulled = np.zeros((2, len(points)), dtype=bool)
    for fork in path.forks:
        gaps = np.linalg.norm(points - fork, axis=1)
        at_fork |= gaps < 1.2 * radii[gaps.argmin()]
        pulled |= gaps < PULLED * radii[gaps.argmin()]
    known = np.flatnonzero(~at_fork & (radii > 0))
    if len(known):
        radii = np.interp(np.arange(len(radii)), known, radii[known])
    pulled[[0, -1]] = False
    clear, every = np.flatnonzero(~pulled), np.arange(len(points))
    points = np.stack([np.interp(every, clear, column[clear]) for column in points.T], axis=1)
    smooth = smoothed(points, SMOOTH_PX)
    smooth[[0, -1]] = points[[0, -1]]
    return smooth, smoothed(radii, SMOOTH_RADII_PX)


def _lengthened(points: Floats, radii: Floats, ink: Mask, root: bool, tip: bool) -> tuple[Floats, Floats]:
    """Lead a line on to the end of the ink, at its root and its tip: thinning took about a radius."""
    if tip:
        end = _beyond(points, float(radii[-1]), ink)
        points, radii = np.vstack([points, end]), np.append(radii, np.repeat(radii[-1:], len(end)))
    if root:
        start = _beyond(points[::-1], float(radii[0]), ink)[::-1]
        points, radii = np.vstack([start, points]), np.append(np.repeat(radii[:1], len(start)), radii)
        return stood(points, radii, ink)
    return points, radii


def _beyond(points: Floats, radius: float, ink: Mask) -> Floats:
    """Give the end (0 or 1, 2) of the ink straight on from a line's last point."""
    back = points[max(0, len(points) - 1 - round(2 * radius + 4))]
    way = points[-1] - back
    way = way / max(float(np.linalg.norm(way)), 1e-9)
    steps = np.arange(0.5, AHEAD * radius + 2.0, 0.5)[:, None]
    inside = sample_nearest(ink, points[-1] + steps * way, False)
    count = len(inside) if inside.all() else int(inside.argmin())
    return np.asarray(points[-1] + steps[count - 1 : count] * way) if count else points[:0]


def _told(place: Floats, code: str) -> StrokeWarning:
    where = f"at ({place[0]:.0f}, {place[1]:.0f})"
    detail = f"a gap in the strokes {where} was bridged" if code == "branch_joined" else f"a loop was cut open {where}"
    return StrokeWarning(code, "picture", detail)
