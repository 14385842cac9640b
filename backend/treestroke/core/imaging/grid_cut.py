"""Binary labels on a pixel grid by graph cut, in bounded time."""

from dataclasses import dataclass

import cv2
import maxflow
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats, Indices, Mask, Picture

Energies = NDArray[np.float32]

SOFTEST_STEP = 6.0
"""Colour difference, 0 to 441, below which neighbours count as equal: bounds lambda / |I_x - I_y| (JPEG noise)."""
BAND_PX = 3
"""Half-width of the band around a coarse border that is cut again, px of the finer level."""


@dataclass(frozen=True, eq=False)
class _Level:
    """The problem at one resolution: colours (h, w, 3), log odds of True (h, w), and where labels are wanted (h, w)."""

    pixels: Picture
    odds: Energies
    region: Mask


def cut_grid(pixels: Picture, odds: Energies, region: Mask, smoothness: float, coarse_pixels: int) -> Mask:
    """Label the region's pixels (h, w) so that data and smoothness cost least; False outside the region.

    Data cost: ``odds`` (h, w), the log odds of True. Smoothness cost: 4-neighbours with different labels cost
    ``smoothness / |I_x - I_y|`` for colours (h, w, 3), sRGB, 0 to 255. The whole is solved on a grid of at most
    ``coarse_pixels``; at each doubling of the resolution only a band along the border is solved again, so that time is
    bounded for every photo (a full cut of a noisy photo can take minutes).

    Source: Tan et al. 2008, section 2; the band is ours.
    """
    labels: Mask | None = None
    for level in _pyramid(_Level(pixels, odds, region), coarse_pixels):
        band = level.region
        if labels is not None:
            size = (band.shape[1], band.shape[0])
            labels = cv2.resize(labels.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST).astype(bool)
            band = level.region & _border_band(labels)
        labels = _cut(level, band, labels, smoothness)
    return np.zeros_like(region) if labels is None else labels


def _pyramid(finest: _Level, coarse_pixels: int) -> list[_Level]:
    """Halve the problem until its region has at most ``coarse_pixels``; coarsest first."""
    levels = [finest]
    while levels[0].region.sum() > coarse_pixels:
        finer = levels[0]
        size = (max(1, finer.region.shape[1] // 2), max(1, finer.region.shape[0] // 2))
        region = cv2.resize(finer.region.astype(np.float32), size, interpolation=cv2.INTER_AREA) >= 0.5
        pixels = np.asarray(cv2.resize(finer.pixels, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
        odds = np.asarray(cv2.resize(finer.odds, size, interpolation=cv2.INTER_AREA), dtype=np.float32)
        levels.insert(0, _Level(pixels, odds, region))
    return levels


def _border_band(labels: Mask) -> Mask:
    """Mark the pixels (h, w) within BAND_PX of a change of label."""
    kernel = np.ones((2 * BAND_PX + 1, 2 * BAND_PX + 1), np.uint8)
    grey = labels.astype(np.uint8)
    return np.asarray(cv2.dilate(grey, kernel) != cv2.erode(grey, kernel))


def _cut(level: _Level, band: Mask, known: Mask | None, smoothness: float) -> Mask:
    """Label (h, w) the band's pixels by a cut; other pixels keep their known label, False outside the region."""
    labels = level.region & known if known is not None else np.zeros_like(level.region)
    count = int(band.sum())
    if count == 0:
        return labels
    cells = np.flatnonzero(band)
    node = np.zeros(band.size, np.int64)
    node[cells] = np.arange(count)
    odds = level.odds.ravel()[cells].astype(np.float64)
    to_true, to_false = np.maximum(odds, 0), np.maximum(-odds, 0)
    colours, cut, outside = level.pixels.reshape(-1, 3), band.ravel(), (level.region & ~band).ravel()
    graph = maxflow.Graph[float](count, 2 * count)
    nodes = graph.add_nodes(count)
    for step, before, after in _steps(cells, band.shape):
        onward = np.flatnonzero(after)
        both = onward[cut[cells[onward] + step]]
        weight = _border_costs(colours, cells[both], cells[both] + step, smoothness)
        graph.add_edges(both, node[cells[both] + step], weight, weight)
        for inner, way in ((onward, step), (np.flatnonzero(before), -step)):
            rim = inner[outside[cells[inner] + way]]
            side = labels.ravel()[cells[rim] + way]
            cost = _border_costs(colours, cells[rim], cells[rim] + way, smoothness)
            to_true[rim[side]] += cost[side]
            to_false[rim[~side]] += cost[~side]
    graph.add_grid_tedges(nodes, to_true, to_false)
    graph.maxflow()
    labels.reshape(-1)[cells] = ~graph.get_grid_segments(nodes)
    return labels


def _steps(cells: Indices, shape: tuple[int, ...]) -> tuple[tuple[int, Indices, Indices], ...]:
    """Return the steps from cells (n,), flat, to the right and below, and how many lie before and after each so."""
    row, column = np.divmod(cells, shape[1])
    return (1, column, shape[1] - 1 - column), (shape[1], row, shape[0] - 1 - row)


def _border_costs(colours: Picture, these: Indices, following: Indices, smoothness: float) -> Floats:
    """Return the cost (n,) of different labels between neighbours, two times (n,) of colours (m, 3), sRGB."""
    difference = colours.take(these, axis=0).astype(np.float32) - colours.take(following, axis=0)
    step = np.sqrt(np.einsum("nc,nc->n", difference, difference))
    return np.asarray(smoothness / np.maximum(step, SOFTEST_STEP), dtype=np.float64)
