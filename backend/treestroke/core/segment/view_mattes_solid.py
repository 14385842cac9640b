"""Where in space a tree may stand, by what several shots of it show: voxels with soft evidence."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.side_by_side import side_by_side
from treestroke.core.types import Floats, Mask

Odds = NDArray[np.float32]
"""(h, w) or (n,) log odds of tree against background."""

LAYERS = 110
"""Voxels along the tree's height."""
SLACK, MARGIN = 1.35, 0.06
"""How much wider than in the stroked shot a crown may be from other sides; and how much further up and aside the tree
may reach, as a share of its height."""
BELOW = 0.015
"""How far below the root's level it may, likewise."""
DISSENT = 0.12
"""Share of the shots, those that speak most against a voxel, whose mean evidence counts: one bad shot cuts nothing."""
MOST = 4.0
"""Greatest evidence of a single shot, log odds."""
OUTSIDE = -8.0
"""Log odds where no voxel of the tree projects."""


@dataclass(frozen=True, eq=False)
class Solid:
    """Voxels in which the tree may be: their middles (n, 3) and side, metres, and their evidence (n,), log odds.

    The evidence increases along the arrays.
    """

    points: Floats
    odds: Odds
    side: float

    @property
    def reach(self) -> float:
        """How far from the root's vertical the tree may reach, metres."""
        return float(np.hypot(self.points[:, 0], self.points[:, 2]).max())

    def select(self, chosen: Mask) -> "Solid":
        """Return the voxels of which ``chosen`` (n,) is true; all where it is true of none."""
        return Solid(self.points[chosen], self.odds[chosen], self.side) if chosen.any() else self


def solid_around(outlines: Sequence[Floats], cameras: Sequence[PerspectiveCamera]) -> Solid:
    """Return the solid that holds a tree drawn in some shots: outlines (n, 2), px, turned about the root's vertical.

    Each outline is laid on the upright plane through the root, the world's origin, that faces its camera.
    """
    drawn = [_on_plane(outline, camera) for outline, camera in zip(outlines, cameras, strict=True)]
    top = max(float(up.max()) for _, up in drawn)
    side = top * (1 + MARGIN + BELOW) / LAYERS
    heights: Floats = (np.arange(LAYERS, dtype=np.float64) + 0.5) * side - BELOW * top
    radius = np.max([_half_widths(across, up, heights, MARGIN * top) for across, up in drawn], axis=0)
    reach = int(np.ceil(radius.max() / side))
    steps = np.arange(-reach, reach + 1) * side
    x, z = np.meshgrid(steps, steps)
    away = np.hypot(x, z)
    parts = []
    for height, limit in zip(heights, radius, strict=True):
        near = away <= limit
        parts.append(np.column_stack([x[near], np.full(near.sum(), height), z[near]]))
    points = np.concatenate(parts)
    return Solid(points, np.zeros(len(points), np.float32), side)


def lowest_height(outlines: Sequence[Floats], cameras: Sequence[PerspectiveCamera]) -> float:
    """Return the height, metres, of the lowest point of some outlines (n, 2), px, above the root's plane."""
    return min(float(_on_plane(*drawn)[1].min()) for drawn in zip(outlines, cameras, strict=True))


def _on_plane(outline_px: Floats, camera: PerspectiveCamera) -> tuple[Floats, Floats]:
    """Lay picture points (n, 2), px, on the upright plane through the origin that faces a camera: across and up."""
    centre = camera.centre
    facing = np.array([centre[0], 0.0, centre[2]]) / np.hypot(centre[0], centre[2])
    rays = camera.world_from_pixels(outline_px, 1.0) - centre
    points = centre + rays * (-(centre @ facing) / (rays @ facing))[:, None]
    return points @ np.array([facing[2], 0.0, -facing[0]]), points[:, 1]


def _half_widths(across: Floats, up: Floats, heights: Floats, margin: float) -> Floats:
    """Half the width (layers,), metres, that a tree may have at some heights, by an outline's points."""
    dense = np.linspace(0, 1, 20)[:, None]
    x = (across + dense * (np.roll(across, -1) - across)).ravel()
    y = (up + dense * (np.roll(up, -1) - up)).ravel()
    near = np.abs(y[None] - heights[:, None]) <= margin
    width = np.where(near, np.abs(x)[None], 0).max(axis=1)
    return np.where(near.any(axis=1), SLACK * width + margin, 0)


def weighed(
    solid: Solid, cameras: Sequence[PerspectiveCamera], evidence: Sequence[Odds], drawn: Sequence[int]
) -> Solid:
    """Return the solid with the evidence of all shots, maps (h, w) of log odds.

    A voxel is as likely as the few shots say that speak most against it, and as each of the ``drawn`` ones, by number,
    says, which are sure.
    """

    def told(shot: tuple[PerspectiveCamera, Odds]) -> Odds:
        camera, odds = shot
        highest = cv2.dilate(np.clip(odds, -MOST, MOST), np.ones((3, 3), np.uint8))
        index, inside = _places(solid.points, camera, odds.shape)
        row = np.full(len(solid.points), MOST, dtype=np.float32)
        row[inside] = highest.ravel()[index]
        return row

    seen = np.stack(side_by_side(told, list(zip(cameras, evidence, strict=True))))
    veto = seen[list(drawn)].min(axis=0)
    fewest = max(1, round(DISSENT * len(cameras)))
    seen.partition(fewest - 1, axis=0)
    odds = np.minimum(seen[:fewest].mean(axis=0), veto)
    order = np.argsort(odds, kind="stable")
    return Solid(solid.points[order], odds[order], solid.side)


def projected(solid: Solid, camera: PerspectiveCamera, shape: tuple[int, int]) -> Odds:
    """Return the greatest evidence (h, w) of the voxels behind each pixel; `OUTSIDE` where there are none.

    ``shape`` is (h, w) of the map, which covers the camera's whole picture.
    """
    low = (max(1, shape[0] // 2), max(1, shape[1] // 2))
    picture = np.full(low[0] * low[1], OUTSIDE, dtype=np.float32)
    index, inside = _places(solid.points, camera, low)
    picture[index] = solid.odds[inside]  # Of voxels on one pixel the last counts, which is the likeliest.
    grown = cv2.dilate(picture.reshape(low), np.ones((3, 3), np.uint8))
    return np.asarray(cv2.resize(grown, shape[::-1], interpolation=cv2.INTER_LINEAR))


def _places(points: Floats, camera: PerspectiveCamera, shape: tuple[int, ...]) -> tuple[NDArray[np.int64], Mask]:
    """Flat pixel index of the points that a picture of a shape (h, w) shows, and which these are (n,)."""
    matrix = camera.camera_from_world.astype(np.float32)
    x, y, z = matrix[:, :3] @ points.T.astype(np.float32) + matrix[:, 3:]
    scale = shape[1] / camera.width
    with np.errstate(divide="ignore", invalid="ignore"):
        column = np.floor((camera.focal_px * x / z + camera.principal_px[0]) * scale)
        row = np.floor((camera.focal_px * y / z + camera.principal_px[1]) * scale)
    inside = (z > 0) & (column >= 0) & (column < shape[1]) & (row >= 0) & (row < shape[0])
    return (row[inside] * shape[1] + column[inside]).astype(np.int64), inside
