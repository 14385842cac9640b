"""Binary labels on a pixel grid by graph cut, bounded in time."""

import cv2
import maxflow
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Mask, Picture

Energies = NDArray[np.float32]

SOFTEST_STEP = 6.0
"""Colour difference below which neighbours count as equal: bounds lambda / |I_x - I_y| (noise of a JPEG)."""
BAND_PX = 3
"""Half-width of the band around a coarse border that is cut again, in fine pixels per halving."""


def cut_grid(pixels: Picture, odds: Energies, region: Mask, smoothness: float, coarse_pixels: int) -> Mask:
    """Label the region's pixels (h, w) so that data and smoothness cost least; outside it all is False.

    Data: ``odds`` (h, w), the log odds of True. Smoothness (Tan et al. 2008, section 2): 4-neighbours with
    different labels cost ``smoothness / |I_x - I_y|`` for colours (h, w, 3). The whole is solved on a grid of
    at most ``coarse_pixels``, then each doubling of the resolution solves just a band along the border, so
    that time is bounded whatever the photo (a full cut of a noisy photo can take minutes).
    """
    levels = _pyramid(pixels, odds, region, coarse_pixels)
    labels: Mask | None = None
    for level_pixels, level_odds, level_region in levels:
        band = level_region
        if labels is not None:
            size = (level_region.shape[1], level_region.shape[0])
            labels = cv2.resize(labels.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST).astype(bool)
            band = level_region & _border_band(labels)
        labels = _cut(level_pixels, level_odds, level_region, band, labels, smoothness)
    return np.zeros_like(region) if labels is None else labels


def _pyramid(pixels: Picture, odds: Energies, region: Mask, coarse_pixels: int) -> list[tuple[Picture, Energies, Mask]]:
    """Halve the problem until it is small enough; coarsest first."""
    levels = [(pixels, odds, region)]
    while levels[0][2].sum() > coarse_pixels:
        pixels, odds, region = levels[0]
        size = (max(1, region.shape[1] // 2), max(1, region.shape[0] // 2))
        half = cv2.resize(region.astype(np.float32), size, interpolation=cv2.INTER_AREA) >= 0.5
        fewer = np.asarray(cv2.resize(pixels, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
        milder = np.asarray(cv2.resize(odds, size, interpolation=cv2.INTER_AREA), dtype=np.float32)
        levels.insert(0, (fewer, milder, half))
    return levels


def _border_band(labels: Mask) -> Mask:
    """Pixels near a change of label."""
    kernel = np.ones((2 * BAND_PX + 1, 2 * BAND_PX + 1), np.uint8)
    grey = labels.astype(np.uint8)
    return np.asarray(cv2.dilate(grey, kernel) != cv2.erode(grey, kernel))


def _cut(pixels: Picture, odds: Energies, region: Mask, band: Mask, known: Mask | None, smoothness: float) -> Mask:
    """Solve the band's pixels; the others keep their known label (outside the region: False)."""
    labels = region & known if known is not None else np.zeros_like(region)
    count = int(band.sum())
    if count == 0:
        return labels
    index = np.full(region.shape, -1, np.int64)
    index[band] = np.arange(count)
    to_true, to_false = np.maximum(odds, 0)[band].astype(np.float64), np.maximum(-odds, 0)[band].astype(np.float64)
    graph = maxflow.Graph[float](count, 2 * count)
    nodes = graph.add_nodes(count)
    for ahead, behind in _neighbours():
        weight = _edge_weights(pixels[behind], pixels[ahead], smoothness)
        first, second = index[behind], index[ahead]
        both = (first >= 0) & (second >= 0)
        graph.add_edges(first[both], second[both], weight[both], weight[both])
        for inner, outer in ((behind, ahead), (ahead, behind)):
            rim = (index[inner] >= 0) & (index[outer] < 0) & region[outer]
            at, cost = index[inner][rim], weight[rim]
            side = labels[outer][rim]
            np.add.at(to_true, at[side], cost[side])
            np.add.at(to_false, at[~side], cost[~side])
    graph.add_grid_tedges(nodes, to_true, to_false)
    graph.maxflow()
    labels[band] = ~graph.get_grid_segments(nodes)
    return labels


def _neighbours() -> tuple[tuple[tuple[slice, slice], tuple[slice, slice]], ...]:
    """Slices of (next, this) for neighbours to the right and below."""
    every, ahead, behind = slice(None), slice(1, None), slice(None, -1)
    return ((every, ahead), (every, behind)), ((ahead, every), (behind, every))


def _edge_weights(this: Picture, following: Picture, smoothness: float) -> NDArray[np.float64]:
    """Cost of a border between neighbouring colours."""
    red, green, blue = (cv2.absdiff(this[..., c], following[..., c]).astype(np.float32) for c in range(3))
    step = np.sqrt(red * red + green * green + blue * blue)
    return np.asarray(smoothness / np.maximum(step, SOFTEST_STEP), dtype=np.float64)
