"""Sprays of needles: those of a pine, spruce or larch, or brushes where the species is unknown."""

import numpy as np

from treestroke.core.paint.canvas import DARK, LIGHT, PLAIN, Canvas, fits_canvas
from treestroke.core.paint.shoots import along, angle_of, draw_shoots, heading
from treestroke.core.paint.species import NeedleArrangement
from treestroke.core.types import Floats, Picture

BRUSH_NEEDLES = 120
"""Needles of a shoot where the species is unknown."""
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


def draw_needle_brushes(side: int, colours: Floats, rng: np.random.Generator) -> Picture:
    """Draw a twig and a few shoots as brushes of long, thin needles that point forward, frayed at the outline.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha, in colours drawn from (m, 3), CIE Lab.
    """
    shoots = draw_shoots(rng, int(rng.integers(3, 6)), 0.8)
    canvas = Canvas(side, colours, BRUSH_NEEDLES * len(shoots), rng)
    needles = _brush_needles(shoots, rng.uniform(0.19, 0.24), rng)
    canvas.lines(shoots, canvas.wood, 0.012)
    paints = canvas.paints.reshape(len(shoots), BRUSH_NEEDLES, *canvas.paints.shape[1:])
    for brush, paint in zip(needles, paints, strict=True):
        fitting = brush[fits_canvas(brush)]
        for start in range(12):
            canvas.lines(fitting[start::12], paint[start, (DARK, PLAIN, LIGHT)[start // 4]], 0.013)
    return canvas.tile()


def _brush_needles(shoots: Floats, length: float, rng: np.random.Generator) -> Floats:
    """Place needles (m, BRUSH_NEEDLES, 2, 2) on shoots (m, 9, 2), pointing forward, shorter toward a shoot's tip.

    Each shoot becomes a narrow brush: where a card is a few pixels wide, single needles vanish but brushes do not.
    """
    share = np.sort(rng.uniform(0.06, 1.0, (len(shoots), BRUSH_NEEDLES)), axis=1)
    lines = np.repeat(shoots[:, None], BRUSH_NEEDLES, axis=1)
    foot = along(lines, share)
    ahead = foot - along(lines, share - 0.1)
    spread = rng.choice([-1.0, 1.0], share.shape) * rng.uniform(0.25, 0.9, share.shape) * (1.1 - 0.5 * share)
    angle = angle_of(ahead) + spread
    tip = foot + (length * (1.15 - 0.4 * share) * rng.uniform(0.7, 1.1, share.shape))[..., None] * heading(angle)
    return np.stack([foot, tip], axis=2)
