"""Sprays of scale leaves, as cypress, thuja and juniper bear them: twigs that branch again and again, clad in green."""

import numpy as np

from treestroke.core.paint.canvas import DARK, LIGHT, PLAIN, Canvas, fits_canvas
from treestroke.core.paint.shoots import along, angle_of, heading
from treestroke.core.types import Floats, Picture

SHOOTS = 12
"""Side shoots of a spray."""
TWIGS = 22
"""Twigs of a shoot."""


def draw_scale_spray(side: int, colours: Floats, rng: np.random.Generator) -> Picture:
    """Draw a plume: a twig whose shoots and their twigs stand upward, as fine cords of scales.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha, in colours drawn from (m, 3), CIE Lab.
    """
    shoots = _plume(rng)
    twigs = _twigs(shoots, rng)
    canvas = Canvas(side, colours, len(twigs), rng)
    canvas.lines(shoots[:1], canvas.wood, 0.012)
    fitting = np.flatnonzero(fits_canvas(twigs))
    for number, group in enumerate(np.array_split(rng.permutation(fitting), 36)):
        paint = canvas.paints[group[0] if len(group) else 0]
        canvas.lines(twigs[group], paint[(DARK, PLAIN, LIGHT)[number // 12]], 0.015)
    return canvas.tile()


def _plume(rng: np.random.Generator) -> Floats:
    """Draw a bowed twig and shoots that leave it steeply to alternate sides and turn up: (m, 9, 2)."""
    t = np.linspace(0, 1, 9)
    twig = np.stack([0.5 + rng.uniform(-0.08, 0.08) * t**2, 0.97 - 0.88 * t], axis=1)
    share = np.linspace(0.03, 0.92, SHOOTS) + rng.uniform(-0.02, 0.02, SHOOTS)
    turn = np.where((np.arange(SHOOTS) + rng.integers(2)) % 2, 1.0, -1.0)
    length = np.interp(share, [0.0, 0.25, 1.0], [0.4, 0.5, 0.16]) * rng.uniform(0.65, 1.1, SHOOTS)
    bent = turn[:, None] * (rng.uniform(0.7, 1.05, (SHOOTS, 1)) - rng.uniform(0.15, 0.5, (SHOOTS, 1)) * t)
    way = (length[:, None] * t)[..., None] * heading(bent)
    return np.concatenate([twig[None], along(twig, share)[:, None] + way])


def _twigs(shoots: Floats, rng: np.random.Generator) -> Floats:
    """Place twigs (p, 3, 2) to alternate sides of each shoot (m, 9, 2), shorter toward its tip, and its own tip."""
    shoot = np.repeat(np.arange(len(shoots)), TWIGS)
    order = np.tile(np.arange(TWIGS), len(shoots))
    share = (order + rng.uniform(0.2, 1.0, len(shoot))) / TWIGS
    foot = along(shoots[shoot], share)
    ahead = angle_of(along(shoots[shoot], share + 0.06) - along(shoots[shoot], share - 0.06))
    spread = np.where(order % 2, 1.0, -1.0) * rng.uniform(0.3, 0.75, len(shoot))
    reach = rng.uniform(0.035, 0.06, len(shoot)) * (1.15 - 0.55 * share)
    middle = foot + 0.5 * reach[:, None] * heading(ahead + spread)
    side_twigs = np.stack([foot, middle, middle + 0.5 * reach[:, None] * heading(ahead + 0.55 * spread)], axis=1)
    cords = np.concatenate([shoots[1:, a : a + 3] for a in (0, 2, 4, 6)])
    return np.concatenate([side_twigs, cords])
