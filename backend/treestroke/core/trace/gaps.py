"""Bridging of the gaps between the strokes of a picture."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.errors import StrokesError
from treestroke.core.stroke_rules import TOUCH_SHARE
from treestroke.core.types import Floats, Indices, Mask
from treestroke.limits import MAX_STROKES

SPECK = 0.006
"""Greatest extent of a speck, which is dropped, as a share of the long side."""


def bridge_gaps(lines: Mask, ink: Mask, half_widths: NDArray[np.float32]) -> tuple[Mask, Mask, list[Floats]]:
    """Join the thinned lines (h, w) of separate strokes to one drawing, the nearest first; drop specks.

    ``ink`` (h, w) is the mask that was thinned, ``half_widths`` (h, w) its half widths, px. As in Boruvka's algorithm
    for a minimum spanning tree, each round bridges the gap from each stroke to the nearest other one.

    Returns
    -------
    Mask (h, w) of the lines with their bridges; mask (h, w) of the lines of the largest drawing, which may have gaps up
    to `TOUCH_SHARE` of the long side; middle (2,) of each bridge, px.

    Raises
    ------
    StrokesError
        There are more than `MAX_STROKES` separate strokes.
    """
    count, labels, stats, _ = cv2.connectedComponentsWithStats(ink.astype(np.uint8), connectivity=8)
    extent = stats[:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]].max(axis=1)
    extent[0] = 0
    kept = extent > min(max(3.0, SPECK * max(ink.shape)), float(extent.max()) - 1)
    if np.count_nonzero(kept) > MAX_STROKES:
        problem = f"the picture has {np.count_nonzero(kept)} separate strokes, at most {MAX_STROKES} are allowed"
        raise StrokesError(f"{problem}; leave some out", code="too_many_strokes")
    lines = lines & kept[labels]
    pixels = np.argwhere(lines)
    owner = labels[tuple(pixels.T)].astype(np.int64)
    near = TOUCH_SHARE * max(ink.shape)
    group, trunk = np.arange(count), np.arange(count)
    bridged, middles = lines.astype(np.uint8), []
    ends = _ends(pixels, owner)
    widths = half_widths[tuple(pixels.T)].astype(np.float64)
    while len(np.unique(group[owner])) > 1:
        for gap, end, other in _bridges(pixels.astype(np.float64), ends, group[owner], widths):
            if _merge(group, owner[end], owner[other]):
                sides = pixels[[end, other]][:, ::-1]
                cv2.line(bridged, sides[0].tolist(), sides[1].tolist(), 1)
                middles.append(np.asarray(sides.mean(axis=0) + 0.5))
                if gap <= near:
                    _merge(trunk, owner[end], owner[other])
    sizes = np.bincount(trunk[owner], minlength=count)
    return bridged > 0, lines & (trunk[labels] == sizes.argmax()), middles


def _merge(group: Indices, stroke: int, other: int) -> bool:
    """Merge the groups of two strokes in place; return whether they were different."""
    first, last = group[stroke], group[other]
    group[group == last] = first
    return bool(first != last)


def _bridges(places: Floats, ends: list[int], group: Indices, half_widths: Floats) -> list[tuple[float, int, int]]:
    """List each end's gap, px, to the nearest pixel (n, 2) of another group, with both pixels' indices, least first."""
    found = []
    for end in ends:
        gaps = np.hypot(*(places - places[end]).T) - half_widths - half_widths[end]
        gaps[group == group[end]] = np.inf
        other = int(gaps.argmin())
        found.append((max(float(gaps[other]), 0.0), end, other))
    return sorted(found)


def _ends(pixels: Indices, owner: Indices) -> list[int]:
    """Return the indices of the pixels (n, 2) at the ends of strokes; of a stroke without an end, of every fourth."""
    size = pixels.max(axis=0) + 3
    there = np.zeros(size, dtype=np.uint8)
    there[tuple(pixels.T + 1)] = 1
    counts = cv2.boxFilter(there, cv2.CV_16S, (3, 3), normalize=False, borderType=cv2.BORDER_CONSTANT)
    ends = counts[tuple(pixels.T + 1)] <= 2
    for stroke in np.setdiff1d(owner, owner[ends]).tolist():
        ends[np.flatnonzero(owner == stroke)[::4]] = True
    return np.flatnonzero(ends).tolist()
