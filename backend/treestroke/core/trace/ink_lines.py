"""From the picture of a sketch to branch lines that grow from one another.

Source: the two-sketches paper, section 4; `centre_lines` says where ours differs. Beyond it, small gaps are bridged,
loops are cut, lines that cross are separated, and the ends that thinning shortens are extended again.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.errors import StrokesError
from treestroke.core.geometry.polyline import arc_lengths, place_at, places_along, resample, simplified, smoothed
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.strokes import StrokeWarning
from treestroke.core.trace.branch_lines import BranchLine, check_length, tree_height
from treestroke.core.trace.centre_lines import Graph, build_graph, drop_spurs, merge_crossings, thin
from treestroke.core.trace.gaps import bridge_gaps
from treestroke.core.trace.ink_branches import BranchPath, split_into_branches
from treestroke.core.trace.trunk_base import centre_trunk_base
from treestroke.core.types import Floats, Mask

WORKED_SIDE = 1600
"""Greatest long side, px, of the working copy of a picture."""
WORKED_HALF_WIDTH = 32.0
"""Greatest half width of a stroke, px, in the working copy."""
PINHOLE = 0.004
"""Side of the largest hole in the ink that is filled, as a share of the long side."""
PEN_PX = 3.5
"""Greatest median width of strokes, px, that are a pen's, so that they give no radius."""
WIDEST = 0.15
"""Greatest width of a stroke, as a share of the long side."""
MAX_PIXELS, MAX_ARCS = 100_000, 3_000
"""Greatest number of pixels of thinned lines, and of arcs between two forks."""
HALF_PIXEL = 0.25
"""Mean difference, px, between the distance transform at a stroke's middle pixel and the stroke's half width."""
AHEAD = 3.0
"""Greatest length, in half widths, by which a line's end is extended along its ink."""
MEET_PX = 1.0
"""Distance from its parent's line, px, at which a branch that is extended back meets it."""
PULLED = 0.6
"""Distance from a fork, in half widths there, within which thinning pulls lines aside."""
BENT = 0.7
"""Distance from the edge of its parent, in half widths of a branch, within which thinning bends the branch."""
CLEAR = 1.25
"""Distance from the parent's line, in half widths of the parent, beyond which a branch's own half width is measured."""
SMOOTH_PX, SMOOTH_RADII_PX = 1.5, 6.0
"""Standard deviation, px, over which points and radii of a line are smoothed."""
TOLERANCE_PX = 0.5
"""Greatest distance, px, of a dropped point from the simplified line."""


def follow_ink(ink: Mask) -> tuple[list[BranchLine], float, tuple[StrokeWarning, ...]]:
    """Follow the strokes of a picture (h, w); return lines, the tree's height, px, and warnings of repairs.

    The root is the lowest end of the largest drawing. Source: two-sketches paper, section 4.

    Raises
    ------
    StrokesError
        Nothing is drawn, or what is drawn does not consist of strokes or does not form a tree.
    """
    small, half_widths, scale = _reduced(ink)
    lines = thin(small)
    _check_amount(int(lines.sum()), MAX_PIXELS)
    lines, in_trunk, joined = bridge_gaps(lines, small, half_widths)
    # A thinned line may lie a pixel beside its stroke's middle, where the half width is greatest.
    graph = build_graph(lines, np.asarray(cv2.dilate(half_widths, np.ones((3, 3), np.uint8)), dtype=np.float32))
    _check_amount(len(graph.arcs), MAX_ARCS)
    graph = merge_crossings(drop_spurs(graph))
    if not graph.arcs:
        problem = "the picture has dots but no strokes; draw the trunk and the main branches as lines"
        raise StrokesError(problem, code="sketch_empty")
    paths, cuts = split_into_branches(graph, _root(graph, in_trunk))
    pen = 2 * float(np.median(half_widths[lines & small])) <= PEN_PX
    branches = _branch_lines(paths, small, pen, scale)
    canvas = ink.shape[1], ink.shape[0]
    height = tree_height(branches[0].points[0], np.concatenate([line.points for line in branches]), canvas)
    check_length(sum(float(arc_lengths(line.points)[-1]) for line in branches), height)
    warnings = [_warning(place * scale, "branch_joined") for place in joined]
    warnings += [_warning(place * scale, "loop_cut") for place in cuts]
    return branches, height, tuple(warnings)


def _check_amount(count: int, most: int) -> None:
    """Refuse a picture with more pixels or arcs than a sketch has."""
    if count > most:
        problem = "the picture has more lines than a sketch; draw the main branches only"
        raise StrokesError(problem, code="too_many_strokes")


def _reduced(ink: Mask) -> tuple[Mask, NDArray[np.float32], Floats]:
    """Return a working copy of the ink, its half widths, px, and the size of its pixels (2,) in canvas px.

    Thinning wide strokes takes long, and wide strokes need less detail.
    """
    small = _shrink(ink, max(1.0, max(ink.shape) / WORKED_SIDE))
    half_widths = _half_widths(small)
    widest = float(half_widths.max())
    if 2 * widest > WIDEST * max(small.shape):
        problem = (
            f"the picture has a patch wider than {WIDEST:.0%} of it, which is not a stroke; draw branches as lines"
        )
        raise StrokesError(problem, code="sketch_filled")
    if widest > WORKED_HALF_WIDTH:
        small = _shrink(ink, max(ink.shape) / max(small.shape) * widest / WORKED_HALF_WIDTH)
        half_widths = _half_widths(small)
    return small, half_widths, np.array(ink.shape[::-1]) / np.array(small.shape[::-1])


def _shrink(ink: Mask, factor: float) -> Mask:
    """Reduce ink by a factor so that lines one pixel wide stay, and fill pinholes."""
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
    """Return the distance (h, w), px, from each pixel of the ink to its edge; 0 outside the ink."""
    framed = cv2.copyMakeBorder(ink.astype(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
    away = cv2.distanceTransform(framed, cv2.DIST_L2, cv2.DIST_MASK_PRECISE, _aligned(framed.shape))[1:-1, 1:-1]
    return np.asarray(np.maximum(away - HALF_PIXEL, 0.0), dtype=np.float32)


def _aligned(shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Return an empty array at a multiple of 32 bytes: the last bits of OpenCV's square roots depend on its place."""
    size = int(np.prod(shape))
    memory = np.empty(size + 8, dtype=np.float32)
    first = -memory.ctypes.data % 32 // 4
    return memory[first : first + size].reshape(shape)


def _root(graph: Graph, in_trunk: Mask) -> int:
    """Return the node at the lowest end of the drawing with the trunk; in one without ends, its lowest fork."""
    places = {node: graph.place(node) for node in sorted(graph.at)}
    nodes = [node for node, place in places.items() if sample_nearest(in_trunk, place, False)] or list(places)
    ends = [node for node in nodes if len(graph.at[node]) == 1] or nodes
    return max(ends, key=lambda node: (places[node][1] + graph.radius(node), -node))


def _branch_lines(paths: list[BranchPath], ink: Mask, pen: bool, scale: Floats) -> list[BranchLine]:
    """Turn each path into a line in canvas px: smooth, with its ends extended."""
    lines: list[BranchLine] = []
    for path in paths:
        points, radii = _smooth(path)
        points, radii = _extend(points, radii, ink, root=path.parent < 0, tip=not path.cut)
        place = 0.0
        if path.parent >= 0:
            parent = lines[path.parent]
            points, radii = _straighten_base(points, radii, parent.points / scale, parent.radii / scale.mean())
            place = float(places_along(parent.points, points[:1] * scale)[0][0])
            points[0] = place_at(parent.points, place) / scale
        kept = simplified(np.column_stack([points, radii]), TOLERANCE_PX)
        wide = np.zeros(len(kept)) if pen else radii[kept] * float(scale.mean())
        lines.append(BranchLine(points[kept] * scale, wide, path.parent, place))
    return lines


def _straighten_base(points: Floats, radii: Floats, parent: Floats, parent_radii: Floats) -> tuple[Floats, Floats]:
    """Let a branch (n, 2) come straight from its parent's line (m, 2), px, and not from where thinning bends it to."""
    places, gaps = places_along(parent, points[: round(AHEAD * float(parent_radii.max())) + 2])
    within = np.interp(places, arc_lengths(parent), parent_radii)
    out = int(np.argmax(gaps > within))
    if out == 0 or out + 2 >= len(points):
        return points, radii
    wide = float(within[out])
    clear = int(np.argmax(gaps > CLEAR * within))
    radii = np.where(np.arange(len(radii)) < clear, radii[clear], radii)
    out = min(out + round(BENT * float(radii[out])), len(points) - 2)
    direction = points[out] - points[min(len(points) - 1, out + round(3 * float(radii[out]) + 4))]
    direction = direction / max(float(np.linalg.norm(direction)), 1e-9)
    back = points[out] + np.arange(0.0, 2.0 * wide + 1, 0.5)[:, None] * direction
    met = places_along(parent, back)[1] < MEET_PX
    bud = back[int(met.argmax())] if met.any() else place_at(parent, places_along(parent, points[out : out + 1])[0][0])
    return np.vstack([bud, points[out:]]), np.append(radii[out], radii[out:])


def _smooth(path: BranchPath) -> tuple[Floats, Floats]:
    """Smooth a path's pixel steps; its ends stay; at forks, where wider ink pulls it aside, it becomes straight."""
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


def _extend(points: Floats, radii: Floats, ink: Mask, root: bool, tip: bool) -> tuple[Floats, Floats]:
    """Extend a line (n, 2) to the end of the ink, at its root and its tip: thinning shortens it by about a radius."""
    if tip:
        end = _beyond(points, float(radii[-1]), ink)
        points, radii = np.vstack([points, end]), np.append(radii, np.repeat(radii[-1:], len(end)))
    if root:
        start = _beyond(points[::-1], float(radii[0]), ink)[::-1]
        points, radii = np.vstack([start, points]), np.append(np.repeat(radii[:1], len(start)), radii)
        return centre_trunk_base(points, radii, ink)
    return points, radii


def _beyond(points: Floats, radius: float, ink: Mask) -> Floats:
    """Return the end (0 or 1, 2) of the ink straight ahead of a line's last point, px."""
    back = points[max(0, len(points) - 1 - round(2 * radius + 4))]
    direction = points[-1] - back
    direction = direction / max(float(np.linalg.norm(direction)), 1e-9)
    steps = np.arange(0.5, AHEAD * radius + 2.0, 0.5)[:, None]
    inside = sample_nearest(ink, points[-1] + steps * direction, False)
    count = len(inside) if inside.all() else int(inside.argmin())
    return np.asarray(points[-1] + steps[count - 1 : count] * direction) if count else points[:0]


def _warning(place: Floats, code: str) -> StrokeWarning:
    """Return the warning of a repair at a place (2,), canvas px."""
    where = f"at ({place[0]:.0f}, {place[1]:.0f})"
    detail = f"a gap in the strokes {where} was bridged" if code == "branch_joined" else f"a loop was cut open {where}"
    return StrokeWarning(code, "picture", detail)
