"""Sprays of needles: those of a pine, spruce or larch, or a flat spray where the species is unknown."""

import numpy as np

from treestroke.core.paint.canvas import DARK, LIGHT, PLAIN, Canvas, fits_canvas
from treestroke.core.paint.shoots import along, angle_of, draw_shoots, heading
from treestroke.core.paint.species import NeedleArrangement
from treestroke.core.types import Floats, Picture

FEATHER_SHOOTS = 18
"""Side shoots of a spray where the species is unknown."""
NEEDLES_PER_SIDE = 300.0
"""Needles on a shoot as long as the spray's side."""
PINE_NEEDLES, SPRUCE_NEEDLES = 42, 90
"""Needles of a shoot."""
LARCH_TUFTS, TUFT_NEEDLES = 6, 18
"""Tufts of a larch's shoot, and needles of a tuft."""


def draw_species_needles(
    arrangement: NeedleArrangement, side: int, colours: Floats, rng: np.random.Generator
) -> Picture:
    """Draw long needles in brushes at the shoots' ends, short ones all around the shoots, or tufts along thin twigs.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha, in colours drawn from (m, 3), CIE Lab.
    """
    match arrangement:
        case "long":
            shoots = draw_shoots(rng, 9, 0.75, 0.26)
            needles, width = _pine_needles(shoots, rng), 0.0105
        case "short":
            shoots = _spruce_shoots(rng)
            needles, width = _spruce_needles(shoots, rng), 0.0105
        case "tufts":
            shoots = draw_shoots(rng, 9, 0.9, 0.39)
            needles, width = _larch_needles(shoots, rng), 0.006
    canvas = Canvas(side, colours, len(needles), rng)
    canvas.lines(shoots, canvas.wood, 0.008 if arrangement == "tufts" else 0.014)
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


def _pine_needles(shoots: Floats, rng: np.random.Generator) -> Floats:
    """Place long needles (p, 3, 2) on the outer part of each shoot (m, 9, 2), standing off on all sides."""
    shoot = np.repeat(np.arange(len(shoots)), PINE_NEEDLES)
    share = 1.0 - 0.3 * rng.random(len(shoot))
    foot = along(shoots[shoot], share)
    ahead = angle_of(foot - along(shoots[shoot], share - 0.1))
    spread = rng.uniform(-1.25, 1.25, len(shoot)) * (1.4 - 0.6 * share)
    length = rng.uniform(0.17, 0.26, len(shoot)) * (1.0 - 0.2 * np.abs(spread))
    return _bowed(foot, ahead + spread, length, -0.25 * spread + rng.normal(0, 0.08, len(shoot)))


def _spruce_shoots(rng: np.random.Generator) -> Floats:
    """Draw a straight twig and shoots to both sides, nearly in pairs and shorter toward its tip: (m, 9, 2)."""
    t, count = np.linspace(0, 1, 9), 11
    twig = np.stack([0.5 + rng.uniform(-0.05, 0.05) * t, 0.97 - 0.86 * t], axis=1)
    share = np.linspace(0.06, 0.86, count) + rng.uniform(-0.02, 0.02, count)
    turn = np.where(np.arange(count) % 2, 1.0, -1.0)
    angle = turn * rng.uniform(0.75, 1.05, count)
    length = 0.62 * (1.05 - share) ** 0.55 * rng.uniform(0.75, 1.05, count)
    bent = angle[:, None] - turn[:, None] * rng.uniform(0.1, 0.35, (count, 1)) * t
    return np.concatenate([twig[None], along(twig, share)[:, None] + (length[:, None] * t)[..., None] * heading(bent)])


def _spruce_needles(shoots: Floats, rng: np.random.Generator) -> Floats:
    """Place short, stiff needles (p, 3, 2) along every shoot (m, 9, 2), pointing forward."""
    shoot = np.repeat(np.arange(len(shoots)), SPRUCE_NEEDLES)
    share = rng.random(len(shoot))
    foot = along(shoots[shoot], share)
    ahead = angle_of(along(shoots[shoot], share + 0.06) - along(shoots[shoot], share - 0.06))
    spread = rng.choice([-1.0, 1.0], len(shoot)) * rng.uniform(0.15, 1.0, len(shoot))
    length = rng.uniform(0.05, 0.075, len(shoot))
    return _bowed(foot, ahead + spread, length, -0.3 * spread)


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


def draw_flat_spray(side: int, colours: Floats, rng: np.random.Generator) -> Picture:
    """Draw a flat spray as firs and spruces have it: a feather of shoots with short needles, narrow toward its tip.

    Its outline is frayed, pointed and three times as long as broad, so that it does not read as a lobed leaf where it
    is a few pixels wide.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha, in colours drawn from (m, 3), CIE Lab.
    """
    shoots = _feather_shoots(rng)
    needles = _feather_needles(shoots, rng)
    canvas = Canvas(side, colours, len(needles), rng)
    canvas.lines(shoots[:1], canvas.wood, 0.012)
    canvas.lines(shoots[1:], canvas.wood, 0.007)
    _draw_by_lightness(canvas, needles[fits_canvas(needles)], 0.0075, rng)
    return canvas.tile()


def _feather_shoots(rng: np.random.Generator) -> Floats:
    """Draw a bowed twig and shoots to both sides, the longest at a third of it: (m, 9, 2)."""
    t, bow = np.linspace(0, 1, 9), rng.uniform(-0.07, 0.07)
    twig = np.stack([0.5 + bow * np.sin(np.pi * t), 0.97 - 0.9 * t], axis=1)
    share = np.linspace(0.04, 0.9, FEATHER_SHOOTS) + rng.uniform(-0.015, 0.015, FEATHER_SHOOTS)
    turn = np.where((np.arange(FEATHER_SHOOTS) + rng.integers(2)) % 2, 1.0, -1.0)
    angle = turn * rng.uniform(0.5, 0.8, FEATHER_SHOOTS) * (1.1 - 0.35 * share)
    outline = np.interp(share, [0.0, 0.25, 1.0], [0.2, 0.36, 0.1])
    length = outline * rng.uniform(0.6, 1.05, FEATHER_SHOOTS)
    bent = angle[:, None] - turn[:, None] * rng.uniform(0.1, 0.4, (FEATHER_SHOOTS, 1)) * t
    foot = along(twig, share)
    return np.concatenate([twig[None], foot[:, None] + (length[:, None] * t)[..., None] * heading(bent)])


def _feather_needles(shoots: Floats, rng: np.random.Generator) -> Floats:
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
