"""Which tile and how much light each card gets: colour from the photo where it shows the place."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.envelope import Envelope
from treestroke.core.leaf.grid import FoliageGrid
from treestroke.core.paint.palette import nearest_colour
from treestroke.core.paint.seasons import Recolour
from treestroke.core.types import Floats, Indices

SHOWN_DEPTH = 0.35
"""Places nearer to the viewer than this share of the crown's half depth are taken as seen by the photo."""
SIDEWAYS, UPDOWN = 0.9, 0.12
"""How far the colour of hidden places is fetched from, as shares of the crown's half width and height."""
WAVES = 4
"""Sine waves that make up the smooth displacement."""
WAVE_LENGTHS = (0.5, 1.3)
"""Their lengths, as shares of the crown's width: clumps of colour stay together, and none repeats."""
COLOUR_SCATTER = 3.0
"""Standard deviation, Lab units, of a card's colour about the photo's, so that neighbours mix their tiles."""
FOREIGN = 20.0
"""Lab distance from all tiles at which a pixel is no leaf's (sky, wood); the colour around it is taken instead."""
CLUMP = 0.6
"""Lengths of the waves by which a season's colour changes through the crown, against those of the displacement."""
MOOD_SCATTER = 0.45
"""Deviation of a card's place in a season's colours about its clump's, whose own is 1."""
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
class Colouring:
    """Chooses tiles for places in one crown.

    Attributes
    ----------
    grid, envelope
        The photo's colours and the crown's solid.
    tile_labs
        (k, 3) mean colours of the atlas's tiles, CIE Lab.
    sideways, updown
        Smooth fields that say from where a hidden place fetches its colour.
    recolour
        How the photo's colours became the tiles', or None where they are the same.
    mood
        Smooth field that says where in a season's colours a clump stands, if they are recoloured.
    """

    grid: FoliageGrid
    envelope: Envelope
    tile_labs: Floats
    sideways: _Waves
    updown: _Waves
    recolour: Recolour | None = None
    mood: _Waves | None = None

    def tiles(self, points: Floats, rng: np.random.Generator) -> Indices:
        """Choose a tile for each place (n, 3), metres: of the photo's colour there if it shows the place.

        Hidden places take the colour of another place of about the same height, displaced smoothly in space, so
        that clumps persist, while the back is no mirror image and no colour is smeared along the view.
        """
        half_depth, nearness = self.envelope.half_depth(points), points[:, 2] - self.envelope.middles(points)[:, 2]
        hidden = np.clip((SHOWN_DEPTH * half_depth - nearness) / np.maximum(half_depth, 1e-6), 0, 1)
        radius = self.envelope.radius_px.max() * self.grid.camera.metres_per_pixel
        height = self.grid.inside.shape[0] * self.grid.cell_m
        x = points[:, 0] + hidden * SIDEWAYS * radius * self.sideways.at(points)
        y = points[:, 1] + hidden * UPDOWN * height * self.updown.at(points)
        x, y = self._folded(x, y)
        cells, scatter = self.grid.flat_cells(x, y), rng.normal(0, COLOUR_SCATTER, points.shape)
        if self.recolour is not None and self.mood is not None:
            moods = _shares(self.mood.at(points) + rng.normal(0, MOOD_SCATTER, len(points)))
            labs = self.recolour.at(self.grid.labs[cells], moods)
            return nearest_colour(labs + scatter, self.tile_labs)[0]
        tiles, square = nearest_colour(self.grid.labs[cells] + scatter, self.tile_labs)
        foreign = square > FOREIGN**2
        tiles[foreign] = nearest_colour(self.grid.broad_labs[cells[foreign]] + scatter[foreign], self.tile_labs)[0]
        return tiles

    def _folded(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Fold places back at the crown's outline instead of smearing its border outward."""
        camera, envelope = self.grid.camera, self.envelope
        rows = np.flatnonzero(envelope.radius_px > 0)
        row = np.clip(camera.root_px[1] - y / camera.metres_per_pixel, rows[0], rows[-1]).astype(np.int64)
        middle = (envelope.middle_px[row] - camera.root_px[0]) * camera.metres_per_pixel
        radius = np.maximum(envelope.radius_px[row] * camera.metres_per_pixel, 1e-6)
        turn = (x - middle) / radius
        folded = 1 - np.abs(np.mod(turn + 1, 4) - 2)
        inward = np.asarray(middle + folded * radius)
        return inward, np.asarray((camera.root_px[1] - row - 0.5) * camera.metres_per_pixel)


def colouring_of(
    grid: FoliageGrid, envelope: Envelope, tile_labs: Floats, recolour: Recolour | None, rng: np.random.Generator
) -> Colouring:
    """Draw the smooth displacements for one crown."""
    width = 2 * envelope.radius_px.max() * grid.camera.metres_per_pixel
    sideways, updown = _draw_waves(width, rng), _draw_waves(width, rng)
    mood = None if recolour is None else _draw_waves(CLUMP * width, rng)
    return Colouring(grid, envelope, tile_labs, sideways, updown, recolour, mood)


def _shares(values: Floats) -> Floats:
    """Turn values (n,) of about mean 0 and deviation 1 into shares, 0 to 1, spread about evenly."""
    return np.asarray(1 / (1 + np.exp(-1.6 * values)))


def _draw_waves(width: float, rng: np.random.Generator) -> _Waves:
    """Draw waves of random direction, in wave numbers per metre."""
    directions = rng.normal(size=(WAVES, 3))
    directions /= np.sqrt((directions**2).sum(axis=1, keepdims=True))
    lengths = width * rng.uniform(*WAVE_LENGTHS, (WAVES, 1))
    return _Waves(directions * 2 * np.pi / lengths, rng.uniform(0, 2 * np.pi, WAVES))


def shades(points: Floats, lift: Floats, envelope: Envelope) -> Floats:
    """Brightness of places (n, 3) in the crown, DARKEST to 1.

    Light falls in from outside and above: brightness grows with the reach from the crown's axis and with height,
    and cards above their branch (lift towards 1) are brighter than those below it (towards -1).
    """
    rows = np.flatnonzero(envelope.radius_px > 0)
    top, bottom = (envelope.camera.root_px[1] - np.array([rows[0], rows[-1] + 1])) * envelope.camera.metres_per_pixel
    height = np.clip((points[:, 1] - bottom) / (top - bottom), 0, 1)
    openness = np.clip(np.hypot(envelope.reach(points), np.maximum(0, 2 * height - 1)), 0, 1)
    light = np.clip(1.15 * openness + 0.2 * height + 0.12 * lift - 0.15, 0, 1)
    return np.asarray(DARKEST + (1 - DARKEST) * light * light * (3 - 2 * light))
