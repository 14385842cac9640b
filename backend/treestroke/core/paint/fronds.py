"""Pieces of palm fronds, a midrib with narrow leaflets to both sides, and of strap leaves."""

import numpy as np

from treestroke.core.paint.canvas import DARK, LIGHT, PLAIN, RIB, Canvas, fits_canvas
from treestroke.core.paint.shoots import heading
from treestroke.core.types import Floats, Picture

LEAFLETS = 16
"""Leaflets on each side of a piece."""


def draw_frond_piece(side: int, colours: Floats, rng: np.random.Generator) -> Picture:
    """Draw a piece of a frond whose midrib rises from the middle of the bottom edge to that of the top.

    Its leaflets reach from the midrib to both sides, forward, and bend down at their tips. Pieces that overlap along a
    midrib make a frond.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha, in colours drawn from (m, 3), CIE Lab.
    """
    leaflets = _leaflets(rng)
    leaflets = leaflets[fits_canvas(leaflets)]
    canvas = Canvas(side, colours, len(leaflets), rng)
    for number, leaflet in enumerate(leaflets):
        shade = (PLAIN, DARK, LIGHT, PLAIN)[number % 4]
        canvas.polygon(leaflet, canvas.paints[number, shade])
    canvas.lines(np.array([[[0.5, 0.96], [0.5, 0.04]]]), canvas.paints[0, RIB], 0.022)
    return canvas.tile()


def draw_strap_piece(side: int, colours: Floats, rng: np.random.Generator) -> Picture:
    """Draw a piece of a strap leaf, as dracaenas and yuccas bear it: a blade that runs through the square, with a rib.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha, in colours drawn from (m, 3), CIE Lab.
    """
    canvas, half = Canvas(side, colours, 1, rng), rng.uniform(0.11, 0.15)
    for shade, left, right in ((DARK, -half, 0.02), (LIGHT, -0.02, half), (RIB, -0.012, 0.012)):
        blade = np.array([[left, 0.97], [right, 0.97], [right, 0.03], [left, 0.03]]) + np.array([0.5, 0.0])
        canvas.polygon(blade, canvas.paints[0, shade])
    return canvas.tile()


def _leaflets(rng: np.random.Generator) -> Floats:
    """Place blades (p, 6, 2) in pairs, some of them torn short."""
    place = np.repeat(np.linspace(0.94, 0.24, LEAFLETS), 2) + rng.uniform(-0.012, 0.012, 2 * LEAFLETS)
    turn = np.tile([1.0, -1.0], LEAFLETS)
    angle = turn * rng.uniform(0.75, 1.05, 2 * LEAFLETS)
    length = rng.uniform(0.38, 0.5, 2 * LEAFLETS) * np.where(rng.random(2 * LEAFLETS) < 0.12, 0.6, 1.0)
    foot = np.stack([np.full(2 * LEAFLETS, 0.5), place], axis=1)
    middle = foot + 0.55 * length[:, None] * heading(angle)
    tip = middle + 0.45 * length[:, None] * heading(angle + turn * rng.uniform(-0.1, 0.45, 2 * LEAFLETS))
    across = 0.5 * rng.uniform(0.032, 0.046, 2 * LEAFLETS)[:, None] * heading(angle + np.pi / 2)
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
