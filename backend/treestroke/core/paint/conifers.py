"""Sprays of conifers' needles."""

import numpy as np

from treestroke.core.paint.easel import DARK, LIGHT, PLAIN, Easel, inside
from treestroke.core.paint.shoots import along, angle_of, draw_shoots, heading
from treestroke.core.paint.species import Needles
from treestroke.core.types import Floats, Picture

LONG, SHORT, TUFTS = 42, 90, 18
"""Needles of a pine's shoot, of a spruce's, and of one tuft of a larch."""
TUFTS_OF_SHOOT = 6


def draw_shoot_of_needles(needles: Needles, side: int, members: Floats, rng: np.random.Generator) -> Picture:
    """Draw needles: long ones in brushes at the shoots' ends, short ones all around, or tufts along thin twigs."""
    match needles:
        case "long":
            shoots = draw_shoots(rng, 9, 0.75, 0.26)
            lines, width = _brushes(shoots, rng), 0.0105
        case "short":
            shoots = _flat_shoots(rng)
            lines, width = _all_around(shoots, rng), 0.0105
        case "tufts":
            shoots = draw_shoots(rng, 9, 0.9, 0.39)
            lines, width = _tufts(shoots, rng), 0.006
    easel = Easel(side, members, len(lines), rng)
    easel.lines(shoots, easel.wood, 0.008 if needles == "tufts" else 0.014)
    _draw(easel, lines[inside(lines)], width, rng)
    return easel.tile()


def _draw(easel: Easel, lines: Floats, width: float, rng: np.random.Generator) -> None:
    """Draw needles (p, 3, 2): the dark ones below, the light ones on top."""
    order = rng.permutation(len(lines))
    groups = np.array_split(order, 36)
    for start, group in enumerate(groups):
        paint = easel.paints[group[0] if len(group) else 0]
        easel.lines(lines[group], paint[(DARK, PLAIN, LIGHT)[start // 12]], width)


def _bowed(foot: Floats, angle: Floats, length: Floats, bow: Floats) -> Floats:
    """Draw needles (p, 3, 2) out from their foot (p, 2), bowed a little."""
    middle = foot + 0.5 * length[:, None] * heading(angle)
    return np.stack([foot, middle, middle + 0.5 * length[:, None] * heading(angle + bow)], axis=1)


def _brushes(shoots: Floats, rng: np.random.Generator) -> Floats:
    """Seat a pine's: long ones on the outer half of each shoot, standing off on all sides."""
    shoot = np.repeat(np.arange(len(shoots)), LONG)
    share = 1.0 - 0.3 * rng.random(len(shoot))
    foot = along(shoots[shoot], share)
    ahead = angle_of(foot - along(shoots[shoot], share - 0.1))
    spread = rng.uniform(-1.25, 1.25, len(shoot)) * (1.4 - 0.6 * share)
    length = rng.uniform(0.17, 0.26, len(shoot)) * (1.0 - 0.2 * np.abs(spread))
    return _bowed(foot, ahead + spread, length, -0.25 * spread + rng.normal(0, 0.08, len(shoot)))


def _flat_shoots(rng: np.random.Generator) -> Floats:
    """Draw a spruce's twig (m, 9, 2): straight, with shoots to both sides, near in pairs, short toward its tip."""
    t, count = np.linspace(0, 1, 9), 11
    twig = np.stack([0.5 + rng.uniform(-0.05, 0.05) * t, 0.97 - 0.86 * t], axis=1)
    share = np.linspace(0.06, 0.86, count) + rng.uniform(-0.02, 0.02, count)
    turn = np.where(np.arange(count) % 2, 1.0, -1.0)
    angle = turn * rng.uniform(0.75, 1.05, count)
    length = 0.62 * (1.05 - share) ** 0.55 * rng.uniform(0.75, 1.05, count)
    bent = angle[:, None] - turn[:, None] * rng.uniform(0.1, 0.35, (count, 1)) * t
    return np.concatenate([twig[None], along(twig, share)[:, None] + (length[:, None] * t)[..., None] * heading(bent)])


def _all_around(shoots: Floats, rng: np.random.Generator) -> Floats:
    """Seat a spruce's: short stiff ones along every shoot, pointing forward."""
    shoot = np.repeat(np.arange(len(shoots)), SHORT)
    share = rng.random(len(shoot))
    foot = along(shoots[shoot], share)
    ahead = angle_of(along(shoots[shoot], share + 0.06) - along(shoots[shoot], share - 0.06))
    spread = rng.choice([-1.0, 1.0], len(shoot)) * rng.uniform(0.15, 1.0, len(shoot))
    length = rng.uniform(0.05, 0.075, len(shoot))
    return _bowed(foot, ahead + spread, length, -0.3 * spread)


def _tufts(shoots: Floats, rng: np.random.Generator) -> Floats:
    """Seat a larch's: soft ones in tufts that stand along the twigs."""
    each = TUFTS_OF_SHOOT * TUFTS
    shoot = np.repeat(np.arange(len(shoots)), each)
    place = (np.arange(TUFTS_OF_SHOOT) + 1.0) / TUFTS_OF_SHOOT
    share = np.tile(np.repeat(place, TUFTS), len(shoots)) - 0.02
    foot = along(shoots[shoot], share)
    ahead = angle_of(foot - along(shoots[shoot], share - 0.1))
    spread = rng.uniform(-1.9, 1.9, len(shoot))
    length = rng.uniform(0.065, 0.105, len(shoot))
    return _bowed(foot, ahead + spread, length, rng.normal(0, 0.2, len(shoot)))
