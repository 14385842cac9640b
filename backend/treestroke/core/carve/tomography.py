"""How densely leaves fill the cells of a hull, from how much of each line of sight the mattes show to be covered."""

from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from treestroke.core.capture import TreeMatte
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.clumped_crown import Cells
from treestroke.core.types import Floats, Indices, Mask

Singles = NDArray[np.float32]

BLOCK_PX = 4
"""Side of the blocks of pixels that share a line of sight: about half a cell as seen from the cameras."""
STEP = 0.7
"""Distance of the places at which a line of sight asks for its cell, in sides of a cell."""
SUBSETS, SWEEPS = 8, 10
"""Parts into which the lines are dealt, and how often all are used: after 20 sweeps little is gained."""
WRONG = 0.02
"""Share of the mattes' pixels taken to be wrong; with 0.5 to 5 % crowns came out nearly the same."""
DENSEST = 3.0
"""Density, in means of the filled cells, above which a cell's is taken for a line's that nothing else explains."""


@dataclass(frozen=True, eq=False)
class HullGrid:
    """Cells that a tree may fill.

    Attributes
    ----------
    share
        (x, y, z) share of each cell that the hull fills; 0 where the tree cannot be.
    corner
        (3,) least corner of the grid, metres.
    side
        Side of a cell, metres.
    """

    share: Singles
    corner: Floats
    side: float

    @property
    def places(self) -> Indices:
        """(n, 3) places of the cells that the tree may fill."""
        return np.argwhere(self.share > 0)

    @property
    def middles(self) -> Floats:
        """(n, 3) their middles, metres."""
        return np.asarray(self.corner + self.side * (self.places + 0.5))


@dataclass(frozen=True, eq=False)
class Filling:
    """What fills the n cells that a tree may fill, in the order of their places.

    Attributes
    ----------
    density
        (n,) leaves and wood: how many of them a line of one metre meets in the mean.
    leafy
        (n,) share of the covered lines through each that end on leaves, not on wood.
    """

    density: Singles
    leafy: Singles


@dataclass(frozen=True, eq=False)
class DensityField:
    """Densities to be asked for along lines of sight.

    Attributes
    ----------
    padded
        (x, y, z) density of each cell, -1 outside the hull; one more cell on each side.
    corner
        (3,) least corner of the cells, without those, metres.
    side
        Side of a cell, metres.
    """

    padded: Singles
    corner: Floats
    side: float

    @property
    def corners(self) -> Floats:
        """(8, 3) corners of the box of the cells, metres."""
        size = np.array(self.padded.shape) - 2
        return np.asarray(self.corner + self.side * size * np.indices((2, 2, 2)).reshape(3, -1).T)

    def along(self, start: Floats, ahead: Floats, way: float) -> Singles:
        """Look up the density (n,) a ``way`` along directions (n, 3) from a point (3,), metres; -1 outside the hull."""
        origin = (start - self.corner) / self.side + 1
        size = self.padded.shape
        x, y, z = (
            np.clip(origin[axis] + ahead[:, axis] * (way / self.side), 0, size[axis] - 1).astype(np.int32)
            for axis in range(3)
        )
        return np.asarray(self.padded.ravel()[(x * size[1] + y) * size[2] + z])


@dataclass(frozen=True, eq=False)
class _Lines:
    """Lines of sight: lengths (lines, n) in cells, metres, and the shares covered, and covered by leaves, (lines,)."""

    lengths: sparse.csr_matrix
    covered: Singles
    leaf: Singles


def filling(grid: HullGrid, views: Iterable[tuple[PerspectiveCamera, TreeMatte]]) -> Filling:
    """Find densities by which the lines of sight are covered as the mattes show.

    A line that meets L things in the mean is open with the probability exp(-L); some pixels are wrong. The most likely
    densities come from expectation and maximization: the things that a line is expected to have met are dealt to its
    cells. Lines are used in turns by parts of them.

    Notes
    -----
    Reche-Martinez, Martin and Drettakis 2004, section 4 (opacity as line integrals); Lange and Carson 1984 (the
    maximization, here for lines of which is only known whether they meet something); Hudson and Larkin 1994 (subsets).
    """
    middles, size = grid.middles, grid.share.shape
    index = np.full(size, -1, dtype=np.int32)
    index[tuple(grid.places.T)] = np.arange(len(middles))
    parts = [_lines(grid, index, middles, camera, matte) for camera, matte in views]
    lines = _Lines(
        sparse.vstack([part.lengths for part in parts], format="csr"),
        np.concatenate([part.covered for part in parts]),
        np.concatenate([part.leaf for part in parts]),
    )
    met = lines.lengths.T @ lines.covered
    leafy = np.clip((lines.lengths.T @ lines.leaf) / np.maximum(met, 1e-9), 0, 1)
    return Filling(_densities(lines, grid.share[tuple(grid.places.T)]), leafy.astype(np.float32))


def _densities(lines: _Lines, first: Singles) -> Singles:
    """Find the most likely densities (n,) of cells, begun with (n,)."""
    part_of = np.arange(len(lines.covered)) * 5 % SUBSETS
    parts = []
    for part in range(SUBSETS):
        lengths, covered = lines.lengths[part_of == part], lines.covered[part_of == part]
        parts.append((lengths, lengths.T.tocsr(), covered, np.asarray(lengths.sum(axis=0)).ravel()))
    density = first
    for _ in range(SWEEPS):
        for lengths, turned, covered, through in parts:
            missed = np.exp(-(lengths @ density))
            open_chance = (1 - WRONG) * missed + WRONG * (1 - missed)
            met = (1 - covered) * WRONG / open_chance + covered * (1 - WRONG) / (1 - open_chance)
            density = np.where(through > 0, density * (turned @ met) / np.maximum(through, 1e-9), density)
        filled = density > 0.05 * density.mean()
        density = np.minimum(density, DENSEST * density[filled].mean())
    return np.asarray(density, dtype=np.float32)


def _lines(
    grid: HullGrid, index: NDArray[np.int32], middles: Floats, camera: PerspectiveCamera, matte: TreeMatte
) -> _Lines:
    """Gather the lines of sight of a shot's blocks of pixels that pass cells (n,), where the shot tells."""
    covered, leaf, hidden = (
        _blocks(values) for values in (matte.opacity, matte.opacity * (1 - matte.wood), matte.hidden)
    )
    row, column = np.nonzero(_passing(covered.shape, camera, middles, grid.side) & (hidden == 0))
    middles_px = np.asarray(BLOCK_PX * (np.stack([column, row], axis=1) + 0.5), dtype=np.float64)
    ahead = camera.world_from_pixels(middles_px, 1.0) - camera.centre
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    lengths = _lengths(grid, index, camera.centre, ahead)
    return _Lines(lengths, covered[row, column], leaf[row, column])


def _blocks(values: NDArray[np.generic]) -> Singles:
    """Average (h, w) over blocks of pixels; rows and columns short of a block are left out."""
    high, wide = (length // BLOCK_PX for length in values.shape)
    whole = np.asarray(values[: high * BLOCK_PX, : wide * BLOCK_PX], dtype=np.float32)
    return np.asarray(cv2.resize(whole, (wide, high), interpolation=cv2.INTER_AREA))


def _passing(shape: tuple[int, ...], camera: PerspectiveCamera, middles: Floats, side: float) -> Mask:
    """Tell which blocks (h, w) see cells (n, 3)."""
    column, row = np.floor(np.clip(camera.pixels_from_world(middles) / BLOCK_PX, -1, max(shape))).astype(np.int64).T
    seen = (column >= 0) & (column < shape[1]) & (row >= 0) & (row < shape[0])
    passing = np.zeros(shape, dtype=np.uint8)
    passing[row[seen], column[seen]] = 1
    half = int(np.ceil(side / BLOCK_PX / float(camera.pixel_size(middles[seen]).min()))) if seen.any() else 0
    return np.asarray(cv2.dilate(passing, np.ones((2 * half + 1, 2 * half + 1), np.uint8)) > 0)


def _lengths(grid: HullGrid, index: NDArray[np.int32], start: Floats, ahead: Floats) -> sparse.csr_matrix:
    """Measure how long lines from one point in directions (m, 3) run in cells: (m, n), metres."""
    size = np.array(grid.share.shape)
    origin = (start - grid.corner) / grid.side
    with np.errstate(divide="ignore"):
        ends = np.stack([-origin, size - origin]) / ahead[:, None]
    near = np.maximum(np.minimum(ends[:, 0], ends[:, 1]).max(axis=1), 0)
    far = np.maximum(ends[:, 0], ends[:, 1]).min(axis=1)
    count = max(int(np.ceil(((far - near) / STEP).max(initial=0))), 1)
    places = np.full((len(ahead), count), -1, dtype=np.int32)
    flat = index.ravel()
    first = [(origin[axis] + ahead[:, axis] * near).astype(np.float32) for axis in range(3)]
    slope = [ahead[:, axis].astype(np.float32) for axis in range(3)]
    for step in range(count):
        way = np.float32(STEP * (step + 0.5))
        x, y, z = ((begin + rise * way).astype(np.int32) for begin, rise in zip(first, slope, strict=True))
        within = (x >= 0) & (x < size[0]) & (y >= 0) & (y < size[1]) & (z >= 0) & (z < size[2])
        places[:, step] = np.where(within, flat[np.where(within, (x * size[1] + y) * size[2] + z, 0)], -1)
    held = places >= 0
    ends_at = np.concatenate([[0], np.cumsum(held.sum(axis=1))])
    cells = places[held]
    lengths = np.full(len(cells), STEP * grid.side, dtype=np.float32)
    matrix = sparse.csr_matrix((lengths, cells, ends_at), (len(ahead), int(index.max()) + 1))
    matrix.sum_duplicates()
    return matrix


def grid_of(cells: Cells, times: int) -> HullGrid:
    """Join cells into ones of ``times`` the side."""
    wide = np.pad(cells.filled, [(0, -length % times) for length in cells.filled.shape])
    x, y, z = (length // times for length in wide.shape)
    share = wide.reshape(x, times, y, times, z, times).mean(axis=(1, 3, 5), dtype=np.float32)
    return HullGrid(share, cells.corner, times * cells.side)
