"""Where the trees of a grove stand: beside each other, so that crowns touch at most."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.types import Floats, Indices

GOLDEN_RAD = np.pi * (3 - np.sqrt(5.0))
"""Golden angle: places along it lie evenly on a disc and in no rows (Vogel 1979)."""
FINE = 0.2
"""Distance of the places that are tried, over the least radius of a crown."""
WITHIN = 99.0
"""Per cent of a tree's points that lie in its crown's radius: single twigs may touch a neighbour's."""


@dataclass(frozen=True, eq=False)
class Grove:
    """A grove of n trees.

    Attributes
    ----------
    tree
        (n,) which tree stands at each place.
    places
        (n, 2) X and Z of each place, metres; the first is the origin.
    turns_rad
        (n,) how far each is turned about the vertical.
    """

    tree: Indices
    places: Floats
    turns_rad: Floats


def plant(radii: Floats, count: int, rng: np.random.Generator) -> Grove:
    """Set ``count`` trees with crowns of some radii (k,), metres, around the first, as close as their crowns allow.

    Each of the k trees stands once before one of them, turned, stands again.

    Raises
    ------
    ValueError
        There is no tree, or a radius is not positive.
    """
    if len(radii) == 0 or not (radii > 0).all():
        raise ValueError(f"a grove needs trees with crowns, got radii {radii}")
    tree = np.arange(count) % len(radii)
    reach = radii[tree]
    number = np.arange(max(64, int(8 * (np.square(reach).sum() / (FINE * radii.min()) ** 2))))
    away, turn = FINE * float(radii.min()) * np.sqrt(number), GOLDEN_RAD * number + rng.uniform(0, 2 * np.pi)
    tried = np.stack([away * np.cos(turn), away * np.sin(turn)], axis=1)
    places = np.zeros((count, 2))
    room = np.hypot(*(tried - places[0]).T) - reach[0] if count else away
    for index in range(1, count):
        places[index] = tried[int(np.argmax(room >= reach[index]))]
        room = np.minimum(room, np.hypot(*(tried - places[index]).T) - reach[index])
    turns = np.where(np.arange(count) < len(radii), 0.0, rng.uniform(0, 2 * np.pi, count))
    return Grove(tree, places, turns)


def crown_radius(points: Floats) -> float:
    """Return the distance from a tree's axis within which nearly all of its points (n, 3), metres, lie."""
    return float(np.percentile(np.hypot(points[:, 0], points[:, 2]), WITHIN))
