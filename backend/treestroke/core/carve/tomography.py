"""How densely leaves fill the cells of a hull, from how much of each line of sight the mattes show to be covered."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from treestroke.core.capture import TreeMatte
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.clumped_crown import Cells
from treestroke.core.geometry.vectors import unit
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
ABOUT = 1.5
"""Distance from a point that a shot sees, in sides of a cell, from where on its line is not known to be open."""
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

    @cached_property
    def places(self) -> Indices:
        """(n, 3) places of the cells that the tree may fill."""
        return np.argwhere(self.share > 0)

    @cached_property
    def index(self) -> NDArray[np.int32]:
        """(cells,) which of those each cell of the flat grid is, -1 where the tree cannot be."""
        index = np.full(self.share.shape, -1, dtype=np.int32)
        index[tuple(self.places.T)] = np.arange(len(self.places))
        return index.ravel()

    @cached_property
    def middles(self) -> Floats:
        """(n, 3) their middles, metres."""
        return np.asarray(self.corner + self.side * (self.places + 0.5))


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
class SightLines:
    """Lines of sight through n cells, and what they meet there.

    Attributes
    ----------
    lengths
        (lines, n) how long each runs in each cell, metres.
    covered
        (lines,) how much of each is covered, 0 to 1.
    leaf
        (lines,) how much of each is covered by leaves, not wood.
    """

    lengths: sparse.csr_matrix
    covered: Singles
    leaf: Singles


def together(parts: Sequence[SightLines]) -> SightLines:
    """Gather lines of sight through the same cells."""
    return SightLines(
        sparse.vstack([part.lengths for part in parts], format="csr"),
        np.concatenate([part.covered for part in parts]),
        np.concatenate([part.leaf for part in parts]),
    )


def lines_of(grid: HullGrid, camera: PerspectiveCamera, matte: TreeMatte) -> SightLines:
    """Gather the lines of sight of a shot's blocks of pixels that pass the cells, where the shot tells."""
    covered, leaf, hidden = (
        _blocks(values) for values in (matte.opacity, matte.opacity * (1 - matte.wood), matte.hidden)
    )
    row, column = np.nonzero(_passing(covered.shape, camera, grid.middles, grid.side) & (hidden == 0))
    middles_px = np.asarray(BLOCK_PX * (np.stack([column, row], axis=1) + 0.5), dtype=np.float64)
    ahead = unit(camera.world_from_pixels(middles_px, 1.0) - camera.centre)
    near, far = _through_box(grid, camera.centre, ahead)
    return SightLines(_lengths(grid, camera.centre, ahead, near, far), covered[row, column], leaf[row, column])


def lines_to(grid: HullGrid, camera: PerspectiveCamera, points: Floats) -> SightLines:
    """Make lines of sight of a shot that sees points (n, 3), metres: open up to each point, and covered about it."""
    away = points - camera.centre
    distance, ahead = np.linalg.norm(away, axis=1), unit(away)
    near, far = _through_box(grid, camera.centre, ahead)
    about = ABOUT * grid.side
    ends = np.clip(distance - about, near, far), np.clip(distance + about, near, far)
    parts = []
    for begin, end, covered in ((near, ends[0], 0.0), (ends[0], ends[1], 1.0)):
        share = np.full(len(points), covered, dtype=np.float32)
        parts.append(SightLines(_lengths(grid, camera.centre, ahead, begin, end), share, share))
    return together(parts)


def leafiness(lines: SightLines) -> Singles:
    """Measure the share of covered lines through each cell that end on leaves: (n,)."""
    met = lines.lengths.T @ lines.covered
    return np.asarray(np.clip((lines.lengths.T @ lines.leaf) / np.maximum(met, 1e-9), 0, 1), dtype=np.float32)


def densities(grid: HullGrid, lines: SightLines) -> Singles:
    """Find the densities (n,) by which lines of sight are covered as they are seen to be.

    A line that meets L things in the mean is open with the probability exp(-L); some pixels are wrong. The most likely
    densities come from expectation and maximization: the things that a line is expected to have met are dealt to its
    cells. Lines are used in turns by parts of them.

    Notes
    -----
    Reche-Martinez, Martin and Drettakis 2004, section 4 (opacity as line integrals); Lange and Carson 1984 (the
    maximization, here for lines of which is only known whether they meet something); Hudson and Larkin 1994 (subsets).
    """
    part_of = np.arange(len(lines.covered)) * 5 % SUBSETS
    parts = []
    for part in range(SUBSETS):
        lengths, covered = lines.lengths[part_of == part], lines.covered[part_of == part]
        parts.append((lengths, lengths.T.tocsr(), covered, np.asarray(lengths.sum(axis=0)).ravel()))
    density = grid.share[tuple(grid.places.T)]
    for _ in range(SWEEPS):
        for lengths, turned, covered, through in parts:
            missed = np.exp(-(lengths @ density))
            open_chance = (1 - WRONG) * missed + WRONG * (1 - missed)
            met = (1 - covered) * WRONG / open_chance + covered * (1 - WRONG) / (1 - open_chance)
            density = np.where(through > 0, density * (turned @ met) / np.maximum(through, 1e-9), density)
        filled = density > 0.05 * density.mean()
        density = np.minimum(density, DENSEST * density[filled].mean())
    return np.asarray(density, dtype=np.float32)


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


def _through_box(grid: HullGrid, start: Floats, ahead: Floats) -> tuple[Floats, Floats]:
    """Find how far, metres, lines from one point in unit directions (m, 3) enter and leave the grid: (m,), (m,)."""
    low = grid.corner - start
    with np.errstate(divide="ignore"):
        ends = np.stack([low, low + grid.side * np.array(grid.share.shape)]) / ahead[:, None]
    near = np.maximum(ends.min(axis=1).max(axis=1), 0)
    return near, np.maximum(ends.max(axis=1).min(axis=1), near)


def _lengths(grid: HullGrid, start: Floats, ahead: Floats, near: Floats, far: Floats) -> sparse.csr_matrix:
    """Measure how far lines from a point, in unit directions (m, 3), run in cells between distances: (m, n), metres."""
    size, index = grid.share.shape, grid.index
    count = max(int(np.ceil(((far - near) / grid.side / STEP).max(initial=0))), 1)
    places = np.full((len(ahead), count), -1, dtype=np.int32)
    first = ((start - grid.corner + ahead * near[:, None]) / grid.side).astype(np.float32).T
    slope, room = ahead.astype(np.float32).T, ((far - near) / grid.side).astype(np.float32)
    for step in range(count):
        way = np.float32(STEP * (step + 0.5))
        x, y, z = (
            np.ascontiguousarray(begin + rise * way).astype(np.int32) for begin, rise in zip(first, slope, strict=True)
        )
        within = (way <= room) & (x >= 0) & (x < size[0]) & (y >= 0) & (y < size[1]) & (z >= 0) & (z < size[2])
        places[:, step] = np.where(within, index[np.where(within, (x * size[1] + y) * size[2] + z, 0)], -1)
    held = places >= 0
    ends_at = np.concatenate([[0], np.cumsum(held.sum(axis=1))])
    cells = places[held]
    lengths = np.full(len(cells), STEP * grid.side, dtype=np.float32)
    matrix = sparse.csr_matrix((lengths, cells, ends_at), (len(ahead), len(grid.places)))
    matrix.sum_duplicates()
    return matrix


def grid_of(cells: Cells, times: int) -> HullGrid:
    """Join cells into ones of ``times`` the side."""
    wide = np.pad(cells.filled, [(0, -length % times) for length in cells.filled.shape])
    x, y, z = (length // times for length in wide.shape)
    share = wide.reshape(x, times, y, times, z, times).mean(axis=(1, 3, 5), dtype=np.float32)
    return HullGrid(share, cells.corner, times * cells.side)
