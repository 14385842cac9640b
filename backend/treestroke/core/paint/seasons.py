"""The seasons: colour, size and number of leaves."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.paint.palette import Palette
from treestroke.core.paint.species import AUTO, CONIFER, Ramp, Species
from treestroke.core.types import Floats

SEASONS = ("spring", "summer", "autumn", "bare")
LEAFY = ("spring", "summer", "autumn")
"""Seasons in which a tree has leaves, whatever the photo shows."""
FACTORS = {"spring": (0.8, 0.6), "autumn": (1.0, 0.85)}
"""Size and number of leaves, against summer's."""
BLOSSOM = (1.0, 0.85)
"""The same of flowers."""
LIGHT_KEPT, HUE_KEPT = 0.55, 0.25
"""Share of the photo's own differences in lightness and in hue about their mean that a season keeps."""
DEVIATION = 22.0
"""Most of them that are kept, Lab units: what differs more is sky or wood."""
MOOD_KEPT = 0.4
"""Share of the mean lightness of a dark or bright photo that stays over a season's own."""
MOODIEST = 10.0
DIMNESS = (0.55, 1.2)
"""Least and greatest strength of a colour, against its own, in the shade and in the light."""
OWN_SPREAD = np.array([7.0, 2.5, 3.0])
"""Deviation of leaves' colours, Lab units, where the photo shows none."""
OWN_MEMBERS = 240
GREY = (50.0, 0.0, 0.0)
GREENEST, YELLOWEST = -6.0, 8.0
"""Lab a below and b above which a photo's foliage is green by itself."""
WARMEST = 6.0
"""Lab a above which, and twice that for b, it shows autumn."""
TIPS: Ramp = ((0.0, 0.0, 0.0), (1.0, 0.0, 1.0), (8.0, -2.0, 9.0))
"""What spring adds to needles: the youngest are light."""


@dataclass(frozen=True, eq=False)
class Recolour:
    """The way from a photo's colours to others, CIE Lab: where leaves differ in the photo they differ here.

    Attributes
    ----------
    mean
        (3,) what the photo's foliage has on average.
    ramp
        (k, 3) colours between which leaves lie, from mood 0 to mood 1.
    kept
        (3,) share of the differences from the mean that stays.
    """

    mean: Floats
    ramp: Floats
    kept: Floats

    def at(self, labs: Floats, position: Floats) -> Floats:
        """Colours (n, 3) for colours of the photo (n, 3) at moods (n,), 0 to 1."""
        place = np.clip(position, 0, 1) * (len(self.ramp) - 1)
        first = np.minimum(place, max(len(self.ramp) - 2, 0)).astype(np.int64)
        second = np.minimum(first + 1, len(self.ramp) - 1)
        own = self.ramp[first] + (place - first)[:, None] * (self.ramp[second] - self.ramp[first])
        kept = self.kept * np.clip(labs - self.mean, -DEVIATION, DEVIATION)
        lightness = np.clip(own[:, 0] + kept[:, 0], 6.0, 96.0)
        strength = np.clip(lightness / own[:, 0], *DIMNESS)[:, None]
        return np.concatenate([lightness[:, None], strength * (own[:, 1:] + kept[:, 1:])], axis=1)

    def palette(self, palette: Palette, tiles: int, rng: np.random.Generator) -> Palette:
        """Give a palette of this many clusters: the photo's, each at a mood of its own, its leaves about that."""
        golden, count = 0.618, len(palette.members)
        members = []
        for tile in range(tiles):
            labs = palette.members[tile % count]
            members.append(self.at(labs, (0.5 + golden * tile) % 1.0 + rng.normal(0, 0.12, len(labs))))
        shares = np.resize(palette.shares, tiles)
        return Palette(np.stack([m.mean(axis=0) for m in members]), shares / shares.sum(), tuple(members))


def is_evergreen(species: Species, needles: bool) -> bool:
    """Tell whether a tree keeps its leaves; needles of an unknown kind are kept."""
    return species.evergreen or (needles and species.needles is None)


def size_and_density(season: str, species: Species, needles: bool) -> tuple[float, float]:
    """Factors on the size and on the number of leaves in a season."""
    if is_evergreen(species, needles):
        return 1.0, 1.0
    if season == "spring" and species.flowers:
        return BLOSSOM
    return FACTORS.get(season, (1.0, 1.0))


def own_palette(tiles: int, rng: np.random.Generator) -> Palette:
    """Give a grey palette, for a photo that shows no leaves: clusters that differ in lightness alone."""
    lights = GREY[0] + np.linspace(-6.0, 6.0, tiles)
    members = tuple(np.array([light, 0.0, 0.0]) + rng.normal(0, OWN_SPREAD, (OWN_MEMBERS, 3)) for light in lights)
    return Palette(np.stack([m.mean(axis=0) for m in members]), np.full(tiles, 1.0 / tiles), members)


def recolour_for(season: str, species: Species, palette: Palette, needles: bool) -> Recolour | None:
    """Tell how a season recolours the leaves of a photo; None where their colours stay the photo's.

    Leaves that are green by themselves stay so in summer, needles all year; a tree of unknown kind that the photo
    shows in autumn's colours keeps those in autumn.
    """
    if season not in LEAFY:
        return None
    mean = (palette.centres * palette.shares[:, None]).sum(axis=0)
    green, warm = mean[1] < GREENEST and mean[2] > YELLOWEST, mean[1] > WARMEST and mean[2] > 2 * WARMEST
    if is_evergreen(species, needles):
        if green:
            return Recolour(mean, mean + np.array(TIPS), np.ones(3)) if season == "spring" else None
    elif (season == "summer" and green) or (season == "autumn" and warm and species == AUTO):
        return None
    ramp = np.array(_ramp(season, species, needles))
    ramp[:, 0] += np.clip(MOOD_KEPT * (mean[0] - ramp[:, 0].mean()), -MOODIEST, MOODIEST)
    return Recolour(mean, ramp, np.array([LIGHT_KEPT, HUE_KEPT, HUE_KEPT]))


def recolour_bare(season: str, species: Species, needles: bool) -> Recolour:
    """Tell how `own_palette` becomes a season's colours."""
    return Recolour(np.array(GREY), np.array(_ramp(season, species, needles)), np.ones(3))


def _ramp(season: str, species: Species, needles: bool) -> Ramp:
    """Colours of a season."""
    if is_evergreen(species, needles):
        return (
            tuple(
                (base[0] + tip[0], base[1] + tip[1], base[2] + tip[2]) for base, tip in zip(CONIFER, TIPS, strict=True)
            )
            if season == "spring"
            else CONIFER
        )
    return {"spring": species.spring, "autumn": species.autumn}.get(season, species.summer)
