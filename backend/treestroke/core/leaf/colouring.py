"""Chooses each card's tile and light: by the picture's colour where a view shows the place."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.camera import in_picture
from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.paint.palette import nearest_colour
from treestroke.core.paint.seasons import Recolour
from treestroke.core.types import Floats, Indices

SHOWN_DEPTH = 0.35
"""Places nearer to the viewer than this share of the crown's half depth count as seen."""
SIDEWAYS, UPDOWN = 0.9, 0.12
"""Distances from which hidden places take their colour, as shares of the crown's half width and height."""
WAVES = 4
"""Sine waves that make up the smooth displacement."""
WAVE_LENGTHS = (0.5, 1.3)
"""Their lengths, as shares of the crown's width: clumps of colour stay together, and none repeats."""
COLOUR_SCATTER = 3.0
"""Standard deviation, Lab units, of a card's colour about the picture's, so that neighbours mix their tiles."""
FOREIGN = 20.0
"""Lab distance from all tiles above which a pixel is sky or wood; the mean colour around it is taken instead."""
CLUMP = 0.6
"""Lengths of the waves of a season's colours through the crown, over those of the displacement."""
MOOD_SCATTER = 0.45
"""Standard deviation of a card's position in a season's colours about its clump's, which itself varies by 1."""
DARKEST = 0.55
"""Brightness deep inside the crown and at its foot, against 1 at its outside."""


@dataclass(frozen=True, eq=False)
class _Waves:
    """A smooth displacement of space in [-1, 1], the sum of a few sines."""

    vectors: Floats
    phases: Floats

    def at(self, points: Floats) -> Floats:
        """Displacement at points (n, 3): (n,)."""
        total = np.zeros(len(points))
        for vector, phase in zip(self.vectors, self.phases, strict=True):
            total += np.sin(points[:, 0] * vector[0] + points[:, 1] * vector[1] + points[:, 2] * vector[2] + phase)
        return np.asarray(total / np.sqrt(2 * len(self.phases)))


@dataclass(frozen=True, eq=False)
class _CellColours:
    """The colours of all views' cells, one view after the other.

    ``labs`` and ``broad_labs`` (cells, 3) are those of `FoliageGrid`; ``first`` (views,) is each view's first cell.
    """

    grids: tuple[FoliageGrid, ...]
    labs: Floats
    broad_labs: Floats
    first: Indices

    @staticmethod
    def of(grids: Sequence[FoliageGrid]) -> "_CellColours":
        first = np.cumsum([0] + [len(grid.labs) for grid in grids[:-1]])
        labs, broad = (np.concatenate([getattr(grid, name) for grid in grids]) for name in ("labs", "broad_labs"))
        return _CellColours(tuple(grids), labs, broad, first)

    def cells_of(self, points: Floats, view: Indices) -> Indices:
        """Cells (n,) onto which points (n, 3), metres, project, each in its own view (n,)."""
        cells = np.empty(len(points), dtype=np.int64)
        for number, grid in enumerate(self.grids):
            cells[view == number] = self.first[number] + grid.cells_of(points[view == number])
        return cells


@dataclass(frozen=True, eq=False)
class Colouring:
    """Chooses tiles for places in one crown.

    Attributes
    ----------
    colours, volume
        The views' colours and the crown.
    tile_labs
        (k, 3) mean colours of the atlas's tiles, CIE Lab.
    sideways, updown
        Smooth fields that say from where a hidden place fetches its colour.
    height
        The foliage's in the first view, metres.
    recolour
        How the pictures' colours became the tiles', or None where they are the same.
    mood
        Smooth field that says where in a season's colours a clump stands, if they are recoloured.
    """

    colours: _CellColours
    volume: CrownVolume
    tile_labs: Floats
    sideways: _Waves
    updown: _Waves
    height: float
    recolour: Recolour | None = None
    mood: _Waves | None = None

    def tiles(self, points: Floats, rng: np.random.Generator) -> Indices:
        """Choose a tile (n,) for each place (n, 3), metres: of the colour there in the view that shows the place best.

        That is the view toward which the place stands furthest out of the crown. Places that no view shows take the
        colour of another place of about the same height, displaced smoothly in space, so that clumps persist, while the
        back is no mirror image and no colour is smeared along the view.
        """
        view, nearness = self._best_view(points)
        half_depth = self.volume.half_depth(points)
        hidden = np.clip((SHOWN_DEPTH * half_depth - nearness) / np.maximum(half_depth, 1e-6), 0, 1)
        right = np.stack([grid.camera.right() for grid in self.colours.grids])[view]
        x = (points * right).sum(axis=1) + hidden * SIDEWAYS * self.volume.widest * self.sideways.at(points)
        y = points[:, 1] + hidden * UPDOWN * self.height * self.updown.at(points)
        cells = self.colours.cells_of(self._folded(x, y, right), view)
        scatter = rng.normal(0, COLOUR_SCATTER, points.shape)
        if self.recolour is not None and self.mood is not None:
            moods = _shares(self.mood.at(points) + rng.normal(0, MOOD_SCATTER, len(points)))
            labs = self.recolour.at(self.colours.labs[cells], moods)
            return nearest_colour(labs + scatter, self.tile_labs)[0]
        tiles, square = nearest_colour(self.colours.labs[cells] + scatter, self.tile_labs)
        foreign = square > FOREIGN**2
        broad = self.colours.broad_labs[cells[foreign]] + scatter[foreign]
        tiles[foreign] = nearest_colour(broad, self.tile_labs)[0]
        return tiles

    def _best_view(self, points: Floats) -> tuple[Indices, Floats]:
        """Find the view (n,) toward which each place (n, 3) stands furthest from the axis, and how far (n,), metres."""
        outward = points - self.volume.axis(points[:, 1])
        cameras = [grid.camera for grid in self.colours.grids]
        nearness = np.stack([(outward * camera.toward_viewer(points)).sum(axis=1) for camera in cameras])
        if len(cameras) == 1:
            return np.zeros(len(points), dtype=np.int64), nearness[0]
        shown = np.stack([in_picture(camera, points) for camera in cameras])
        view = np.argmax(np.where(shown, nearness, -np.inf), axis=0)
        return view, nearness[view, np.arange(len(points))]

    def _folded(self, x: Floats, y: Floats, right: Floats) -> Floats:
        """Fold places back at the crown's outline instead of smearing its border outward: (n, 3), metres.

        ``x`` (n,), metres, counts along the directions ``right`` (n, 3) of the views, ``y`` (n,) upward.
        """
        low, high = self.volume.bounds[:, 1].tolist()
        inset = 1e-9 * (high - low)
        y = np.clip(y, low + inset, high - inset)
        axis, radius = self.volume.axis(y), np.maximum(self.volume.half_width(y), 1e-6)
        middle = (axis * right).sum(axis=1)
        folded = 1 - np.abs(np.mod((x - middle) / radius + 1, 4) - 2)
        return np.asarray((middle + folded * radius)[:, None] * right + (axis - middle[:, None] * right))


def colouring_of(
    grids: Sequence[FoliageGrid],
    volume: CrownVolume,
    tile_labs: Floats,
    recolour: Recolour | None,
    rng: np.random.Generator,
) -> Colouring:
    """Draw the smooth displacements for one crown; ``tile_labs`` (k, 3) are its tiles' colours, CIE Lab."""
    width = 2 * volume.widest
    sideways, updown = _draw_waves(width, rng), _draw_waves(width, rng)
    mood = None if recolour is None else _draw_waves(CLUMP * width, rng)
    height = grids[0].inside.shape[0] * grids[0].cell_m
    return Colouring(_CellColours.of(grids), volume, tile_labs, sideways, updown, height, recolour, mood)


def _shares(values: Floats) -> Floats:
    """Turn values (n,) of about mean 0 and deviation 1 into shares, 0 to 1, spread about evenly."""
    return np.asarray(1 / (1 + np.exp(-1.6 * values)))


def _draw_waves(width: float, rng: np.random.Generator) -> _Waves:
    """Draw waves of random direction, in wave numbers per metre."""
    directions = rng.normal(size=(WAVES, 3))
    directions /= np.sqrt((directions**2).sum(axis=1, keepdims=True))
    lengths = width * rng.uniform(*WAVE_LENGTHS, (WAVES, 1))
    return _Waves(directions * 2 * np.pi / lengths, rng.uniform(0, 2 * np.pi, WAVES))


def shades(points: Floats, lift: Floats, volume: CrownVolume) -> Floats:
    """Brightness (n,) of places (n, 3), metres, in the crown, DARKEST to 1.

    Light falls in from outside and above: brightness grows with the reach from the crown's axis and with height,
    and cards above their branch (``lift`` (n,) towards 1) are brighter than those below it (towards -1).
    """
    bottom, top = volume.bounds[:, 1].tolist()
    height = np.clip((points[:, 1] - bottom) / (top - bottom), 0, 1)
    openness = np.clip(np.hypot(volume.reach(points), np.maximum(0, 2 * height - 1)), 0, 1)
    light = np.clip(1.15 * openness + 0.2 * height + 0.12 * lift - 0.15, 0, 1)
    return np.asarray(DARKEST + (1 - DARKEST) * light * light * (3 - 2 * light))
