"""Tips of branches: how far the wood goes on in the shots, thinner than the cells in which it was looked for."""

from collections.abc import Sequence

import cv2
import numpy as np
from scipy.spatial import cKDTree

from treestroke.core.geometry.vectors import unit
from treestroke.core.lift.thin_hull import ShownArea
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask, Opacity

STEP = 1.5
"""Length of a step, in units of the graph."""
MOST_STEPS = 40
"""Steps that a tip goes on at most."""
TURN, AZIMUTHS = 0.2, 8
"""Tangent of the angle by which a step may turn, and the directions in which it is tried."""
NEAR_PX = 1.2
"""How far from what a shot shows as wood a step is seen there: lines of one px are broken."""
LEAST_SHARE = 0.62
"""Share of the shots that must show a step. On a bare oak 0.5 leads beyond tips where twigs cross by chance."""
LEAST_OWN = 0.35
"""Share of the shots in which the wood there must not be another branch's."""
STRAIGHT = 0.02
"""Share of the shots that going straight on is worth."""
APART = 1.5
"""How near another branch a tip ends, in units of the graph."""
BACK = 3
"""Joints back along a branch to the one that its tip's direction is taken from."""


def lengthened(
    skeleton: Skeleton, ends: Indices, areas: Sequence[ShownArea], unit_m: float
) -> tuple[Floats, Indices, Indices]:
    """Let the branches of a skeleton (3D, n joints, metres) go on from their ``ends`` (k,) while enough shots show it.

    In some of these it must be wood that no branch explains yet.

    Returns the new joints (m, 3), their parents (m,), of which n and more are new joints, and the end that each
    continues (m,).
    """
    points, parents = skeleton.points, skeleton.parents
    at, ways, last = points[ends], _directions(points, parents, ends), ends.copy()
    others, left = cKDTree(points), [_left(skeleton, area) for area in areas]
    added, joined, whose = list[Floats](), list[Indices](), list[Indices]()
    going, count = np.arange(len(ends)), len(points)
    for step in range(MOST_STEPS):
        places, seen = _stepped(at[going], ways[going], STEP * unit_m, areas, left)
        distance = others.query(places)[0]
        free = distance > APART * unit_m if step else np.ones(len(going), dtype=np.bool_)
        on = seen & free
        going, places = going[on], places[on]
        if len(going) == 0:
            break
        ways[going] = unit(0.5 * ways[going] + 0.5 * unit(places - at[going]))
        added.append(places)
        joined.append(last[going].copy())
        whose.append(ends[going])
        at[going], last[going] = places, np.arange(count, count + len(going))
        count += len(going)
    none = np.zeros(0, dtype=np.int64)
    return np.concatenate([np.zeros((0, 3)), *added]), np.concatenate([none, *joined]), np.concatenate([none, *whose])


def _directions(points: Floats, parents: Indices, ends: Indices) -> Floats:
    """Return unit vectors (k, 3) along the branches at their ends."""
    back = ends
    for _ in range(BACK):
        back = np.where(parents[back] >= 0, parents[back], back)
    return unit(points[ends] - points[back], otherwise=np.array([0.0, 1.0, 0.0]))


def _stepped(
    at: Floats, ways: Floats, step: float, areas: Sequence[ShownArea], left: Sequence[Opacity]
) -> tuple[Floats, Mask]:
    """Return the best place (k, 3) a step on from places (k, 3) about ways (k, 3), and whether enough shots show it."""
    side = unit(np.cross(ways, np.where(np.abs(ways[:, 1:2]) < 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])))
    up = np.cross(ways, side)
    angle = 2 * np.pi * np.arange(AZIMUTHS) / AZIMUTHS
    turned = np.cos(angle)[:, None, None] * side + np.sin(angle)[:, None, None] * up
    tried = unit(np.concatenate([ways[None], ways + TURN * turned]))
    places = at + step * tried
    share = _shown(places.reshape(-1, 3), areas).reshape(places.shape[:2])
    share = np.minimum(share, _shown((at + 0.5 * step * tried).reshape(-1, 3), areas).reshape(share.shape))
    share[0] += STRAIGHT
    best, rows = share.argmax(axis=0), np.arange(len(at))
    chosen = places[best, rows]
    return chosen, (share[best, rows] >= LEAST_SHARE + STRAIGHT) & (_unexplained(chosen, areas, left) >= LEAST_OWN)


def _left(skeleton: Skeleton, area: ShownArea) -> Opacity:
    """Return how far (h, w), px, each pixel of a shot is from the nearest that shows wood which no branch covers."""
    camera = area.shot.camera
    pixels = np.rint(camera.pixels_from_world(skeleton.points) - 0.5).astype(np.int64)
    widths = np.rint(2 * skeleton.radii / camera.pixel_size(skeleton.points)).astype(np.int64) + 2
    left = area.shown.astype(np.uint8)
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if parent >= 0:
            cv2.line(left, pixels[joint].tolist(), pixels[parent].tolist(), 0, int(widths[joint]))
    return np.asarray(cv2.distanceTransform(1 - left, cv2.DIST_L2, 5), dtype=np.float32)


def _unexplained(points: Floats, areas: Sequence[ShownArea], left: Sequence[Opacity]) -> Floats:
    """Return the share (n,) of the shots in which points (n, 3), metres, lie on wood that no branch covers."""
    shows = []
    for area, away_px in zip(areas, left, strict=True):
        height, width = away_px.shape
        column, row = np.floor(area.shot.camera.pixels_from_world(points)).astype(np.int64).T
        seen = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        shows.append(seen & (away_px[np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)] <= NEAR_PX))
    return np.asarray(np.mean(shows, axis=0))


def _shown(points: Floats, areas: Sequence[ShownArea]) -> Floats:
    """Return the share (n,) of the shots that show wood at points (n, 3), metres."""
    shows = [area.look_up(points)[1] <= NEAR_PX * area.shot.camera.pixel_size(points) for area in areas]
    return np.asarray(np.mean(shows, axis=0))
