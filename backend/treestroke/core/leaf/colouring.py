"""Chooses each card's tile and brightness: by the picture's colour where a view shows the place."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.camera import in_picture
from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.imaging.blur import broadly_blurred
from treestroke.core.imaging.light import luminance_of_lightness
from treestroke.core.leaf.coverage import Depths
from treestroke.core.leaf.daylight import Daylight, daylight
from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.paint.palette import nearest_colour
from treestroke.core.paint.seasons import Recolour
from treestroke.core.types import Floats, Indices, Mask

AWAY = 0.5
"""How far behind what a view sees places have left its colour behind, over half the crown's width."""
BOUGH = 0.05
"""Standard deviation of the blur that finds the lightness of boughs, as a share of the foliage's height."""
QUANTILES = np.linspace(0.02, 0.98, 25)
"""Shares of what a view sees at which light and lightness are told."""
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
DEPTH_SHADE = 0.6
"""Brightness of unseen leaves where no light of the sky comes, against 1 where as much comes as to half of those that
are seen: the photo shows the light on the outside, but not how much darker it is within."""


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
class SeenSide:
    """What one view sees of a crown's cards.

    Attributes
    ----------
    nearest
        (cells,) depth, metres, of the nearest card in each cell of its grid; infinite where there is none.
    broad
        (cells,) lightness of the boughs about each cell, CIE Lab.
    lights, lightnesses
        (q,) quantiles of the sky's light on the cards that it sees, and of their boughs' lightness, CIE Lab.
    slope
        (3,) how colours, CIE Lab, change with their boughs' lightness: shade is bluer than sunlight.
    """

    nearest: Depths
    broad: Floats
    lights: Floats
    lightnesses: Floats
    slope: Floats


@dataclass(frozen=True, eq=False)
class Colouring:
    """Chooses tiles for places in one crown.

    Attributes
    ----------
    grids, volume, sky
        What the views show, the crown, and the light that falls into it.
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

    grids: tuple[FoliageGrid, ...]
    volume: CrownVolume
    sky: Daylight
    tile_labs: Floats
    sideways: _Waves
    updown: _Waves
    height: float
    recolour: Recolour | None = None
    mood: _Waves | None = None

    def seen(self, points: Floats, rng: np.random.Generator, shown: Mask | None = None) -> tuple[Indices, Floats]:
        """Choose a tile (n,) for each place (n, 3), metres, and how bright it is there (n,) over its own brightness.

        It is the tile nearest to the colour there in the view that shows the place best: the view toward which the
        place stands furthest out of the crown, of those in which it is ``shown`` (views, n).
        """
        view, labs = self._best_view(points, shown), np.empty(points.shape)
        for number, grid in enumerate(self.grids):
            own = view == number
            labs[own] = grid.labs[grid.cells_of(points[own])]
        return self._tiles(points, labs, rng)

    def unseen(self, points: Floats, sides: Sequence[SeenSide], rng: np.random.Generator) -> tuple[Indices, Floats]:
        """Choose tiles for places (n, 3), metres, that no view shows, as `seen`, by what each view sees elsewhere.

        A place has the colour of another one of about the same height, displaced smoothly in space, so that clumps
        persist, while the back is no mirror image and no colour is smeared along the view. It is as light as what gets
        as much light of the sky, and darker within the crown.
        """
        view, labs, light = self._best_view(points), np.empty(points.shape), self.sky.at(points)
        within = np.empty(len(points))
        for number, (grid, side) in enumerate(zip(self.grids, sides, strict=True)):
            own = view == number
            labs[own] = _relit(grid, side, self._displaced(grid, side, points[own]), light[own])
            within[own] = light[own] / np.maximum(np.median(side.lights), 1e-9)
        tiles, brightness = self._tiles(points, labs, rng)
        return tiles, brightness * (DEPTH_SHADE + (1 - DEPTH_SHADE) * np.minimum(within, 1.0))

    def side(self, grid: FoliageGrid, nearest: Depths, seen: Floats) -> SeenSide:
        """Describe what a view sees: depths (cells,), metres, as `SeenSide` has them, and cards at ``seen`` (n, 3)."""
        rows, columns = grid.inside.shape
        broad = broadly_blurred(grid.labs[:, 0].reshape(rows, columns), BOUGH * rows).ravel()
        cells = grid.cells_of(seen)
        lights, lightnesses = (np.quantile(values, QUANTILES) for values in (self.sky.at(seen), broad[cells]))
        return SeenSide(nearest, broad, lights, lightnesses, _slope(broad[cells], grid.labs[cells]))

    def _tiles(self, points: Floats, labs: Floats, rng: np.random.Generator) -> tuple[Indices, Floats]:
        """Choose the tile (n,) nearest to a colour (n, 3), CIE Lab, at each place (n, 3), and its factor (n,)."""
        if self.recolour is not None and self.mood is not None:
            moods = _shares(self.mood.at(points) + rng.normal(0, MOOD_SCATTER, len(points)))
            labs = self.recolour.at(labs, moods)
        tiles = nearest_colour(labs + rng.normal(0, COLOUR_SCATTER, points.shape), self.tile_labs)[0]
        wanted, own = luminance_of_lightness(labs[:, 0]), luminance_of_lightness(self.tile_labs[tiles, 0])
        return tiles, wanted / np.maximum(own, 1e-6)

    def _displaced(self, grid: FoliageGrid, side: SeenSide, points: Floats) -> Floats:
        """Places (n, 3), metres, whose colour in a view unseen places (n, 3) take: far ones behind what it sees."""
        behind = grid.camera.depth(points) - side.nearest[grid.cells_of(points)]
        away = np.clip(behind / (AWAY * self.volume.widest), 0, 1)
        right = grid.camera.right()
        x = points @ right + away * SIDEWAYS * self.volume.widest * self.sideways.at(points)
        y = points[:, 1] + away * UPDOWN * self.height * self.updown.at(points)
        return self._folded(x, y, right)

    def _best_view(self, points: Floats, among: Mask | None = None) -> Indices:
        """Find the view (n,), ``among`` some (views, n), toward which places (n, 3) stand furthest from the axis."""
        cameras = [grid.camera for grid in self.grids]
        if len(cameras) == 1:
            return np.zeros(len(points), dtype=np.int64)
        outward = points - self.volume.axis(points[:, 1])
        nearness = np.stack([(outward * camera.toward_viewer(points)).sum(axis=1) for camera in cameras])
        shown = np.stack([in_picture(camera, points) for camera in cameras]) if among is None else among
        return np.asarray(np.argmax(np.where(shown, nearness, -np.inf), axis=0))

    def _folded(self, x: Floats, y: Floats, right: Floats) -> Floats:
        """Fold places back at the crown's outline instead of smearing its border outward: (n, 3), metres.

        ``x`` (n,), metres, counts along the direction ``right`` (3,) of the view, ``y`` (n,) upward.
        """
        low, high = self.volume.bounds[:, 1].tolist()
        inset = 1e-9 * (high - low)
        y = np.clip(y, low + inset, high - inset)
        axis, radius = self.volume.axis(y), np.maximum(self.volume.half_width(y), 1e-6)
        middle = axis @ right
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
    width, sky = 2 * volume.widest, daylight(volume)
    sideways, updown = _draw_waves(width, rng), _draw_waves(width, rng)
    mood = None if recolour is None else _draw_waves(CLUMP * width, rng)
    height = grids[0].inside.shape[0] * grids[0].cell_m
    return Colouring(tuple(grids), volume, sky, tile_labs, sideways, updown, height, recolour, mood)


def _relit(grid: FoliageGrid, side: SeenSide, points: Floats, light: Floats) -> Floats:
    """Colour (n, 3), CIE Lab, where points (n, 3), metres, project, under other light of the sky (n,).

    Of the picture's light and shade that of leaves and twigs stays. A bough is as light as those that get as much
    light: the shares of what is seen that are darker and that get less light are the same.
    """
    cells = grid.cells_of(points)
    labs = grid.labs[cells]
    lighter = np.interp(light, side.lights, side.lightnesses) - side.broad[cells]
    return np.asarray(labs + lighter[:, None] * side.slope)


def _slope(lightness: Floats, labs: Floats) -> Floats:
    """How much colours (n, 3), CIE Lab, change with their boughs' lightness (n,), by least squares: (3,), L by 1."""
    away = lightness - lightness.mean()
    slope = away @ (labs - labs.mean(axis=0)) / max(float(away @ away), 1e-9)
    return np.array([1.0, slope[1], slope[2]])


def _shares(values: Floats) -> Floats:
    """Turn values (n,) of about mean 0 and deviation 1 into shares, 0 to 1, spread about evenly."""
    return np.asarray(1 / (1 + np.exp(-1.6 * values)))


def _draw_waves(width: float, rng: np.random.Generator) -> _Waves:
    """Draw waves of random direction, in wave numbers per metre."""
    directions = rng.normal(size=(WAVES, 3))
    directions /= np.sqrt((directions**2).sum(axis=1, keepdims=True))
    lengths = width * rng.uniform(*WAVE_LENGTHS, (WAVES, 1))
    return _Waves(directions * 2 * np.pi / lengths, rng.uniform(0, 2 * np.pi, WAVES))
