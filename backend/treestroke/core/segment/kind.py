"""What a tree's twigs bear, judged by its picture: leaves, needles or nothing."""

from collections.abc import Mapping, Sequence
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import distances_to_segment
from treestroke.core.imaging.histogram import median_of_bytes
from treestroke.core.types import FOLIAGE_KINDS, Floats, FoliageKind, Mask

KindOdds = Mapping[FoliageKind, float]
"""Probability of each kind of foliage; together they are 1."""
UNJUDGED: KindOdds = {kind: float(kind == "leaves") for kind in FOLIAGE_KINDS}
"""Where there is no picture to judge by, a tree is in leaf."""

FoliageLook = Literal["bare", "dull", "fresh"]
"""Twigs alone; dull dark green; anything else."""

THIN = 0.5
"""Share of the foliage that is lines thinner than 2 % of the crown, above which a tree is bare."""
TWIG_CONTRAST = 85.0
"""Mean contrast of fine lines with what is behind them, 0 to 510, above which a colourless crown is bare."""
COLOURLESS, WHITE = 0.25, 0.15
"""Greatest tint of twigs, green or red over blue, and greatest share of white in a crown that is not in blossom."""
DARKNESS = 95.0
"""Greatest median brightness of needles, 0 to 255."""
TALLNESS = 1.2
"""Least height of a conifer's crown relative to its width, if it does not taper."""


def foliage_look(photo: NDArray[np.uint8], mask: Mask, crown: Mask) -> tuple[FoliageLook, float]:
    """Judge how foliage looks, and with what certainty, by its mask (h, w) and the crown's (h, w) on a photo (h, w, 3).

    It is bare if the crown consists of thin lines, or of a web of colourless lines with something else between them.
    The certainty, 0 to 1, is the distance of the cues from where they would say otherwise; bluish foliage is sky rather
    than leaves and has certainty 0.
    """
    if not mask.any():
        return "bare", 1.0
    red, green, blue = colours = tuple(photo[..., channel][mask] for channel in range(3))
    # How much green or red exceed blue in the median pixel, relative to its brightness: below 0 it is bluish.
    warmest = np.maximum(red, green)
    brightness = np.maximum(warmest, blue)
    tint = float(np.median(np.subtract(warmest, blue, dtype=np.float64) / np.maximum(brightness, 40)))
    thinness = _thinness(mask, crown) / THIN - 1.0
    colourless = min(1.0 - tint / COLOURLESS, 1.0 - float((brightness > 200).mean()) / WHITE)
    # Foliage with colour, or white foliage, is not a web of twigs: the costly search for lines is skipped.
    web = min(colourless, _lines(photo, mask, crown) / TWIG_CONTRAST - 1.0) if colourless > thinness else colourless
    bareness = float(max(thinness, web))
    if bareness >= 0.0:
        return "bare", min(bareness, 1.0)
    return "dull" if _is_dull_green(colours) else "fresh", 0.0 if tint < 0.0 else min(-bareness, 1.0)


def likeliest(odds: KindOdds) -> FoliageKind:
    """Return the most probable kind of foliage."""
    return max(FOLIAGE_KINDS, key=odds.__getitem__)


def kind_odds(look: FoliageLook, sureness: float, mask: Mask, trunk_px: Floats) -> KindOdds:
    """Judge what twigs bear by the foliage's look, its mask (h, w) and the trunk stroke (n, 2), px.

    Needles: dull dark green, in a crown that is tall or tapers to a top above a trunk that runs through it. The rules
    are ours, judged on 28 photos.
    """
    kind: FoliageKind = "leaves"
    if look == "bare":
        kind = "bare"
    elif look == "dull" and _is_spire(mask, trunk_px):
        kind = "needles"
    odds = dict.fromkeys(FOLIAGE_KINDS, 0.0)
    odds[kind] = 0.5 + 0.5 * sureness
    odds["leaves" if kind == "bare" else "bare"] = 0.5 - 0.5 * sureness
    return odds


def _thinness(mask: Mask, crown: Mask) -> float:
    """Share of the mask, 0 to 1, that vanishes when it is opened by a disc as wide as 2 % of the crown's size."""
    opened = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, _disc(0.02, crown))
    return 1.0 - float(opened.sum()) / float(mask.sum())


def _lines(photo: NDArray[np.uint8], mask: Mask, crown: Mask) -> float:
    """Mean contrast of fine lines with what is behind them, 0 to 510."""
    grey, kernel = cv2.cvtColor(photo, cv2.COLOR_RGB2GRAY), _disc(0.012, crown)
    lines = cv2.morphologyEx(grey, cv2.MORPH_TOPHAT, kernel)[mask].astype(np.float64)
    lines += cv2.morphologyEx(grey, cv2.MORPH_BLACKHAT, kernel)[mask]
    return float(lines.mean())


def _disc(share: float, crown: Mask) -> NDArray[np.uint8]:
    """Return a disc (n, n) as wide as a share of the crown's size, the square root of its area."""
    size = max(3, int(share * np.sqrt(crown.sum())) | 1)
    return np.asarray(cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size)), dtype=np.uint8)


def _is_dull_green(colours: Sequence[NDArray[np.uint8]]) -> bool:
    """Tell whether colours, three channels (n,), sRGB, are dark and green, but not vivid, by their median."""
    red, green, blue = map(median_of_bytes, colours)
    return bool(max(red, green, blue) < DARKNESS and green >= blue and green > 0.97 * red)


def _is_spire(mask: Mask, trunk_px: Floats) -> bool:
    """Tell whether the crown is tall, or tapers upward, and a straight trunk runs up through most of it."""
    rows = np.flatnonzero(mask.any(axis=1))
    left, right = mask[rows].argmax(axis=1), mask[rows, ::-1].argmax(axis=1)
    widths = (mask.shape[1] - right - left).astype(np.float64)
    height, width = float(len(rows)), float(np.percentile(widths, 90))
    quarter = max(1, len(rows) // 4)
    taper = widths[:quarter].mean() / max(widths[-2 * quarter :].mean(), 1.0)
    reach = (rows[-1] - trunk_px[:, 1].min()) / max(height, 1.0)
    tall = height > TALLNESS * width or (taper < 0.5 and height > 0.9 * width)
    return bool(reach > 0.55 and tall and _is_upright(trunk_px))


def _is_upright(trunk_px: Floats) -> bool:
    """Tell whether a trunk stroke (n, 2), px, is straight and leans by less than 10 degrees."""
    span = trunk_px[-1] - trunk_px[0]
    length = float(np.hypot(*span))
    deviation = distances_to_segment(trunk_px, trunk_px[0], trunk_px[-1]).max()
    return bool(abs(span[0]) < 0.17 * length and deviation < 0.04 * length)
