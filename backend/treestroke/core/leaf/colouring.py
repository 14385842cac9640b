"""Chooses each card's tile and brightness: by the picture's colour where a view shows the place."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.camera import in_picture
from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.imaging.light import luminance_of_lightness
from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.paint.palette import nearest_colour
from treestroke.core.paint.seasons import Recolour
from treestroke.core.types import Floats, Indices

HIDDEN_BEHIND = 0.15
"""Places further behind the crown's middle than this share of its half depth count as hidden: what lies before them is
seen somewhere, through gaps too."""
SIDEWAYS, UPDOWN = 0.9, 0.12
"""Distances from which hidden places take their colour, as shares of the crown's half width and height."""
WAVES = 4
"""Sine waves that make up the smooth displacement."""
WAVE_LENGTHS = (0.5, 1.3)
"""Their lengths, as shares of the crown's width: clumps of colour stay together, and none repeats."""
COLOUR_SCATTER = 1.5
"""Standard deviation, Lab units, of a card's colour about the picture's, so that neighbours mix their tiles."""
CLUMP = 0.6
"""Lengths of the waves of a season's colours through the crown, over those of the displacement."""
MOOD_SCATTER = 0.45
"""Standard deviation of a card's position in a season's colours about its clump's, which itself varies by 1."""
DEPTH_SHADE = 0.7
"""Brightness deep inside the crown and at its foot, against 1 at its outside: the photo shows the light on the outside,
but not how much darker it is within."""


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

    ``labs`` (cells, 3) are those of `FoliageGrid`; ``first`` (views,) is each view's first cell.
    """

    grids: tuple[FoliageGrid, ...]
    labs: Floats
    first: Indices

    @staticmethod
    def of(grids: Sequence[FoliageGrid]) -> "_CellColours":
        first = np.cumsum([0] + [len(grid.labs) for grid in grids[:-1]])
        return _CellColours(tuple(grids), np.concatenate([grid.labs for grid in grids]), first)

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

    def tiles(self, points: Floats, rng: np.random.Generator) -> tuple[Indices, Floats]:
        """Choose a tile (n,) for each place (n, 3), metres, and how bright it is there (n,) over its own brightness.

        It is the tile nearest to the colour there in the view that shows the place best: the view toward which the
        place stands furthest out of the crown. Places that no view shows take the colour of another place of about the
        same height, displaced smoothly in space, so that clumps persist, while the back is no mirror image and no
        colour is smeared along the view.
        """
        labs = self._labs(points)
        if self.recolour is not None and self.mood is not None:
            moods = _shares(self.mood.at(points) + rng.normal(0, MOOD_SCATTER, len(points)))
            labs = self.recolour.at(labs, moods)
        tiles = nearest_colour(labs + rng.normal(0, COLOUR_SCATTER, points.shape), self.tile_labs)[0]
        wanted, own = luminance_of_lightness(labs[:, 0]), luminance_of_lightness(self.tile_labs[tiles, 0])
        return tiles, wanted / np.maximum(own, 1e-6)

    def _labs(self, points: Floats) -> Floats:
        """Colour (n, 3), CIE Lab, that the views give places (n, 3), metres."""
        view, nearness = self._best_view(points)
        half_depth = self.volume.half_depth(points)
        hidden = np.clip(-nearness / np.maximum(half_depth, 1e-6) - HIDDEN_BEHIND, 0, 1)
        right = np.stack([grid.camera.right() for grid in self.colours.grids])[view]
        x = (points * right).sum(axis=1) + hidden * SIDEWAYS * self.volume.widest * self.sideways.at(points)
        y = points[:, 1] + hidden * UPDOWN * self.height * self.updown.at(points)
        return self.colours.labs[self.colours.cells_of(self._folded(x, y, right), view)]

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
    """Brightness (n,) of places (n, 3), metres, in the crown, `DEPTH_SHADE` to 1.

    Light falls in from outside and above: brightness grows with the reach from the crown's axis and with height,
    and cards above their branch (``lift`` (n,) towards 1) are brighter than those below it (towards -1).
    """
    bottom, top = volume.bounds[:, 1].tolist()
    height = np.clip((points[:, 1] - bottom) / (top - bottom), 0, 1)
    openness = np.clip(np.hypot(volume.reach(points), np.maximum(0, 2 * height - 1)), 0, 1)
    light = np.clip(1.15 * openness + 0.2 * height + 0.12 * lift - 0.15, 0, 1)
    return np.asarray(DEPTH_SHADE + (1 - DEPTH_SHADE) * light * light * (3 - 2 * light))
