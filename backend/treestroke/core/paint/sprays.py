"""Drawings of sprays: leaves, needles, scales or flowers on a twig, or a piece of a frond, on a transparent square."""

from typing import Literal

import numpy as np

from treestroke.core.paint.broad_leaves import draw_ovate_leaves, draw_species_leaves
from treestroke.core.paint.canvas import DARK, HEART, LIGHT, PLAIN, Canvas, fits_canvas
from treestroke.core.paint.fronds import draw_frond_piece, draw_strap_piece
from treestroke.core.paint.needles import draw_species_needles
from treestroke.core.paint.scales import draw_scale_spray
from treestroke.core.paint.shoots import along, draw_twig, heading
from treestroke.core.paint.species import AUTO, Species
from treestroke.core.types import Floats, FoliageKind, Picture

SprayKind = Literal["broad", "needles", "scales", "frond", "strap", "blossom"]

CARD_SIZE: dict[FoliageKind, float] = {"leaves": 1.0, "needles": 1.6, "scales": 1.4, "palm": 1.0, "bare": 1.0}
"""Size of the card that shows a spray, relative to one of broad leaves: a conifer's spray has many more parts."""
FLOWERS = 220
"""Flowers tried for a spray; those that would hide others or leave the square are left out."""


def draw_spray(
    kind: SprayKind, side: int, colours: Floats, rng: np.random.Generator, species: Species = AUTO
) -> Picture:
    """Draw a spray whose twig rises from the middle of the bottom edge, in colours drawn from (m, 3), CIE Lab.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha; the transparent part has the spray's mean colour.
    """
    match kind:
        case "broad" if species.leaf_shape is not None:
            return draw_species_leaves(species, side, colours, rng)
        case "broad":
            return draw_ovate_leaves(species.length, side, colours, rng)
        case "needles":
            return draw_species_needles(species.needles or "short", side, colours, rng)
        case "scales":
            return draw_scale_spray(side, colours, rng)
        case "frond":
            return draw_frond_piece(side, colours, rng)
        case "strap":
            return draw_strap_piece(side, colours, rng)
        case "blossom":
            return _draw_blossom(side, colours, rng)


def _draw_blossom(side: int, colours: Floats, rng: np.random.Generator) -> Picture:
    """Draw five-petalled flowers in loose clusters on a twig, leaving out those that would hide others."""
    canvas, twig = Canvas(side, colours, FLOWERS, rng), draw_twig(rng)
    share, radius = rng.uniform(0.1, 1.0, FLOWERS), rng.uniform(0.05, 0.085, (FLOWERS, 1, 1))
    centre = along(twig, share) + rng.normal(0, 0.17, (FLOWERS, 2))
    start = rng.uniform(0, 2 * np.pi, (FLOWERS, 1))
    spokes = radius * heading(start + np.arange(5) * 2 * np.pi / 5)
    stalks = np.stack([along(twig, np.maximum(0, share - 0.2)), centre], axis=1)
    rim = centre[:, None] + 1.6 * spokes
    fitting = np.flatnonzero(fits_canvas(rim))
    canvas.lines(twig[None], canvas.wood, 0.012)
    canvas.lines(stalks[fitting[:20]], canvas.wood, 0.006)
    for flower in fitting.tolist():
        if canvas.painted_share(canvas.cells(rim[flower])) <= 0.4:
            _draw_flower(canvas, centre[flower], spokes[flower], canvas.paints[flower])
    return canvas.tile()


def _draw_flower(canvas: Canvas, centre: Floats, spokes: Floats, paint: Picture) -> None:
    """Draw five round petals about spokes (5, 2) and a darker heart, in a flower's shades (6, 3)."""
    circle = float(np.hypot(*spokes[0])) * heading(np.linspace(0, 2 * np.pi, 10))
    for spoke, shade in zip(spokes, (PLAIN, LIGHT, DARK, LIGHT, PLAIN), strict=True):
        canvas.polygon(centre + spoke + 0.7 * circle, paint[shade])
    canvas.polygon(centre + 0.25 * circle, paint[HEART])
