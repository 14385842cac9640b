"""Seasons: colour, size and number of leaves."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.paint.palette import Palette
from treestroke.core.paint.species import AUTO, CONIFER, Ramp, Species
from treestroke.core.types import EVERGREEN, Floats, FoliageKind

SEASONS = ("spring", "summer", "autumn", "bare")
"""Values of the setting `season` apart from `photo`."""
LEAFY = ("spring", "summer", "autumn")
"""Seasons in which a tree has leaves, whatever the photo shows."""
SIZE_AND_NUMBER = {"spring": (0.8, 0.6), "autumn": (1.0, 0.85)}
"""Factors on the size and number of leaves, relative to summer."""
BLOSSOM_SIZE_AND_NUMBER = (1.0, 0.85)
"""The same factors for flowers."""
LIGHT_KEPT, HUE_KEPT = 0.55, 0.25
"""Share of the photo's differences from its mean, in lightness and in hue, that a season keeps."""
DEVIATION = 22.0
"""Greatest difference from the photo's mean that is kept, CIE Lab: larger ones are sky or wood."""
BRIGHTNESS_KEPT = 0.4
"""Share by which the season's mean lightness approaches that of a darker or brighter photo."""
MOST_BRIGHTNESS_KEPT = 10.0
"""Greatest change of the season's mean lightness by the photo's, CIE Lab."""
CHROMA_FACTORS = (0.55, 1.2)
"""Least and greatest factor on a colour's chroma, in shade and in light."""
GREY_SPREAD = np.array([7.0, 2.5, 3.0])
"""Standard deviation of the grey palette's colours in L, a and b, CIE Lab."""
GREY_MEMBERS = 240
"""Colours in each cluster of the grey palette."""
GREY = (50.0, 0.0, 0.0)
"""Mean colour of the grey palette, CIE Lab."""
GREEN_A, GREEN_B = -6.0, 8.0
"""CIE Lab a below which and b above which a photo's foliage counts as green."""
WARM_A = 6.0
"""CIE Lab a above which a photo's foliage shows autumn, if b also exceeds twice this."""
SPRING_TIPS: Ramp = ((0.0, 0.0, 0.0), (1.0, 0.0, 1.0), (8.0, -2.0, 9.0))
"""Added to needles' colours in spring, CIE Lab: the youngest needles are light."""


@dataclass(frozen=True, eq=False)
class Recolour:
    """Mapping from a photo's colours to a season's, CIE Lab: leaves that differ in the photo differ in the result.

    Attributes
    ----------
    mean
        (3,) mean colour of the photo's foliage.
    ramp
        (k, 3) colours between which the new ones lie, at positions from 0 to 1.
    kept
        (3,) share of the differences from the mean that is kept, in L, a and b.
    """

    mean: Floats
    ramp: Floats
    kept: Floats

    def at(self, labs: Floats, position: Floats) -> Floats:
        """Map colours of the photo (n, 3), CIE Lab, to new ones (n, 3), at positions (n,) along the ramp, 0 to 1."""
        along = np.clip(position, 0, 1) * (len(self.ramp) - 1)
        first = np.minimum(along, max(len(self.ramp) - 2, 0)).astype(np.int64)
        second = np.minimum(first + 1, len(self.ramp) - 1)
        base = self.ramp[first] + (along - first)[:, None] * (self.ramp[second] - self.ramp[first])
        kept = self.kept * np.clip(labs - self.mean, -DEVIATION, DEVIATION)
        lightness = np.clip(base[:, 0] + kept[:, 0], 6.0, 96.0)
        chroma = np.clip(lightness / base[:, 0], *CHROMA_FACTORS)[:, None]
        return np.concatenate([lightness[:, None], chroma * (base[:, 1:] + kept[:, 1:])], axis=1)

    def palette(self, palette: Palette, tiles: int, rng: np.random.Generator) -> Palette:
        """Recolour a palette and extend it to this many clusters, each about a position of its own along the ramp."""
        golden_ratio, count = 0.618, len(palette.members)
        members = []
        for tile in range(tiles):
            labs = palette.members[tile % count]
            members.append(self.at(labs, (0.5 + golden_ratio * tile) % 1.0 + rng.normal(0, 0.12, len(labs))))
        shares = np.resize(palette.shares, tiles)
        return Palette(np.stack([m.mean(axis=0) for m in members]), shares / shares.sum(), tuple(members))


def is_evergreen(species: Species, kind: FoliageKind) -> bool:
    """Tell whether a tree keeps its leaves; needles, scales and fronds of an unknown species are kept."""
    return species.evergreen or (kind in EVERGREEN and species.needles is None)


def size_and_density(season: str, species: Species, kind: FoliageKind) -> tuple[float, float]:
    """Return the factors on the size and on the number of leaves in a season."""
    if is_evergreen(species, kind):
        return 1.0, 1.0
    if season == "spring" and species.flowers:
        return BLOSSOM_SIZE_AND_NUMBER
    return SIZE_AND_NUMBER.get(season, (1.0, 1.0))


def grey_palette(tiles: int, rng: np.random.Generator) -> Palette:
    """Return a grey palette for a photo that shows no leaves: clusters that differ only in lightness."""
    lights = GREY[0] + np.linspace(-6.0, 6.0, tiles)
    members = tuple(np.array([light, 0.0, 0.0]) + rng.normal(0, GREY_SPREAD, (GREY_MEMBERS, 3)) for light in lights)
    return Palette(np.stack([m.mean(axis=0) for m in members]), np.full(tiles, 1.0 / tiles), members)


def recolour_for(season: str, species: Species, palette: Palette, kind: FoliageKind) -> Recolour | None:
    """Return the recolouring of a photo's leaves for a season, or None where their colours stay the photo's.

    Foliage that is green in the photo keeps its colour in summer, and green needles in summer and autumn. A tree of
    unknown kind that shows autumn colours in the photo keeps them in autumn.
    """
    if season not in LEAFY:
        return None
    mean = (palette.centres * palette.shares[:, None]).sum(axis=0)
    green, warm = mean[1] < GREEN_A and mean[2] > GREEN_B, mean[1] > WARM_A and mean[2] > 2 * WARM_A
    if is_evergreen(species, kind):
        if green:
            return Recolour(mean, mean + np.array(SPRING_TIPS), np.ones(3)) if season == "spring" else None
    elif (season == "summer" and green) or (season == "autumn" and warm and species == AUTO):
        return None
    ramp = _season_ramp(season, species, kind)
    ramp[:, 0] += np.clip(BRIGHTNESS_KEPT * (mean[0] - ramp[:, 0].mean()), -MOST_BRIGHTNESS_KEPT, MOST_BRIGHTNESS_KEPT)
    return Recolour(mean, ramp, np.array([LIGHT_KEPT, HUE_KEPT, HUE_KEPT]))


def recolour_grey(season: str, species: Species, kind: FoliageKind) -> Recolour:
    """Return the recolouring of `grey_palette` for a season."""
    return Recolour(np.array(GREY), _season_ramp(season, species, kind), np.ones(3))


def _season_ramp(season: str, species: Species, kind: FoliageKind) -> Floats:
    """Colours (k, 3), CIE Lab, between which leaves lie in a season."""
    if is_evergreen(species, kind):
        return np.asarray(np.array(CONIFER) + np.array(SPRING_TIPS if season == "spring" else ((0.0, 0.0, 0.0),)))
    return np.array({"spring": species.spring, "autumn": species.autumn}.get(season, species.summer))
