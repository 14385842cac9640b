"""Fruit: a picture of it on two crossed upright cards, hung below the twigs.

Source: the paper on two sketches (docs/papers.md), section 7: fruit are textured quads that follow the phyllotaxis of
their twig, with random factors in place and direction. Ours keep a distance from each other and hang mostly where the
crown shows them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette, shown_by_all
from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.leaf.arrangement import Seats, seats_along, thin_edges
from treestroke.core.leaf.leaves import Leaves, join_leaves
from treestroke.core.paint.atlas import TILE_SIDE, Atlas, tile_labs
from treestroke.core.paint.canvas import MARGIN
from treestroke.core.paint.cut_outs import mean_solid_colour, resized_premultiplied
from treestroke.core.paint.palette import nearest_colour
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Picture

GOLDEN_RAD = np.pi * (3 - np.sqrt(5.0))
"""Golden angle, rad: the turn about the twig from one fruit to the next."""
TRIED = 12
"""Places tried for each fruit."""
STALK = 0.7
"""Length of a fruit's stalk, in widths of the fruit; half around the twig, half out of the crown."""
TURN_SCATTER = 0.4
"""Standard deviation of the turn about the twig, rad."""
TALLEST = 2.0
"""Greatest factor on the width for tall pictures, which show clusters, or fruit with a stalk."""
SHADES = (0.9, 1.0)
"""Least and greatest brightness, 0 to 1: fruit is seen at the outside of the crown."""
OUTWARD = 8.0
"""Power of the reach from the crown's axis by which a place is likelier at the outside."""


@dataclass(frozen=True)
class FruitParams:
    """How much fruit a tree bears, and how large.

    Attributes
    ----------
    aspect
        Height over width of the fruit's picture.
    width
        Width of the narrowest and the widest fruit, shares of the crown's width, for a picture no taller than wide.
    per_metre
        Number of fruit for each metre of the side of a square as large as the crown's outline.
    fewest, most
        Number of fruit on the smallest and on the largest tree, where there is room.
    apart
        Least distance between two fruit, in widths.
    """

    aspect: float = 1.0
    width: tuple[float, float] = (0.012, 0.018)
    per_metre: float = 30.0
    fewest: int = 60
    most: int = 200
    apart: float = 1.6

    def __post_init__(self) -> None:
        if not 0 < self.width[0] <= self.width[1] <= 0.2:
            raise ValueError(f"width must be two shares, 0 to 0.2, the smaller first, got {self.width}")
        if not (0 <= self.fewest <= self.most and self.per_metre >= 0 and self.apart >= 0 and self.aspect > 0):
            raise ValueError(f"counts must be in order, and nothing negative, got {self}")


def hang_fruit(
    skeleton: Skeleton,
    volume: CrownVolume,
    silhouettes: Sequence[Silhouette[Camera]],
    params: FruitParams,
    rng: np.random.Generator,
) -> Leaves:
    """Hang fruit on the twigs of a grown tree, metres: first one card of each fruit, then the card that crosses it.

    Every fruit's middle and lower end lie inside all silhouettes and its middle inside the volume. They come in random
    order, so that the first few stand all over the crown. Their tile is set by `with_fruit`.
    """
    count = int(np.clip(round(params.per_metre * float(np.sqrt(volume.front_area))), params.fewest, params.most))
    seats = seats_along(skeleton, thin_edges(skeleton).astype(np.float64), TRIED * count, rng)
    width = 2 * volume.widest * rng.uniform(*params.width, len(seats)) * float(np.clip(params.aspect, 1, TALLEST))
    drop = width * params.aspect
    around = unit(_around(seats, rng) + _outward(seats.points, volume), UP)
    feet = seats.points + STALK * width[:, None] * around
    half = 0.5 * np.maximum(width, drop) / (1 - 2 * MARGIN)
    middles = feet - drop[:, None] / 2 * UP
    reach = volume.reach(middles)
    ends = feet - drop[:, None] * UP
    inside = shown_by_all(silhouettes, middles) & shown_by_all(silhouettes, ends) & (reach <= 1)
    likelihood = np.where(inside, np.clip(reach, 0.05, 1) ** OUTWARD, 0.0)
    chosen = _chosen(middles, likelihood, params.apart * width, count, rng)
    return _crossed(feet[chosen], half[chosen], seats.joints[chosen], rng)


def with_fruit(leaves: Leaves, atlas: Atlas | None, fruit: Leaves, picture: Picture) -> tuple[Leaves, Atlas]:
    """Add fruit to the leaves and its picture (h, w, 4) to their atlas, in place of the tile that fewest leaves show.

    The leaves that showed this tile show the one of the most similar colour (CIE Lab) instead. Without an atlas the
    fruit's tile is the only one.
    """
    tile, colour = _tile(picture), mean_solid_colour(picture)
    if atlas is None:
        alone = Atlas(tile, np.array([[0.0, 0.0, 1.0, 1.0]]), colour[None], fruit=0)
        return replace(fruit, tiles=np.zeros(len(fruit), dtype=np.int64)), alone
    place = int(np.bincount(leaves.tiles, minlength=len(atlas.boxes)).argmin())
    others, labs = np.delete(np.arange(len(atlas.boxes)), place), tile_labs(atlas)
    alike = int(others[nearest_colour(labs[[place]], labs[others])[0][0]])
    leaves = replace(leaves, tiles=np.where(leaves.tiles == place, alike, leaves.tiles))
    image, colours = atlas.image.copy(), atlas.colours.copy()
    left, top = np.rint(atlas.boxes[place, :2] * image.shape[1::-1]).astype(int).tolist()
    image[top : top + TILE_SIDE, left : left + TILE_SIDE], colours[place] = tile, colour
    hung = replace(fruit, tiles=np.full(len(fruit), place, dtype=np.int64))
    return join_leaves([leaves, hung]), replace(atlas, image=image, colours=colours, fruit=place)


def _around(seats: Seats, rng: np.random.Generator) -> Floats:
    """Return unit vectors (n, 3) perpendicular to the twigs, each turned by the golden angle from the one before."""
    turn = GOLDEN_RAD * np.arange(len(seats)) + rng.normal(0, TURN_SCATTER, len(seats))
    side = unit(np.cross(seats.directions, UP), np.array([1.0, 0.0, 0.0]))
    across = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * np.cross(seats.directions, side)
    return np.asarray(across)


def _outward(points: Floats, volume: CrownVolume) -> Floats:
    """Return level unit vectors (n, 3) away from the middles of the crown's sections."""
    return unit((points - volume.axis(points[:, 1])) * np.array([1.0, 0.0, 1.0]), UP)


def _chosen(points: Floats, likelihood: Floats, apart: Floats, count: int, rng: np.random.Generator) -> Indices:
    """Draw up to ``count`` points (n, 3), metres, by their likelihood, no two nearer than ``apart`` (n,)."""
    arrival = rng.exponential(size=len(points)) / np.maximum(likelihood, 1e-12)
    found: list[int] = []
    free = likelihood > 0
    for index in np.argsort(arrival, kind="stable").tolist():
        if len(found) == count:
            break
        if free[index]:
            found.append(index)
            free &= ((points - points[index]) ** 2).sum(axis=1) >= apart**2
    return np.array(found, dtype=np.int64)


def _crossed(feet: Floats, half: Floats, joints: Indices, rng: np.random.Generator) -> Leaves:
    """Build two crossed upright square cards of half a side (n,), metres, for fruit whose stalks end at feet (n, 3)."""
    count = len(feet)
    azimuth = rng.uniform(0, 2 * np.pi, count) + np.array([[0.0], [np.pi / 2]])
    level = np.stack([np.cos(azimuth), np.zeros_like(azimuth), np.sin(azimuth)], axis=-1)
    centres = feet - ((1 - 2 * MARGIN) * half)[:, None] * UP
    return Leaves(
        np.tile(centres, (2, 1)),
        (half[:, None] * level).reshape(-1, 3),
        np.tile(half[:, None] * UP, (2, 1)),
        np.zeros(2 * count, dtype=np.int64),
        np.repeat([False, True], count),
        np.tile(rng.uniform(*SHADES, count), 2),
        np.tile(joints, 2),
    )


def _tile(picture: Picture) -> Picture:
    """Place a picture (h, w, 4), straight alpha, on a transparent tile, its top in the middle of the upper margin.

    The transparent part has the fruit's mean colour, so that edges and mip levels show no halo.
    """
    room = round(TILE_SIDE * (1 - 2 * MARGIN))
    height, width = picture.shape[:2]
    size = max(1, round(width * room / max(height, width))), max(1, round(height * room / max(height, width)))
    small = resized_premultiplied(picture, *size)
    mean = mean_solid_colour(picture)
    colour = np.where(small[..., 3:] > 1 / 255, small[..., :3] / np.maximum(small[..., 3:], 1e-3), mean)
    tile = np.empty((TILE_SIDE, TILE_SIDE, 4), dtype=np.uint8)
    tile[:] = (*np.rint(mean).astype(int).tolist(), 0)
    top, left = (TILE_SIDE - room) // 2, (TILE_SIDE - size[0]) // 2
    laid = np.concatenate([colour, 255 * small[..., 3:]], axis=2)
    tile[top : top + size[1], left : left + size[0]] = np.clip(np.rint(laid), 0, 255)
    return tile
