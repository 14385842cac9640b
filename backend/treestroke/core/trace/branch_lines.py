"""Branch lines, each growing from a parent line, and the skeleton of them all."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.errors import StrokesError
from treestroke.core.geometry.polyline import arc_lengths, place_at
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats

STEP = 0.008
"""Greatest distance between joints, as a share of the tree's height."""
SAME_PLACE = 0.0005
"""Distance, as a share of the tree's height, within which buds and bends share a joint."""
MAX_JOINTS = 10_000
"""Greatest number of joints of a skeleton."""
MIN_HEIGHT = 0.02
"""Least height of a drawing, as a share of the canvas's long side."""


@dataclass(frozen=True, eq=False)
class BranchLine:
    """One branch as it was drawn.

    Attributes
    ----------
    points
        (n, 2), n >= 2, px, from its place on its parent (the stem: from the root) to its tip.
    radii
        (n,) px, 0 where unknown.
    parent
        Index of the line that it grows from, an earlier one; -1 for the stem.
    place
        Where it begins, as a length along the parent, px.
    """

    points: Floats
    radii: Floats
    parent: int
    place: float


def tree_height(root: Floats, points: Floats, canvas: tuple[int, int]) -> float:
    """Return the height, px, of the topmost of the points (n, 2), px, above the root (2,).

    Raises
    ------
    StrokesError
        The points do not rise above the root.
    """
    height = float(root[1] - points[:, 1].min())
    if height < MIN_HEIGHT * max(canvas):
        problem = "the strokes do not rise above the lower end of the trunk; draw the tree upward from its root"
        raise StrokesError.at(("branches",), problem, "tree_flat")
    return height


def check_length(length: float, height: float) -> None:
    """Check that lines of a total length, px, fit `MAX_JOINTS` on a tree of the given height, px.

    Raises
    ------
    StrokesError
        They are too long.
    """
    most = MAX_JOINTS * STEP
    if length > most * height:
        problem = (
            f"all together they are {length / height:.0f} times as long as the tree is high, at most {most:.0f} times"
        )
        raise StrokesError.at(("branches",), f"{problem} is allowed; draw fewer or shorter ones", "strokes_too_long")


def join_lines(lines: list[BranchLine], height: float) -> Branched:
    """Join lines (the stem first, each after its parent) to one skeleton of a tree ``height`` px high.

    Joints are put at each line's points, at each bud, and between them so that none are further than `STEP` apart.

    Raises
    ------
    StrokesError
        The skeleton has more than `MAX_JOINTS` joints.
    """
    buds: list[list[float]] = [[] for _ in lines]
    for line in lines[1:]:
        buds[line.parent].append(line.place)
    points: list[Floats] = []
    radii: list[Floats] = []
    parents: list[int] = []
    branch: list[int] = []
    stations: list[tuple[Floats, list[int]]] = []
    for index, line in enumerate(lines):
        at = _stations(line, buds[index], height)
        joints = list(range(len(parents), len(parents) + len(at)))
        if line.parent >= 0:
            parent_at, parent_joints = stations[line.parent]
            joints = [parent_joints[int(np.abs(parent_at - line.place).argmin())], *joints[:-1]]
        own = at if line.parent < 0 else at[1:]
        points.append(place_at(line.points, own))
        radii.append(np.interp(own, arc_lengths(line.points), line.radii))
        parents += [-1, *joints[:-1]] if line.parent < 0 else joints[:-1]
        branch += [index] * len(own)
        stations.append((at, joints))
    if len(parents) > MAX_JOINTS:
        problem = f"all together they bend too often ({len(parents)} joints, at most {MAX_JOINTS}); draw them smoother"
        raise StrokesError.at(("branches",), problem, "strokes_too_long")
    return Branched(Skeleton(np.concatenate(points), np.concatenate(radii), np.array(parents)), np.array(branch))


def _stations(line: BranchLine, buds: list[float], height: float) -> Floats:
    """Return the places (m,), px along a line, of its joints: its ends, buds, bends, and evenly between them."""
    arcs = arc_lengths(line.points)
    near, fixed = SAME_PLACE * height, [0.0, float(arcs[-1])]
    for place in sorted([*buds]):
        if min(abs(place - other) for other in (fixed[0], fixed[1], fixed[-1])) > near:
            fixed.append(place)
    held = np.array(sorted(fixed))
    bends = arcs[np.abs(arcs[:, None] - held).min(axis=1) > near]
    at = np.sort(np.concatenate([held, bends]))
    at = at[np.append(True, np.diff(at) > 0)]
    parts = np.maximum(np.ceil(np.diff(at) / (STEP * height)), 1).astype(np.int64)
    within = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    between = np.repeat(at[:-1], parts) + within * np.repeat(np.diff(at) / parts, parts)
    return np.append(between, at[-1])
