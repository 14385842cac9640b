"""Joints moved to the middle of the limbs in the shots, and radii by how wide the limbs are there."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.sparse import coo_matrix, eye
from scipy.sparse.linalg import spsolve

from treestroke.core.geometry.vectors import unit
from treestroke.core.lift.thin_hull import ShownArea
from treestroke.core.side_by_side import side_by_side
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

ROUNDS = 3
"""Rounds of measuring and moving."""
SAMPLES = 81
"""Places across a limb at which a shot is looked up."""
LOOK_RADII, LOOK_PX = 1.7, 5.0
"""How far to both sides they reach: so many radii and so many px more."""
OFF_RADII, OFF_PX = 0.7, 2.0
"""How far aside of its axis a limb may be seen, likewise."""
WIDEST, WIDEST_PX = 1.4, 2.5
"""Width up to which what is seen is one limb, over its own, and px more."""
LEAST_ACROSS = 0.3
"""Sine of the least angle between a limb and the line of sight at which its sides tell."""
BENT, MOVED, ROBUST_PX = 0.6, 0.05, 1.0
"""Weights of bending and of moving against the shots, and the offset, px, from which on a shot counts less."""
FEWEST = 3
"""Shots that must show a limb's width."""
WIDTH_QUANTILE = 0.4
"""Which of the widths that the shots show tells, from the least up: other wood may stand beside the limb."""


@dataclass(frozen=True, eq=False)
class _Across:
    """What shots (s) show across joints (n): whether a limb by itself; how far aside it is and its radius, px.

    ``aside`` (s, n, 3) is the unit vector that an offset is measured along, ``pixel_m`` (s, n) a pixel's size, metres.
    """

    told: Mask
    offset_px: Floats
    radius_px: Floats
    aside: Floats
    pixel_m: Floats


def fitted(skeleton: Skeleton, areas: Sequence[ShownArea], least_share: float = 0.0) -> tuple[Skeleton, Floats]:
    """Move the joints of a skeleton (3D, metres) to the middle of what the shots show of their limbs.

    Also returns the radii (n,), metres, by the widths that the shots show; 0 where too few show a limb by itself. A
    joint that less than ``least_share`` of the shots show so is moved with its neighbours alone.

    Limbs are straight to within a pixel over a few joints: all corrections are found together by least squares, with a
    weight on bending, robustly by reweighting (Huber 1964). The root stays.
    """
    for _ in range(ROUNDS):
        across = _measured(skeleton, areas, least_share)
        skeleton = Skeleton(skeleton.points + _moves(skeleton, across), skeleton.radii, skeleton.parents)
    return skeleton, _radii(_measured(skeleton, areas, least_share))


def _measured(skeleton: Skeleton, areas: Sequence[ShownArea], least_share: float) -> _Across:
    """Measure what the shots show across each joint, if enough of them show it by itself."""
    along = _tangents(skeleton)
    columns = zip(*side_by_side(lambda area: _one_shot(skeleton, along, area), areas), strict=True)
    told, offset, radius, aside, pixel = (np.stack(column) for column in columns)
    enough = told.sum(axis=0) >= least_share * len(areas)
    return _Across(told.astype(np.bool_) & enough, offset, radius, aside, pixel)


def _one_shot(skeleton: Skeleton, along: Floats, area: ShownArea) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Return the row of one shot in `_Across`."""
    camera, points = area.shot.camera, skeleton.points
    pixel = camera.pixel_size(points)
    sight = unit(points - camera.centre)
    aside = np.cross(along, sight)
    clear = np.linalg.norm(aside, axis=1) > LEAST_ACROSS
    aside = unit(aside)
    middle = camera.pixels_from_world(points)
    step = camera.pixels_from_world(points + aside * pixel[:, None]) - middle
    radius = np.maximum(skeleton.radii / pixel, 0.5)
    # What is so far from all outlines, or from all that is shown, cannot be within one limb: most joints amid leaves.
    within = area.look_up(points)[0] / pixel
    alone = (within <= 0.5 * _widest(radius) + 1) & (within >= -_farthest(radius) - 1) & clear
    told, offset, half = np.zeros((3, len(points)))
    told[alone], offset[alone], half[alone] = _across_limb(area.shown, middle[alone], step[alone], radius[alone])
    return told, offset, half, aside, pixel


def _across_limb(shown: Mask, middle_px: Floats, step: Floats, radius_px: Floats) -> tuple[Mask, Floats, Floats]:
    """Look across limbs at their axes (n, 2) in directions (n, 2), by what is ``shown`` (h, w).

    Returns whether each is seen by itself, how far aside of its axis its middle is, and half its width, px: (n,) each.
    """
    reach = LOOK_RADII * radius_px + LOOK_PX
    offsets = np.linspace(-1, 1, SAMPLES) * reach[:, None]
    x, y = np.moveaxis(middle_px[:, None] + offsets[:, :, None] * step[:, None] - 0.5, 2, 0)
    share = map_coordinates(shown.astype(np.float32), [y, x], order=1, mode="constant")
    first, last = _run(share >= 0.5, offsets, _farthest(radius_px))
    known = (first > 0) & (last < SAMPLES - 1) & (last >= first)
    rows, apart = np.arange(len(radius_px)), 2 * reach / (SAMPLES - 1)
    left, right = offsets[rows, first], offsets[rows, np.minimum(last, SAMPLES - 1)]
    width = right - left + apart
    return known & (width <= _widest(radius_px)), 0.5 * (left + right), 0.5 * width


def _widest(radius_px: Floats) -> Floats:
    """Width (n,), px, up to which what is seen is one limb of a radius (n,), px."""
    return WIDEST * 2 * radius_px + WIDEST_PX


def _farthest(radius_px: Floats) -> Floats:
    """How far aside of its axis (n,), px, a limb of a radius (n,), px, may be seen."""
    return OFF_RADII * radius_px + OFF_PX


def _run(shown: Mask, offsets: Floats, off: Floats) -> tuple[Indices, Indices]:
    """Return the first and last place (n,) of the run of ``shown`` (n, k) that is nearest to the middle.

    The last is before the first where none is within ``off`` (n,) of it.
    """
    count = shown.shape[1]
    distance = np.where(shown, np.abs(offsets), np.inf)
    start, rows, place = distance.argmin(axis=1), np.arange(len(shown)), np.arange(count)
    gaps_before = np.maximum.accumulate(np.where(shown, -1, place), axis=1)
    gaps_after = np.minimum.accumulate(np.where(shown, count, place)[:, ::-1], axis=1)[:, ::-1]
    first, last = gaps_before[rows, start] + 1, gaps_after[rows, start] - 1
    return np.minimum(first, count - 1), np.where(distance[rows, start] <= off, last, -1)


def _tangents(skeleton: Skeleton) -> Floats:
    """Return unit vectors (n, 3) along the limbs at their joints: from the parent to the mean of the children."""
    parents, points = skeleton.parents, skeleton.points
    has = np.flatnonzero(parents >= 0)
    edge = np.zeros_like(points)
    edge[has] = unit(points[has] - points[parents[has]])
    onward = np.zeros_like(points)
    np.add.at(onward, parents[has], edge[has] * skeleton.radii[has, None] ** 2)
    return unit(edge + unit(onward), otherwise=np.array([0.0, 1.0, 0.0]))


def _moves(skeleton: Skeleton, across: _Across) -> Floats:
    """Solve for the moves (n, 3), metres, of all joints but the root."""
    count, unit_m = len(skeleton), float(np.median(across.pixel_m))
    weight = across.told / np.maximum(np.abs(across.offset_px) / ROBUST_PX, 1.0)
    matrix = np.einsum("sn,sni,snj->nij", weight, across.aside, across.aside)
    wanted = np.einsum("sn,sni,sn->ni", weight * across.pixel_m, across.aside, across.offset_px)
    row = np.repeat(np.arange(3 * count).reshape(count, 3), 3, axis=1)
    column = np.tile(np.arange(3 * count).reshape(count, 3), (1, 3))
    system = coo_matrix((matrix.ravel(), (row.ravel(), column.ravel())), shape=(3 * count,) * 2).tocsc()
    bending, bent = _bending(skeleton)
    size = float(weight.sum() / count)
    system = system + size * BENT * (bending.T @ bending) + MOVED * size * eye(3 * count, format="csc")
    moves = spsolve(system, wanted.ravel() - size * BENT * (bending.T @ bent)).reshape(-1, 3)
    limit = 2.0 * unit_m + 0.5 * skeleton.radii[:, None]
    moves = np.clip(moves, -limit, limit)
    moves[skeleton.parents < 0] = 0.0
    return np.asarray(moves)


def _bending(skeleton: Skeleton) -> tuple[coo_matrix, Floats]:
    """Return the matrix (3m, 3n) of second differences at joints within limbs, and their present values (3m,)."""
    parents = skeleton.parents
    thickest = np.full(len(skeleton), -1, dtype=np.int64)
    for joint in np.argsort(skeleton.radii, kind="stable").tolist():
        if parents[joint] >= 0:
            thickest[parents[joint]] = joint
    middle = np.flatnonzero((parents >= 0) & (thickest >= 0))
    before, after = parents[middle], thickest[middle]
    axis = np.arange(3)
    row = np.arange(3 * len(middle)).reshape(-1, 3)
    places = np.concatenate([(3 * joint[:, None] + axis).ravel() for joint in (middle, before, after)])
    values = np.repeat([1.0, -0.5, -0.5], row.size)
    matrix = coo_matrix((values, (np.tile(row.ravel(), 3), places)), shape=(row.size, 3 * len(skeleton))).tocsc()
    return matrix, np.asarray(matrix @ skeleton.points.ravel())


def _radii(across: _Across) -> Floats:
    """Return the radii (n,), metres, that the shots show; 0 where too few do."""
    radii = np.sort(np.where(across.told, across.radius_px * across.pixel_m, np.inf), axis=0)
    count = across.told.sum(axis=0)
    place = np.floor(WIDTH_QUANTILE * np.maximum(count - 1, 0)).astype(np.int64)
    return np.where(count >= FEWEST, np.take_along_axis(radii, place[None], axis=0)[0], 0.0)
