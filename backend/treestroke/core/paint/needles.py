"""Sprays of needles: those of a pine, of a fir or spruce, of a larch."""

import numpy as np

from treestroke.core.paint.canvas import DARK, LIGHT, PLAIN, Canvas, fits_canvas
from treestroke.core.paint.shoots import along, angle_of, draw_shoots, heading
from treestroke.core.paint.species import NeedleArrangement
from treestroke.core.types import Floats, Picture

SHOOTS = 13
"""Side shoots of a spray with short needles."""
NEEDLES_PER_SIDE = 300.0
"""Short needles on a shoot as long as the spray's side."""
BRUSHES, BUNDLES = 5, 56
"""Brushes of a pine's spray, and pairs of needles in each."""
LARCH_TUFTS, TUFT_NEEDLES = 6, 18
"""Tufts of a larch's shoot, and needles of a tuft."""


def draw_species_needles(
    arrangement: NeedleArrangement, side: int, colours: Floats, rng: np.random.Generator
) -> Picture:
    """Draw long needles in brushes at the shoots' ends, a flat spray of short ones, or tufts along thin twigs.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha, in colours drawn from (m, 3), CIE Lab.
    """
    match arrangement:
        case "long":
            shoots = _pine_shoots(rng)
            needles, width = _pine_needles(shoots, rng), 0.007
        case "short":
            shoots = _flat_shoots(rng)
            needles, width = _short_needles(shoots, rng), 0.0075
        case "tufts":
            shoots = draw_shoots(rng, 9, 0.9, 0.39)
            needles, width = _larch_needles(shoots, rng), 0.006
    canvas = Canvas(side, colours, len(needles), rng)
    canvas.lines(shoots, canvas.wood, 0.008)
    _draw_by_lightness(canvas, needles[fits_canvas(needles)], width, rng)
    return canvas.tile()


def _draw_by_lightness(canvas: Canvas, needles: Floats, width: float, rng: np.random.Generator) -> None:
    """Draw needles (p, 3, 2) in 36 random groups of one colour each: dark groups first, light ones on top."""
    order = rng.permutation(len(needles))
    groups = np.array_split(order, 36)
    for number, group in enumerate(groups):
        paint = canvas.paints[group[0] if len(group) else 0]
        canvas.lines(needles[group], paint[(DARK, PLAIN, LIGHT)[number // 12]], width)


def _bowed(foot: Floats, angle: Floats, length: Floats, bow: Floats) -> Floats:
    """Draw needles (p, 3, 2) from their feet (p, 2), turned by ``bow`` (p,), rad, at half their length."""
    middle = foot + 0.5 * length[:, None] * heading(angle)
    return np.stack([foot, middle, middle + 0.5 * length[:, None] * heading(angle + bow)], axis=1)


def _pine_shoots(rng: np.random.Generator) -> Floats:
    """Draw a short twig and the shoots about its end that bear a brush each: (m, 9, 2)."""
    t = np.linspace(0, 1, 9)
    twig = np.stack([0.5 + rng.uniform(-0.06, 0.06) * t, 0.96 - 0.56 * t], axis=1)
    angle = np.linspace(-1.5, 1.5, BRUSHES - 1) + rng.uniform(-0.25, 0.25, BRUSHES - 1)
    share, length = rng.uniform(0.3, 0.7, BRUSHES - 1), rng.uniform(0.14, 0.22, BRUSHES - 1)
    side = along(twig, share)[:, None] + (length[:, None] * t)[..., None] * heading(angle)[:, None]
    return np.concatenate([twig[None], side])


def _pine_needles(shoots: Floats, rng: np.random.Generator) -> Floats:
    """Place long needles (p, 3, 2), in pairs, around the end of each shoot (m, 9, 2): a round, frayed brush."""
    shoot = np.repeat(np.arange(len(shoots)), BUNDLES)
    share = 1.0 - 0.45 * rng.random(len(shoot)) ** 2
    foot = along(shoots[shoot], share)
    ahead = angle_of(foot - along(shoots[shoot], share - 0.1))
    spread = rng.uniform(-1.0, 1.0, len(shoot))
    angle = np.repeat(ahead + 2.3 * spread, 2) + np.tile([-0.05, 0.05], len(shoot))
    length = np.repeat(rng.uniform(0.16, 0.31, len(shoot)) * (1.0 - 0.25 * np.abs(spread)), 2)
    return _bowed(np.repeat(foot, 2, axis=0), angle, length, rng.normal(0, 0.12, 2 * len(shoot)))


def _larch_needles(shoots: Floats, rng: np.random.Generator) -> Floats:
    """Place soft needles (p, 3, 2) in tufts along the shoots (m, 9, 2)."""
    each = LARCH_TUFTS * TUFT_NEEDLES
    shoot = np.repeat(np.arange(len(shoots)), each)
    place = (np.arange(LARCH_TUFTS) + 1.0) / LARCH_TUFTS
    share = np.tile(np.repeat(place, TUFT_NEEDLES), len(shoots)) - 0.02
    foot = along(shoots[shoot], share)
    ahead = angle_of(foot - along(shoots[shoot], share - 0.1))
    spread = rng.uniform(-1.9, 1.9, len(shoot))
    length = rng.uniform(0.065, 0.105, len(shoot))
    return _bowed(foot, ahead + spread, length, rng.normal(0, 0.2, len(shoot)))


def _flat_shoots(rng: np.random.Generator) -> Floats:
    """Draw a bowed twig and shoots to both sides, the longest at a third of it: (m, 9, 2)."""
    t, bow = np.linspace(0, 1, 9), rng.uniform(-0.07, 0.07)
    twig = np.stack([0.5 + bow * np.sin(np.pi * t), 0.97 - 0.9 * t], axis=1)
    share = np.linspace(0.04, 0.9, SHOOTS) + rng.uniform(-0.015, 0.015, SHOOTS)
    turn = np.where((np.arange(SHOOTS) + rng.integers(2)) % 2, 1.0, -1.0)
    angle = turn * rng.uniform(0.75, 1.05, SHOOTS) * (1.1 - 0.35 * share)
    outline = np.interp(share, [0.0, 0.25, 1.0], [0.42, 0.56, 0.2])
    length = outline * rng.uniform(0.6, 1.05, SHOOTS)
    bent = angle[:, None] - turn[:, None] * rng.uniform(0.1, 0.4, (SHOOTS, 1)) * t
    foot = along(twig, share)
    return np.concatenate([twig[None], foot[:, None] + (length[:, None] * t)[..., None] * heading(bent)])


def _short_needles(shoots: Floats, rng: np.random.Generator) -> Floats:
    """Place short needles (p, 3, 2) to both sides of each shoot (m, 9, 2), pointing forward, in proportion to length.

    They become shorter toward the shoot's tip, which ends in a point.
    """
    lengths = np.sqrt((np.diff(shoots, axis=1) ** 2).sum(axis=2)).sum(axis=1)
    count = np.maximum(np.rint(NEEDLES_PER_SIDE * lengths), 4).astype(np.int64)
    shoot = np.repeat(np.arange(len(shoots)), count)
    share = rng.random(len(shoot))
    foot = along(shoots[shoot], share)
    ahead = angle_of(along(shoots[shoot], share + 0.06) - along(shoots[shoot], share - 0.06))
    spread = rng.choice([-1.0, 1.0], len(shoot)) * rng.uniform(0.25, 0.85, len(shoot))
    length = rng.uniform(0.032, 0.05, len(shoot)) * (1.1 - 0.5 * share)
    return _bowed(foot, ahead + spread, length, -0.4 * spread)
