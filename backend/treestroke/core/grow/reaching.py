"""Extends a grown tree to foliage that its branches did not reach."""

from dataclasses import replace

import cv2
import numpy as np

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette
from treestroke.core.grow.grown import Grown
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, child_counts
from treestroke.core.types import Floats, Indices, Mask

REACH = 0.03
"""Distance from the nearest branch in the picture, as a share of the tree's height, up to which its leaves cover the
foliage."""
SPACING = 0.02
"""Side of the squares, as a share of the tree's height, that get a joint each where their foliage is out of reach."""
CELLS = 6
"""Cells along such a square's side in which foliage and branches are counted."""
ON_EDGE = (1 / 3, 2 / 3, 1.0)
"""Shares of an edge's length at which it is marked."""
FILLED = 0.2
"""Share of a square that such foliage must fill."""
GOLDEN = 0.618
"""Golden section: the places chosen in one square after the other lie at its multiples, so that no grid shows."""
BALANCE = 0.4
"""Weight of a link's way along new twigs to the tree, over its own length: without it twigs wander."""
LONGEST = 0.1
"""Longest link, as a share of the tree's height, across foliage or a gap: what stands further off is another tree's."""
WITHIN, DEPTHS = 0.9, 33
"""Share of the crown's depth that new joints may use, and at how many depths foliage is looked for."""


def reaching(grown: Grown, foliage: Silhouette[Camera], volume: CrownVolume) -> Grown:
    """Add twigs to the foliage that lies out of reach of all branches in the picture: ends of boughs, mostly.

    Joints stand amid such foliage, in the picture and in depth, and links join them to the tree and to each other,
    those first that are short and lead to the tree on a short way: so twigs run along the foliage, and across a gap
    where it is narrow. They stand above the ground; none ends where the crown's ``volume`` has no foliage. What was
    there keeps its place and radius. The foliage does not include wood.

    Source: the minimum spanning tree, Prim 1957, balanced with the length of the way to its root, Cuntz et al. 2010,
    "One rule to grow them all".
    """
    tree, camera = grown.skeleton, foliage.camera
    joints_px = camera.pixels_from_world(tree.points)
    height_px = float(np.ptp(joints_px[:, 1]))
    amid = np.where(volume.admits(tree.points), tree.parents, -1)
    places_px = _out_of_reach(joints_px, amid, foliage.mask, height_px)
    places_px = places_px[camera.world_from_pixels(places_px)[:, 1] > tree.points[:, 1].min()]
    if len(places_px) == 0:
        return grown
    places = _amid_foliage(tree, np.flatnonzero(amid >= 0), places_px, camera, volume)
    places, parents = _linked(tree.points, places, LONGEST * float(np.ptp(tree.points[:, 1])))
    places, parents = _bearing(places, parents, len(tree), volume)
    if len(parents) == 0:
        return grown
    points, parents = np.vstack([tree.points, places]), np.concatenate([tree.parents, parents])
    born = np.concatenate([grown.born, np.full(len(places), grown.born.max() + 1)])
    return replace(grown, skeleton=Skeleton(points, _radii(tree, points, parents), parents), born=born)


def _out_of_reach(joints_px: Floats, parents: Indices, foliage: Mask, height_px: float) -> Floats:
    """Choose a place (m, 2), px, in each square amid foliage (h, w) out of reach of a tree's joints (n, 2), px."""
    cell_px = max(1.0, SPACING * height_px / CELLS)
    size = np.maximum(np.rint(np.array(foliage.shape[::-1]) / cell_px).astype(np.int64), 1)
    scale = size / foliage.shape[::-1]
    covered = cv2.resize(foliage.astype(np.uint8) * np.uint8(255), size.tolist(), interpolation=cv2.INTER_AREA) > 127
    free = np.ones(covered.shape, dtype=np.uint8)
    ends = np.flatnonzero(parents >= 0)
    start, end = joints_px[parents[ends]], joints_px[ends]
    for share in ON_EDGE:
        column, row = np.clip((start + share * (end - start)) * scale, 0, size - 1).astype(np.int64).T
        free[row, column] = 0
    away = cv2.distanceTransform(free, cv2.DIST_L2, 5)
    rows, columns = np.nonzero(covered & (away > REACH * height_px / cell_px))
    square = rows // CELLS * int(size[0]) + columns // CELLS
    order = np.argsort(square, kind="stable")
    first, count = np.unique(square[order], return_index=True, return_counts=True)[1:]
    first, count = first[count > FILLED * CELLS**2], count[count > FILLED * CELLS**2]
    chosen = order[first + np.floor(count * (GOLDEN * np.arange(len(count)) % 1)).astype(np.int64)]
    return np.asarray((np.stack([columns, rows], axis=1)[chosen] + 0.5) / scale)


def _amid_foliage(tree: Skeleton, amid: Indices, places_px: Floats, camera: Camera, volume: CrownVolume) -> Floats:
    """Place joints (m, 2), px, in the world (m, 3), metres, amid the volume's foliage.

    Where it stands at several depths, the one nearest to that of the nearest of the tree's joints ``amid`` it (k,) is
    taken.
    """
    amid = amid if len(amid) else np.arange(len(tree))
    joints_px, flat = camera.pixels_from_world(tree.points[amid]), camera.world_from_pixels(places_px)
    nearest = _nearest(joints_px, places_px)
    middle, half = camera.depth(volume.axis(flat[:, 1])), WITHIN * volume.half_depth(flat)
    depths = middle[:, None] + half[:, None] * np.linspace(-1, 1, DEPTHS)
    leafy = volume.admits(camera.world_from_pixels(np.repeat(places_px, DEPTHS, axis=0), depths.ravel()))
    away = np.abs(depths - camera.depth(tree.points[amid[nearest]])[:, None])
    best = np.where(leafy.reshape(depths.shape), away, away + away.max()).argmin(axis=1)
    return camera.world_from_pixels(places_px, depths[np.arange(len(depths)), best])


def _linked(joints: Floats, places: Floats, longest: float) -> tuple[Floats, Indices]:
    """Link places (m, 3), metres, to a tree's joints (n, 3) one by one: those reached (k, 3), and their parents (k,).

    Parents count from the tree's first joint on through the places, each after its parent.
    """
    nearest, columns = _nearest(joints, places), np.ascontiguousarray(places.T)
    away, before = np.sqrt(((places - joints[nearest]) ** 2).sum(axis=1)), np.zeros(len(places))
    waiting, order = np.ones(len(places), dtype=np.bool_), list[int]()
    for number in range(len(joints), len(joints) + len(places)):
        cost = np.where(waiting & (away <= longest), away + BALANCE * before, np.inf)
        place = int(cost.argmin())
        if np.isinf(cost[place]):
            break
        order.append(place)
        waiting[place], way = False, before[place] + away[place]
        distance = np.sqrt(_squares(columns, places[place]))
        closer = waiting & (distance + BALANCE * way < away + BALANCE * before)
        away[closer], before[closer], nearest[closer] = distance[closer], way, number
    return places[order], nearest[order]


def _nearest(points: Floats, places: Floats) -> Indices:
    """Find the nearest of points (n, d) to each place (m, d): (m,)."""
    columns = np.ascontiguousarray(points.T)
    return np.array([_squares(columns, place).argmin() for place in places], dtype=np.int64)


def _squares(columns: Floats, place: Floats) -> Floats:
    """Squared distances (n,) of points, given as columns (d, n), from a place (d,)."""
    away = columns - place[:, None]
    return np.asarray(np.multiply(away, away, out=away).sum(axis=0))


def _bearing(places: Floats, parents: Indices, first: int, volume: CrownVolume) -> tuple[Floats, Indices]:
    """Leave out new joints (k, 3), metres, that neither stand amid foliage nor lead to one that does.

    Their parents (k,) count from the tree's first joint on; ``first`` is the number of the first new one.
    """
    kept = np.concatenate([np.ones(first, dtype=np.bool_), volume.admits(places)])
    for joint in range(len(kept) - 1, first - 1, -1):
        kept[parents[joint - first]] |= kept[joint]
    number = np.cumsum(kept) - 1
    return places[kept[first:]], number[parents[kept[first:]]]


def _radii(tree: Skeleton, points: Floats, parents: Indices) -> Floats:
    """Radii of all joints (n,), metres: a new twig has the area of all ends that it bears, its branch's at most.

    Source: the pipe model, Shinozaki et al. 1964.
    """
    new = np.arange(len(points)) >= len(tree)
    whole = Skeleton(points, np.where(new, 0.0, np.resize(tree.radii, len(points))), parents)
    radii = tree.radii.min() * np.sqrt(accumulate_to_root(whole, (new & (child_counts(whole) == 0)).astype(np.float64)))
    radii[: len(tree)] = tree.radii
    for joint in range(len(tree), len(points)):
        radii[joint] = min(radii[joint], radii[parents[joint]])
    return np.asarray(radii)
