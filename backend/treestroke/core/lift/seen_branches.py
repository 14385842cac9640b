"""The branches that the shots of a capture show: points, graph, centre lines, skeleton."""

from collections.abc import Sequence
from dataclasses import dataclass

from treestroke.core.capture import PointCloud, Shot, TreeMatte, evenly
from treestroke.core.errors import TreestrokeError
from treestroke.core.lift.branch_points import is_branch
from treestroke.core.lift.centre_lines import centre_lines
from treestroke.core.lift.explained import OWN_BARE, OWN_SHARE, explained
from treestroke.core.lift.path_skeleton import path_skeleton
from treestroke.core.lift.point_graph import FINE, FINE_BARE, point_graph
from treestroke.core.lift.thin_hull import ShownArea, shown_area
from treestroke.core.progress import Report, silent
from treestroke.core.side_by_side import side_by_side
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Mask

BARE = 0.9
"""Share of the tree's pixels that are wood from which it is bare."""
MOST_SHOTS = 30
"""Shots, evenly spread, by which branches are found: 28 bytes for each of their pixels are at hand all the time."""

WOODEN = 0.5
"""How likely what a shot shows must be wood to be taken for it."""


@dataclass(frozen=True, eq=False)
class SeenBranches:
    """The visible branches.

    Attributes
    ----------
    skeleton
        The trunk and all that leaves it, one piece, 3D, metres, measured radii; joint 0 is the root, the origin.
    seen
        (n,) whether wood is seen at each joint; the others join clusters.
    leaf_points
        (m, 3) points of the cloud on leaves, metres.
    """

    skeleton: Skeleton
    seen: Mask
    leaf_points: Floats


def seen_branches(
    shots: Sequence[Shot], mattes: Sequence[TreeMatte], cloud: PointCloud, report: Report = silent
) -> SeenBranches:
    """Find the branches that are seen, in the tree's frame: metres, Y up, the root at the origin.

    ``report("branches", fraction)`` is called with each step. Deterministic.

    Source: Tan et al. 2007, section 5.1. The graph's places are not only the cloud's points, which lie on few limbs,
    but all small cells that more shots show as wood than would by chance; paths keep to the middle of the wood, so a
    path is a centre line without bins; of the branches where silhouettes cross by chance, those go that explain no
    pixel of their own. The radius is measured by the mattes. Joints of a bare tree are moved onto the middle of the
    wood in the shots, to less than a cell, and tips go on as far as the shots show wood.

    Raises
    ------
    TreestrokeError
        No wood is seen in enough shots.
    """
    bare = sum(float(matte.wood.sum()) for matte in mattes) > BARE * sum(float(matte.tree.sum()) for matte in mattes)
    pairs = [(shots[place], mattes[place]) for place in evenly(len(shots), MOST_SHOTS)]
    tree = side_by_side(lambda pair: shown_area(pair[0], pair[1].tree, pair[1].tree, pair[1].hidden), pairs)
    shown = list(zip(tree, (matte for _, matte in pairs), strict=True))
    wood = side_by_side(lambda pair: _wood(*pair), shown)
    report("branches", 0.1)
    graph = point_graph(wood, tree, FINE_BARE if bare else FINE)
    report("branches", 0.5)
    lines = centre_lines(graph)
    if not lines.paths:
        raise TreestrokeError("no trunk is seen in enough photos: mark it with a branch stroke in two or three of them")
    report("branches", 0.7)
    kept = explained(lines, graph, wood, OWN_BARE if bare else OWN_SHARE)
    skeleton, seen = path_skeleton(graph, lines, kept, wood, bare)
    report("branches", 1.0)
    return SeenBranches(skeleton, seen, cloud.points[~is_branch(cloud, shots, mattes)])


def _wood(tree: ShownArea, matte: TreeMatte) -> ShownArea:
    """Return what a shot shows of the wood, by what it shows of the tree; that itself where all is wood."""
    wood = matte.tree & (matte.wood >= WOODEN)
    return tree if (wood == matte.tree).all() else shown_area(tree.shot, matte.tree, wood, matte.hidden)
