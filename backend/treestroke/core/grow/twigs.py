"""Twigs: the finest shoots, which a bare tree shows and growth by attractors is too coarse for.

They grow at the joints of thin branches, each turned by the golden angle from the one before (phyllotaxis), lean
forward and rise a little.
"""

import numpy as np

from treestroke.core.geometry.vectors import unit
from treestroke.core.grow.form import UP_IN_PICTURE, Form
from treestroke.core.grow.growth_space import GrowthSpace
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root
from treestroke.core.types import Floats, Indices

GOLDEN_RAD = np.pi * (3 - np.sqrt(5.0))
LEAN = (0.55, 1.0)
"""Range of the tangent of a twig's angle from its branch."""
RISE = 0.3
"""Weight of the upward direction in a twig's outer half, relative to 1 for its own."""
LENGTH_PX = (16.0, 42.0)
"""Range of a twig's length, px of a crown 1,000 px wide."""
FINE_PX = 500.0
"""Greatest total length of wood beyond a joint with a twig, px of a crown 1,000 px wide."""


def with_twigs(form: Form, space: GrowthSpace, most: int, rng: np.random.Generator) -> Form:
    """Add up to ``most`` twigs to a tree (px), all within the crown; they count as grown with their parent joint."""
    seats = _seats(form, space.unit, most)
    if len(seats) == 0:
        return form
    along = unit(form.points[seats] - form.points[form.parents[seats]])
    turn = GOLDEN_RAD * np.arange(len(seats)) + rng.uniform(-0.5, 0.5, len(seats))
    direction = unit(along + rng.uniform(*LEAN, len(seats))[:, None] * _across(along, turn))
    length = space.unit * rng.uniform(*LENGTH_PX, len(seats))[:, None]
    middle = form.points[seats] + 0.5 * length * direction
    rising = unit(direction + RISE * UP_IN_PICTURE + rng.normal(0, 0.15, direction.shape))
    end = middle + 0.5 * length * rising
    kept = space.inside(middle) & space.inside(end)
    return _appended(form, seats[kept], middle[kept], end[kept])


def _seats(form: Form, unit: float, most: int) -> Indices:
    """Return the indices of the joints that get a twig, evenly along thin branches; some of them get two."""
    tree = Skeleton(form.points, np.zeros(len(form.points)), form.parents)
    lengths = edge_lengths(tree)
    wood = accumulate_to_root(tree, lengths)
    thin = np.flatnonzero((wood <= FINE_PX * unit) & (form.born > 0) & (form.measured == 0) & (form.parents >= 0))
    along, count = np.cumsum(lengths[thin]), min(len(thin), most)
    return thin[np.searchsorted(along, (np.arange(count) + 0.5) * along[-1:] / max(count, 1))]


def _across(along: Floats, turn: Floats) -> Floats:
    """Return unit vectors (n, 3) perpendicular to directions (n, 3), turned about them by angles (n,), radians."""
    level = np.where(np.abs(along[:, 2:]) > 0.9, [[1.0, 0.0, 0.0]], [[0.0, 0.0, 1.0]])
    side = unit(np.cross(along, level))
    return np.asarray(np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * np.cross(along, side))


def _appended(form: Form, seats: Indices, middle: Floats, end: Floats) -> Form:
    """Append twigs of two joints each at their seats, joint indices (m,)."""
    first, count = len(form.points), len(seats)
    parents = np.stack([seats, first + 2 * np.arange(count)], axis=1).ravel()
    return Form(
        np.vstack([form.points, np.stack([middle, end], axis=1).reshape(-1, 3)]),
        np.concatenate([form.parents, parents]),
        np.concatenate([form.born, np.repeat(form.born[seats], 2)]),
        np.concatenate([form.measured, np.zeros(2 * count)]),
    )
