"""Dense points on a tree: depths of several shots that bear each other out."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.capture import PointCloud, Shot, TreeMatte
from treestroke.core.carve.carving import Carving
from treestroke.core.carve.plane_sweep import REDUCTION, DepthMap, SweptShot, depth_map, swept_shot
from treestroke.core.progress import Report
from treestroke.core.side_by_side import side_by_side
from treestroke.core.types import Floats, Indices, Mask

SWEPT = 7
"""Most shots whose depths are found: more of 18 add few points. (Ten, each compared with four shots, take twice as
long; of two trees in leaf all silhouettes were the same to 0.005.)"""
NEIGHBOURS = 3
"""Shots that each is compared with."""
LEAST_ANGLE_RAD = np.deg2rad(6.0)
"""Least angle between neighbours, seen from the tree: nearer ones tell little of depth."""
LEAST_SCORE = 0.35
"""Correlation below which a depth is not used."""
SURE_SCORE = 0.65
"""Correlation above which a depth needs no other shot's: it matched in two neighbours, and 98 % of such depths on four
synthetic trees were right to 2 % of the height."""
AGREE = 0.012
"""Difference of depth, as a share of the tree's height, up to which two shots see the same."""
SPACING = 1 / 250
"""Distance of points, as a share of the tree's height: those nearer are joined."""
EDGE = 0.02
"""Weight of the colours of pixels at the tree's edges, which mix with what is behind, beside those within."""
VEIL_PX = 4
"""Side of the blocks of pixels in which a nearer point hides one behind, px of the shots."""


@dataclass(frozen=True, eq=False)
class _Found:
    """Points (n, 3), metres, how well they match (n,), their colours (n, 3), sRGB, and how pure these are (n,)."""

    points: Floats
    scores: Floats
    colours: Floats
    purity: Floats

    def select(self, chosen: Mask) -> "_Found":
        return _Found(self.points[chosen], self.scores[chosen], self.colours[chosen], self.purity[chosen])


def dense_cloud(carving: Carving, shots: Sequence[Shot], mattes: Sequence[TreeMatte], report: Report) -> PointCloud:
    """Find points on what shots see of a tree, leaves and limbs, within its hull.

    Depths come from sweeping planes in up to `SWEPT` shots. A depth that its neighbours match well is kept unless other
    shots look through it; one that they match less well has to agree with another shot's. Near points are joined.

    Raises
    ------
    ValueError
        Not one matte for each shot.

    Notes
    -----
    Merrell and others 2007 (depths that support, and that are looked through).
    """
    if len(shots) != len(mattes):
        raise ValueError(f"dense points need a matte for each shot, got {len(shots)} and {len(mattes)}")
    good = np.flatnonzero(carving.hull.good).tolist()
    made_ready = side_by_side(lambda index: swept_shot(shots[index], mattes[index]), good)
    swept = {index: ready for index, ready in zip(good, made_ready, strict=True) if ready is not None}
    chosen = [list(swept)[place] for place in np.unique(np.linspace(0, len(swept) - 1, SWEPT).round().astype(int))]
    field = carving.field

    def sweep(index: int) -> DepthMap:
        return depth_map(swept[index], _neighbours(index, swept, carving), field)

    report("points", 0.0)
    depths = side_by_side(sweep, chosen, lambda part: report("points", 0.9 * part))
    found = [_found(depth, shots[index], mattes[index]) for depth, index in zip(depths, chosen, strict=True)]
    height = carving.hull.height
    kept = [each.select(_borne_out(each, depths, own, AGREE * height)) for own, each in enumerate(found)]
    points, colours = _joined(kept, SPACING * height)
    report("points", 1.0)
    return PointCloud(points, colours, _seen(points, shots, mattes, AGREE * height))


def _neighbours(index: int, swept: dict[int, SweptShot], carving: Carving) -> list[SweptShot]:
    """Return the shots that stand next to one about the tree, not too near to it."""
    middle = carving.grid.middles.mean(axis=0)
    ahead = {other: shot.camera.toward_viewer(middle[None])[0] for other, shot in swept.items()}
    apart = {other: float(np.arccos(np.clip(ahead[other] @ ahead[index], -1, 1))) for other in swept if other != index}
    order = sorted(apart, key=lambda other: (apart[other] < LEAST_ANGLE_RAD, apart[other]))
    return [swept[other] for other in order[:NEIGHBOURS]]


def _found(depth: DepthMap, shot: Shot, matte: TreeMatte) -> _Found:
    """Place the pixels of a depth map in the world, and give them the colours of what the tree covers wholly."""
    row, column = np.nonzero((depth.depth_m > 0) & (depth.score >= LEAST_SCORE))
    places = np.asarray(np.stack([column, row], axis=1) + 0.5, dtype=np.float64)
    points = depth.camera.world_from_pixels(places, depth.depth_m[row, column].astype(np.float64))
    left, top = depth.corner_px
    part = np.s_[top : top + REDUCTION * depth.camera.height, left : left + REDUCTION * depth.camera.width]
    whole = cv2.erode(matte.opacity, np.ones((3, 3), np.uint8))
    weight = (matte.opacity * (EDGE + whole))[part]
    colours = shot.picture[..., :3][part] * weight[..., None]
    size = depth.camera.width, depth.camera.height
    purity = cv2.resize(weight, size, interpolation=cv2.INTER_AREA)[row, column].astype(np.float64)
    sums = cv2.resize(colours, size, interpolation=cv2.INTER_AREA)[row, column].astype(np.float64)
    colour = sums / np.maximum(purity, 1e-9)[:, None]
    return _Found(points, depth.score[row, column].astype(np.float64), colour, np.maximum(purity, 1e-9))


def _borne_out(found: _Found, depths: Sequence[DepthMap], own: int, tolerance: float) -> Mask:
    """Tell which points (n,) of the shot ``own`` the depths of the others, to a tolerance in metres, bear out."""
    agreeing, through = np.zeros((2, len(found.points)), dtype=np.int64)
    for other, depth in enumerate(depths):
        if other == own:
            continue
        row, column, within = _pixels(depth.camera.pixels_from_world(found.points), depth.depth_m.shape)
        there = np.where(within & (depth.score[row, column] >= LEAST_SCORE), depth.depth_m[row, column], 0.0)
        beyond = np.where(there > 0, there - depth.camera.depth(found.points), -np.inf)
        agreeing += np.abs(beyond) <= tolerance
        through += beyond > 2 * tolerance
    sure = found.scores >= SURE_SCORE
    return np.asarray((agreeing >= np.where(sure, 0, 1)) & (through <= agreeing + sure))


def _pixels(places_px: Floats, shape: tuple[int, ...]) -> tuple[Indices, Indices, Mask]:
    """Return rows (n,) and columns (n,) of picture points (n, 2), 0 outside, and whether they are within (n,)."""
    column, row = np.floor(np.clip(places_px, -1, 1e6)).astype(np.int64).T
    within = (column >= 0) & (column < shape[1]) & (row >= 0) & (row < shape[0])
    return np.where(within, row, 0), np.where(within, column, 0), np.asarray(within)


def _joined(parts: Sequence[_Found], spacing: float) -> tuple[Floats, NDArray[np.uint8]]:
    """Join points in cubes of a side, metres, to their means (n, 3), and their colours, pure ones first, (n, 3)."""
    points, colours, purity = (
        np.concatenate(values)
        for values in zip(*[(part.points, part.colours, part.purity) for part in parts], strict=True)
    )
    if len(points) == 0:
        return points, colours.astype(np.uint8)
    _, group = np.unique(np.floor(points / spacing).astype(np.int64), axis=0, return_inverse=True)
    places, tints = _means(points, np.ones(len(points)), group.ravel()), _means(colours, purity, group.ravel())
    return places, np.clip(np.round(tints), 0, 255).astype(np.uint8)


def _means(values: Floats, weights: Floats, group: Indices) -> Floats:
    """Average values (n, d), weighted by (n,), over groups (n,): (groups, d)."""
    total = np.bincount(group, weights)
    return np.stack([np.bincount(group, weights * column) / total for column in values.T], axis=1)


def _seen(points: Floats, shots: Sequence[Shot], mattes: Sequence[TreeMatte], tolerance: float) -> Mask:
    """Tell which shots see which points (n, 3), metres: those with no point before them by a tolerance: (n, shots)."""

    def seen_by(pair: tuple[Shot, TreeMatte]) -> Mask:
        shot, matte = pair
        camera, (height, width) = shot.camera, matte.opacity.shape
        places, depth = camera.pixels_from_world(points), camera.depth(points)
        row, column, within = _pixels(places, (height, width))
        within &= (depth > 0) & matte.tree[row, column]
        block = row // VEIL_PX * (width // VEIL_PX + 1) + column // VEIL_PX
        nearest = np.full((height // VEIL_PX + 1) * (width // VEIL_PX + 1), np.inf)
        np.minimum.at(nearest, block[within], depth[within])
        # A surface that is not square to the line of sight is as deep as a block is wide.
        return np.asarray(within & (depth <= nearest[block] + tolerance + VEIL_PX * camera.pixel_size(points)))

    return np.stack(side_by_side(seen_by, list(zip(shots, mattes, strict=True))), axis=1)
