"""The radii along a stroke's line, by the half-widths that were measured there."""

import numpy as np

from treestroke.core.geometry.polyline import arc_lengths
from treestroke.core.trace.thickness import non_increasing
from treestroke.core.types import Floats, Mask

CHILD_RADIUS = 0.5
"""Radius of a limb relative to its parent where it is not seen: the median of 24 limbs on photos is 0.49, of 50 of
synthetic trees 0.48 (Tan et al. 2008, section 2, take 0.75)."""
LIMB_TAPER, STEM_TAPER = 0.6, 0.7
"""Share of its first radius that a limb, and a stem, loses along its stroke where nothing is measured."""
UNEVEN = 1.25
"""Greatest measured radius of a limb relative to an even taper of median size, and greatest the other way round: beyond
it another limb lies beside it, or leaves before it."""
CONE, BEFORE = 1.1, 8
"""In the crown a stem is at most so many times as thick as a cone from the last bare places, so many, to the tree's
top: limbs that leave it, and neighbours of its own colour, do not widen it. Of the places along 17 stems in the crowns
of synthetic trees, 76 % come out within 20 % of the truth (69 % in a blunter cone)."""
MOST_SWELLING = 1.8
"""Greatest measured radius of a stem relative to its median: more is a shadow beside it."""
LEAST_EXPECTED = 0.5
"""Least radius of a stem relative to the one that an even taper gives: less is a sliver of it between leaves."""
LEAST_SEEN = 4
"""Least number of places along a line where its width must be seen for it to count."""


def drawn_radii(line_px: Floats, width_px: float) -> Floats:
    """Return the radii (n,), px, along a line (n, 2), px, that was drawn with a brush of this width."""
    return width_px / 2 * (1 - LIMB_TAPER * _shares(line_px))


def limb_radii(line_px: Floats, halves: Floats, parent_px: float) -> Floats:
    """Return the radii (n,), px, along a limb's line (n, 2), px, by its half-widths (n,), NaN where unseen.

    They never grow outward. ``parent_px`` is the radius of the wood that it leaves.
    """
    share = _shares(line_px)
    places = np.flatnonzero(~np.isnan(halves))
    if len(places) < LEAST_SEEN:
        return CHILD_RADIUS * parent_px * (1 - LIMB_TAPER * share)
    even = 1 - LIMB_TAPER * share
    size = float(np.median(halves[places] / even[places]))
    uneven = non_increasing(np.clip(halves[places] / (size * even[places]), 1 / UNEVEN, UNEVEN) * size * even[places])
    before, after = share < share[places[0]], share > share[places[-1]]
    radii = np.interp(share, share[places], uneven)
    radii[before] *= even[before] / even[places[0]]
    radii[after] *= even[after] / even[places[-1]]
    return np.minimum(radii, parent_px)


def stem_radii(line_px: Floats, halves: Floats, bare: Mask, height_px: float, usual_px: float) -> Floats:
    """Return the radii (n,), px, along a stem's line (n, 2), px, by its half-widths (n,), NaN where unseen.

    They never grow upward. Measurements on bare wood below the crown (n,), if there are enough, take the place of
    slivers among leaves; ``usual_px`` is the radius of a stem of which nothing is seen.
    """
    share = _shares(line_px)
    places = np.flatnonzero(~np.isnan(halves))
    if len(places) < LEAST_SEEN:
        return usual_px * (1 - STEM_TAPER * share)
    known = places[bare[places]]
    usual = float(np.median(halves[known if len(known) >= LEAST_SEEN else places]))
    expected = (usual if len(known) >= LEAST_SEEN else usual_px) * (1 - STEM_TAPER * share)
    below = known[-BEFORE:] if len(known) >= LEAST_SEEN else places[:BEFORE]
    left = np.maximum(1 - (line_px[0, 1] - line_px[:, 1]) / height_px, 0.0)
    cone = CONE * np.median(halves[below]) * left / np.median(left[below])
    measured = np.minimum(halves[places], np.where(bare[places], MOST_SWELLING * usual, cone[places]))
    radii = np.interp(np.arange(len(line_px)), places, non_increasing(measured))
    hidden = share > share[places[-1]]
    radii[hidden] *= 1 - STEM_TAPER * (share[hidden] - share[places[-1]])
    return np.asarray(np.maximum(radii, LEAST_EXPECTED * expected))


def _shares(line_px: Floats) -> Floats:
    """Return the share (n,) of the way along a line (n, 2) at which each place lies."""
    arcs = arc_lengths(line_px)
    return np.asarray(arcs / max(float(arcs[-1]), 1e-9))
