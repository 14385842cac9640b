"""Imagines a crown from the left, where no photo shows it, as one like its front."""

from dataclasses import dataclass

import cv2
import numpy as np

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.clumped_crown import Cells, ClumpedCrown
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import TurnedOutline
from treestroke.core.geometry.polyline import smoothed
from treestroke.core.imaging.analogy import Analogy, analogy
from treestroke.core.types import Floats, Indices, Mask

CELLS = 80
"""Cells along the crown's longer side."""
BORDER = 8
"""Empty cells to the left and right of the crown."""
EVEN, TREND = 0.04, 0.12
"""Standard deviations, as shares of the crown's height, over which its outline is evened, and averaged to a trend."""
DEEP, SHALLOWEST = 1.05, 0.5
"""Depth of the sections over their width, as leaves lie under their surface (at 1.15 four trees came out 1.07 times as
deep as wide, at 1.05 0.94 times); and least depth over the width's trend."""
LEAN = 0.6
"""How far sections stand before or behind the stem, over how far they stand beside it."""
NARROWEST = 0.5
"""Depth of the foliage over its section's, at heights at which the imagined side shows none."""


@dataclass(frozen=True, eq=False)
class ImaginedCrown:
    """A crown's front, in cells of a coarse picture, and its left side, which is imagined.

    Attributes
    ----------
    outline
        The sections at the rows of the front camera's picture.
    corner_px, cell_px
        (2,) the first cell's corner in that picture, and a cell's side, px.
    front
        (h, w) the crown's front.
    middle, radius, near, deep
        (h,) its sections, as in `Sections`.
    side
        (h, v) its left side, as deep before the root's plane as behind it.
    patches
        Which cell of the front each cell of the side is like.
    """

    outline: TurnedOutline
    corner_px: Floats
    cell_px: float
    front: Mask
    middle: Floats
    radius: Floats
    near: Floats
    deep: Floats
    side: Mask
    patches: Analogy

    @property
    def furthest(self) -> int:
        """How far before and behind the root's plane the side reaches, cells."""
        return int(self.side.shape[1]) // 2

    def rows(self, y: Floats) -> Indices:
        """Return the rows (n,) that hold places y (n,)."""
        return np.clip(y.astype(np.int64), 0, len(self.front) - 1)

    def cells_from_picture_space(self, points_px: Floats) -> Floats:
        """Carry points (n, 3) of the front camera's picture space, px, to cells (n, 3); z counts from the root."""
        return np.asarray((points_px - np.append(self.corner_px, 0.0)) / self.cell_px)

    def filled(self, cells: Mask) -> ClumpedCrown:
        """Return the crown whose foliage fills some cells (w, h, v)."""
        camera, outline = self.outline.camera, self.outline
        row = (np.arange(camera.height) + 0.5 - self.corner_px[1]) / self.cell_px - 0.5
        near, deep = (self.cell_px * np.interp(row, np.arange(len(of)), of) for of in (self.near, self.deep))
        corner = np.append(self.corner_px, -self.cell_px * self.furthest)
        clumps = Cells(cells, corner, self.cell_px)
        return ClumpedCrown(camera, outline.middle_px, outline.radius_px, outline.silhouettes, near, deep, clumps)

    def hull(self) -> ClumpedCrown:
        """Return the crown that fills all that front and side show."""
        return self.filled(self.front.T[:, :, None] & self.side)

    def side_of(self, front: Mask) -> Silhouette[OrthographicCamera]:
        """Imagine from the left what the front camera's picture (h, w) shows of the crown."""
        patches, (first_x, first_y) = self.patches, self.corner_px.tolist()
        left = self.outline.camera.to_the_left(self.furthest * self.cell_px)
        row, down = np.divmod((np.arange(left.height) + 0.5 - first_y) / self.cell_px, 1)
        column, aside = np.divmod((np.arange(left.width, dtype=np.float32) + np.float32(0.5)) / self.cell_px, 1)
        filled = np.flatnonzero((row >= 0) & (row < len(self.side)))
        here = np.ix_(row[filled].astype(np.int64), np.minimum(column.astype(np.int64), self.side.shape[1] - 1))
        source_row, source_column = (of.astype(np.float32)[here] for of in (patches.row, patches.column))
        aside = np.where(patches.mirrored[here], 1 - aside, aside)
        y = first_y - 0.5 + self.cell_px * (source_row + down[filled, None].astype(np.float32))
        x = first_x - 0.5 + self.cell_px * (source_column - BORDER + aside)
        copied = cv2.remap(front.astype(np.uint8), x, y, cv2.INTER_NEAREST)
        mask = np.zeros((left.height, left.width), dtype=np.bool_)
        mask[filled] = (source_row >= 0) & (copied > 0)
        return Silhouette(mask, left)


def imagined_crown(
    outline: TurnedOutline, front: Silhouette[OrthographicCamera], rng: np.random.Generator
) -> ImaginedCrown:
    """Imagine a crown's left side, from its outline and its silhouette in front.

    Its sections are about as deep as wide, each by a guess of its own: depth, and how far the sections stand before or
    behind the stem, vary along the height as width and middle do. Along that outline the side is put together of
    patches of the front, so that it has its bays and gaps.

    Source: surrogate data, Theiler et al. 1992 (the same spectrum, other phases); image analogies, Hertzmann et al.
    2001.
    """
    mask = front.mask
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    corner = np.array([columns[0], rows[0]], dtype=np.float64)
    cell = float(max(np.ptp(rows), np.ptp(columns)) + 1) / CELLS
    shown = _coarse(mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1], cell)
    row = np.minimum(corner[1] + (np.arange(len(shown)) + 0.5) * cell, len(outline.radius_px) - 1).astype(np.int64)
    middle, radius = (outline.middle_px[row] - corner[0]) / cell, np.maximum(outline.radius_px[row] / cell, 0.5)
    near, deep = _sections(middle, radius, (front.camera.pixels_from_world(np.zeros((1, 3)))[0] - corner) / cell, rng)
    side, patches = _side(shown, (middle, radius), (near, deep), rng)
    return ImaginedCrown(outline, corner, cell, shown, middle, radius, near, deep, side, patches)


def _coarse(mask: Mask, cell: float) -> Mask:
    """Reduce a silhouette (h, w) to cells of a side, px."""
    size = [max(1, round(length / cell)) for length in mask.shape[::-1]]
    return np.asarray(cv2.resize(mask.astype(np.uint8) * np.uint8(255), size, interpolation=cv2.INTER_AREA) > 127)


def _sections(middle: Floats, radius: Floats, root: Floats, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Guess how far before the root's plane sections (h,) stand, and how deep they are; the ``root`` (2,) in cells."""
    height = np.arange(len(radius), dtype=np.float64)
    centre_x, centre_y = (float((radius * of).sum() / radius.sum()) for of in (middle, height))
    stem = root[0] + (centre_x - root[0]) * np.clip((root[1] - height) / max(root[1] - centre_y, 1.0), 0.0, 1.5)
    trend, aside = (smoothed(column, TREND * len(height)) for column in (radius, middle - stem))
    varied = trend + _other_phases(smoothed(radius, EVEN * len(height)) - trend, rng)
    deep = DEEP * np.maximum(varied, SHALLOWEST * trend)
    return LEAN * _other_phases(aside, rng), deep


def _other_phases(values: Floats, rng: np.random.Generator) -> Floats:
    """Return values (n,) that vary as much and as fast as the ones given, in another way; their mean's sign is random.

    Source: surrogate data, Theiler et al. 1992: the same spectrum, with phases at random.
    """
    spectrum = np.fft.rfft(np.concatenate([values, values[::-1]]))
    turn = np.exp(2j * np.pi * rng.random(len(spectrum)))
    turn[0] = rng.choice((-1.0, 1.0))
    return np.asarray(np.fft.irfft(spectrum * turn, 2 * len(values))[: len(values)], dtype=np.float64)


def _side(
    front: Mask, across: tuple[Floats, Floats], along: tuple[Floats, Floats], rng: np.random.Generator
) -> tuple[Mask, Analogy]:
    """Put a side together of patches of the front (h, w), by middles and half widths (h,) of both: it (h, v), and how.

    Each height at which the front shows foliage has some.
    """
    near, deep = along
    furthest = int(np.ceil((np.abs(near) + deep).max())) + BORDER
    bordered = np.pad(front, ((0, 0), (BORDER, BORDER)))
    depths = _depths_within(across[0] + BORDER, across[1], bordered.shape[1])
    patches = analogy(bordered, depths, _depths_within(near + furthest, deep, 2 * furthest), rng)
    side = patches.of(bordered)
    away = np.abs(np.arange(2 * furthest) + 0.5 - furthest - near[:, None])
    side |= ~side.any(axis=1, keepdims=True) & (away <= np.maximum(1.0, NARROWEST * deep[:, None]))
    return side, patches


def _depths_within(middle: Floats, radius: Floats, width: int) -> Floats:
    """Measure how far cells (h, width) lie within rows of a middle and half width (h,): negative outside, cells."""
    inside = np.pad(np.abs(np.arange(width) + 0.5 - middle[:, None]) <= radius[:, None], 1).astype(np.uint8)
    within, outside = (cv2.distanceTransform(of, cv2.DIST_L2, 5)[1:-1, 1:-1] for of in (inside, 1 - inside))
    return np.asarray(within - outside, dtype=np.float64)
