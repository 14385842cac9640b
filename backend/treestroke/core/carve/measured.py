"""The measured crown: the cells of a tree's hull that leaves fill, or twigs of a bare tree."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from treestroke.core.capture import Shot
from treestroke.core.carve.carving import JOINED, Carving
from treestroke.core.carve.tomography import HullGrid
from treestroke.core.geometry.clumped_crown import Cells
from treestroke.core.geometry.measured_crown import MeasuredCrown
from treestroke.core.geometry.polyline import smoothed
from treestroke.core.types import Floats, Indices, Mask

FILLED = 0.1
"""Density of a filled cell, in means over what leaves fill."""
NEAR = 2
"""How many of the hull's cells from filled ones leaves are admitted too."""
LEAFLESS = 0.25
"""Share of leaves in what the mattes show below which a tree is bare: its crown is made of twigs. The soft edges of
twigs may pass for leaves."""
WIDE = 2.5
"""Spread of a bare crown's lowest level, in those of the trunk below."""
UNSEEN_RAD = np.deg2rad(80.0)
"""Angle about the axis from the nearest camera beyond which a side was not seen."""
SECTORS = 36
"""Directions about the axis in which sides are told apart."""
USUAL = 90.0
"""Percentile of the seen sides' radii at a height beyond which an unseen side is not believed."""


@dataclass(frozen=True, eq=False)
class _Sides:
    """Cells about the tree's axis: their levels (n,), distances (n,), metres, and whether on an unseen side (n,)."""

    level: Indices
    away: Floats
    unseen: Mask


def measured_crown(carving: Carving, shots: Sequence[Shot]) -> MeasuredCrown:
    """Tell where in a tree's hull leaves stand, and how densely; of a bare tree twigs.

    Sides that no shot was taken from are bounded by the hull and by the radius of the seen sides at the same height,
    and marked as guessed.
    """
    grid, leafy = carving.grid, carving.leafy
    density = carving.density.astype(np.float64)
    if float((density * leafy).sum()) >= LEAFLESS * float(density.sum()):
        density = density * leafy
    else:
        density[_below_crown(grid, density)] = 0
    sides = _sides(grid, density, np.array([shot.camera.centre for shot in shots]))
    density[_too_far(sides, density)] = 0
    return _crown(carving, density, sides.unseen)


def _crown(carving: Carving, density: Floats, unseen: Mask) -> MeasuredCrown:
    """Fill the hull's cells by the densities (n,) of the joined ones."""
    hull, grid = carving.hull.cells, carving.grid
    mean = float((density**2).sum() / density.sum())
    density = np.where(density >= FILLED * mean, density, 0.0)
    fine, guessed = (_spread(grid, values, hull.filled) for values in (density, unseen))
    around = ndimage.binary_dilation(fine > 0, iterations=NEAR) & hull.filled
    cells = Cells(fine > 0, hull.corner, hull.side)
    return MeasuredCrown(cells, fine.astype(np.float32), around, hull.filled, guessed > 0)


def _spread(grid: HullGrid, values: Floats | Mask, within: Mask) -> Floats:
    """Give the values (n,) of joined cells to those of the hull in them: (x, y, z), 0 elsewhere."""
    joined = np.zeros(grid.share.shape)
    joined[tuple(grid.places.T)] = values
    for axis in range(3):
        joined = np.repeat(joined, JOINED, axis=axis)
    x, y, z = within.shape
    return np.asarray(np.where(within, joined[:x, :y, :z], 0.0))


def _below_crown(grid: HullGrid, density: Floats) -> Mask:
    """Tell which cells (n,) of a bare tree are its trunk's below the first limbs."""
    places = grid.places
    count = int(places[:, 1].max()) + 1
    mass = np.bincount(places[:, 1], density, count) + 1e-12
    offsets = grid.middles[:, ::2]
    centres = [np.bincount(places[:, 1], density * offset, count) / mass for offset in offsets.T]
    spread = sum(
        np.bincount(places[:, 1], density * (offset - centre[places[:, 1]]) ** 2, count) / mass
        for offset, centre in zip(offsets.T, centres, strict=True)
    )
    spread = np.sqrt(np.asarray(spread))
    trunk = max(float(np.median(spread[: max(count // 8, 1)])), grid.side / 2)
    wide = np.flatnonzero(smoothed(spread, 0.01 * count) > WIDE * trunk)
    return np.asarray(places[:, 1] < (wide[0] if len(wide) else 0))


def _sides(grid: HullGrid, density: Floats, centres: Floats) -> _Sides:
    """Place cells (n,) about the densities' axis, and tell which sides no camera, (cameras, 3), stood on."""
    level, middles = grid.places[:, 1], grid.middles
    axis = np.average(middles, axis=0, weights=density)
    outward = middles - axis
    turn, cameras = (np.arctan2(offset[:, 0], offset[:, 2]) for offset in (outward, centres - axis))
    sectors = 2 * np.pi * (np.arange(SECTORS) + 0.5) / SECTORS - np.pi
    apart = np.abs((sectors[:, None] - cameras + np.pi) % (2 * np.pi) - np.pi).min(axis=1)
    sector = np.clip(((turn + np.pi) / (2 * np.pi) * SECTORS).astype(np.int64), 0, SECTORS - 1)
    return _Sides(level, np.hypot(outward[:, 0], outward[:, 2]), (apart > UNSEEN_RAD)[sector])


def _too_far(sides: _Sides, density: Floats) -> Mask:
    """Tell which cells (n,) on unseen sides lie further from the axis than the seen sides' usual radius."""
    usual = np.zeros(int(sides.level.max()) + 1)
    seen = ~sides.unseen & (density > 0)
    for level in np.unique(sides.level[seen]).tolist():
        usual[level] = np.percentile(sides.away[seen & (sides.level == level)], USUAL)
    usual = smoothed(usual, 0.02 * len(usual))
    return np.asarray(sides.unseen & (sides.away > usual[sides.level]))
