"""Pieces of palm fronds, a midrib with narrow leaflets to both sides, and of strap leaves."""

import numpy as np

from treestroke.core.paint.canvas import LIGHT, PLAIN, RIB, Canvas
from treestroke.core.types import Floats, Picture

LEAFLETS = 8
"""Leaflets of a piece."""
FEET, SLANT = (0.06, 0.42), 0.5
"""Where leaflets begin on the bottom edge, and how far their tips lie further to the right."""


def draw_frond_piece(side: int, colours: Floats, rng: np.random.Generator) -> Picture:
    """Draw the leaflets on one side of a piece of a frond, whose midrib runs along the bottom edge to the right.

    They rise to the right, side by side. Pieces that overlap along a midrib make one side of a frond.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha, in colours drawn from (m, 3), CIE Lab.
    """
    leaflets = _leaflets(rng)
    canvas = Canvas(side, colours, len(leaflets), rng)
    for leaflet, paint in zip(leaflets, canvas.paints, strict=True):
        canvas.polygon(leaflet, paint[PLAIN])
    return canvas.tile()


def draw_strap_piece(side: int, colours: Floats, rng: np.random.Generator) -> Picture:
    """Draw half a strap leaf, as dracaenas and yuccas bear it: a blade along the bottom edge, where its rib is.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha, in colours drawn from (m, 3), CIE Lab.
    """
    canvas, width = Canvas(side, colours, 1, rng), rng.uniform(0.2, 0.26)
    for shade, low, high in ((LIGHT, 0.0, width), (PLAIN, 0.0, 0.6 * width), (RIB, 0.0, 0.05)):
        left, right, bottom, top = 0.03, 0.97, 0.97 - low, 0.97 - high
        canvas.polygon(np.array([[left, bottom], [right, bottom], [right, top], [left, top]]), canvas.paints[0, shade])
    return canvas.tile()


def _leaflets(rng: np.random.Generator) -> Floats:
    """Place blades (p, 6, 2) side by side, bent forward, some of them torn short."""
    foot = np.stack(
        [np.linspace(*FEET, LEAFLETS) + rng.uniform(-0.02, 0.02, LEAFLETS), np.full(LEAFLETS, 0.97)], axis=1
    )
    slant = SLANT + rng.uniform(-0.08, 0.08, LEAFLETS)
    way = np.stack([slant, np.full(LEAFLETS, -0.92)], axis=1)
    way *= np.where(rng.random(LEAFLETS) < 0.15, 0.6, rng.uniform(0.85, 1.0, LEAFLETS))[:, None]
    bow = rng.uniform(-0.12, 0.0, LEAFLETS)[:, None] * np.array([1.0, 0.3])
    middle, tip = foot + 0.5 * way + bow, foot + way
    across = 0.5 * rng.uniform(0.042, 0.06, LEAFLETS)[:, None] * np.array([1.0, 0.35])
    return np.stack(
        [
            foot - 0.5 * across,
            middle - across,
            tip - 0.1 * across,
            tip + 0.1 * across,
            middle + across,
            foot + 0.5 * across,
        ],
        axis=1,
    )
