"""Leaves that one photo shows, as regions of alike colour, each about as large as a leaf.

Source: Tan et al. 2007, section 6.1: mean shift, regions merged and split by a leaf's size, colour clusters of which
the brightest are leaves, an ellipse for each region.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from treestroke.core.types import Floats, Indices, Mask, Picture

SPACE_PX, COLOUR = 7, 5
"""Radii of the mean shift, px and steps of 8-bit LUV (Tan et al. 2007: 6 to 8, and 3 to 7)."""
STEPS = 3
"""Most steps of the mean shift of a pixel: more move few."""
ALIKE = 1.0
"""Difference of the filtered colours, LUV, below which neighbours are of one region."""
SMALL, LARGE = 0.3, 2.0
"""Areas, in leaves, below which a region is merged with its neighbour, and above which it is split."""
MERGES = 6
"""Rounds of merging: in each a region that is too small joins its neighbour of the most alike colour."""
CLUSTERS, BRIGHTEST = 25, 10
"""Clusters of colour, and how many of them are leaves."""
ROUNDNESS = 0.5
"""Area of a leaf over that of a square as long as it."""
WAYS = ((0, 1), (1, 0), (1, 1), (1, -1))
"""Rows and columns to half of a pixel's eight neighbours."""


@dataclass(frozen=True, eq=False)
class LeafRegions:
    """Regions (n,) of a photo's foliage.

    Attributes
    ----------
    labels
        (h, w) region of each pixel, -1 beside the foliage.
    centres_px
        (n, 2) their middles, px.
    axes_px
        (n, 2) half axes of their ellipses, px, the longer first.
    angles_rad
        (n,) angle of the longer axis, from the picture's right downward.
    colours
        (n, 3) mean colours, LUV of 8 bits.
    clusters
        (n,) cluster of colour of each.
    leaves
        (n,) whether it is taken for a leaf.
    """

    labels: Indices
    centres_px: Floats
    axes_px: Floats
    angles_rad: Floats
    colours: Floats
    clusters: Indices
    leaves: Mask

    def __len__(self) -> int:
        return len(self.centres_px)


def leaf_regions(
    picture: Picture,
    foliage: Mask,
    leaf_px: float,
    accepted_px: Floats | None = None,
    refused_px: Floats | None = None,
) -> LeafRegions:
    """Divide a photo's foliage into regions as large as leaves, and tell which of them show leaves.

    Parameters
    ----------
    picture, foliage
        (h, w, 3) sRGB, and where it shows foliage.
    leaf_px
        A leaf's usual length, px.
    accepted_px, refused_px
        (k, 2) points, px, on leaves, and on what is none, as the user says: they take their cluster of colour with
        them. A refused point outdoes an accepted one.

    Raises
    ------
    ValueError
        No pixel is foliage, or the mask is not of the picture's size.
    """
    if foliage.shape != picture.shape[:2] or not foliage.any():
        raise ValueError(f"leaf regions need foliage in a mask of the picture's size, got {foliage.shape}")
    left, top, width, height = cv2.boundingRect(foliage.astype(np.uint8))
    box = np.s_[top : top + height, left : left + width]
    place = np.flatnonzero(foliage[box])
    luv = cv2.cvtColor(np.ascontiguousarray(picture[box]), cv2.COLOR_RGB2LUV)
    stop = (cv2.TERM_CRITERIA_MAX_ITER + cv2.TERM_CRITERIA_EPS, STEPS, 1.0)
    colours = cv2.pyrMeanShiftFiltering(luv, SPACE_PX, COLOUR, None, 0, stop).reshape(-1, 3)[place].astype(np.float64)
    pairs = _neighbours(foliage[box])
    alike = np.linalg.norm(colours[pairs[0]] - colours[pairs[1]], axis=1) < ALIKE
    area = ROUNDNESS * leaf_px**2
    region = _joined(len(place), pairs[:, alike])
    region = _merged(region, colours, pairs, SMALL * area)
    points: Floats = np.stack([place % width, place // width], axis=1).astype(np.float64) + 0.5
    region = _merged(_split(region, points, LARGE * area, leaf_px), colours, pairs, SMALL * area)
    labels = np.full(foliage.shape, -1, dtype=np.int64)
    labels[box][foliage[box]] = region
    return _described(labels, points + np.array([left, top]), region, colours, (accepted_px, refused_px))


def _neighbours(foliage: Mask) -> Indices:
    """Pairs (2, m) of neighbours, by their rank among the pixels of a foliage (h, w)."""
    rank = np.where(foliage, np.cumsum(foliage.ravel()).reshape(foliage.shape) - 1, -1)
    height, width = foliage.shape
    found = []
    for down, right in WAYS:
        left = max(0, -right)
        first = rank[: height - down, left : width - max(0, right)]
        second = rank[down:, left + right : width + min(0, right)]
        both = (first >= 0) & (second >= 0)
        found.append(np.stack([first[both], second[both]]))
    return np.concatenate(found, axis=1)


def _joined(count: int, pairs: Indices) -> Indices:
    """Return the numbers (n,) of the connected components of a graph of ``count`` nodes and edges (2, m)."""
    graph = sparse.coo_matrix((np.ones(pairs.shape[1], dtype=np.int8), (pairs[0], pairs[1])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _means(region: Indices, values: Floats) -> Floats:
    """Mean of the pixels' values (n, k) in each region."""
    counts = np.maximum(np.bincount(region), 1)
    return np.stack([np.bincount(region, column) / counts for column in values.T], axis=1)


def _merged(region: Indices, colours: Floats, pairs: Indices, least: float) -> Indices:
    """Merge regions (n,) of fewer pixels than ``least`` with the neighbour of the most alike colour."""
    for _ in range(MERGES):
        sizes, means = np.bincount(region), _means(region, colours)
        edges = region[pairs]
        edges = edges[:, edges[0] != edges[1]]
        edges = np.concatenate([edges, edges[::-1]], axis=1)
        edges = edges[:, sizes[edges[0]] < least]
        if edges.shape[1] == 0:
            break
        apart = np.linalg.norm(means[edges[0]] - means[edges[1]], axis=1)
        order = np.lexsort((apart, edges[0]))
        first = np.flatnonzero(np.diff(edges[0, order], prepend=-1))
        region = _joined(len(sizes), edges[:, order[first]])[region]
    return region


def _split(region: Indices, points: Floats, most: float, side: float) -> Indices:
    """Split regions of more pixels than ``most`` along their longer axis and across it, into parts ``side`` px long."""
    large = np.bincount(region) > most
    away = points - _means(region, points)[region]
    turn = _angles(_moments(region, away))[region]
    along = away[:, 0] * np.cos(turn) + away[:, 1] * np.sin(turn)
    across = away[:, 1] * np.cos(turn) - away[:, 0] * np.sin(turn)
    keys = region
    for parts in (np.round(along / side), np.round(across / (ROUNDNESS * side))):
        part = np.where(large[region], parts - parts.min(), 0).astype(np.int64)
        keys = np.unique(keys * (int(part.max()) + 1) + part, return_inverse=True)[1]
    return np.asarray(keys, dtype=np.int64)


def _moments(region: Indices, away: Floats) -> Floats:
    """Second moments xx, yy, xy (regions, 3) of pixels ``away`` (n, 2) from their region's middle."""
    x, y = away.T
    return _means(region, np.stack([x * x, y * y, x * y], axis=1))


def _angles(moments: Floats) -> Floats:
    """Angle (regions,) of the longer axis, rad."""
    return np.asarray(0.5 * np.arctan2(2 * moments[:, 2], moments[:, 0] - moments[:, 1]))


def _described(
    labels: Indices, points: Floats, region: Indices, colours: Floats, said: tuple[Floats | None, Floats | None]
) -> LeafRegions:
    """Fit ellipses to the regions (n,) of pixels, and choose those that are leaves."""
    centres, means = _means(region, points), _means(region, colours)
    moments = _moments(region, points - centres[region]) + np.array([1 / 12, 1 / 12, 0])
    middle, apart = (
        0.5 * (moments[:, 0] + moments[:, 1]),
        np.hypot(0.5 * (moments[:, 0] - moments[:, 1]), moments[:, 2]),
    )
    axes = 2 * np.sqrt(np.maximum(np.stack([middle + apart, middle - apart], axis=1), 0))
    clusters = _clusters(means, np.bincount(region))
    light = np.bincount(clusters, means[:, 0]) / np.maximum(np.bincount(clusters), 1)
    kept = np.zeros(len(light), dtype=np.bool_)
    kept[np.argsort(-light, kind="stable")[:BRIGHTEST]] = True
    for points_px, leaf in zip(said, (True, False), strict=True):
        if points_px is not None:
            kept[clusters[_regions_at(labels, points_px)]] = leaf
    return LeafRegions(labels, centres, axes, _angles(moments), means, clusters, kept[clusters])


def _clusters(colours: Floats, sizes: NDArray[np.int64]) -> Indices:
    """Cluster colours (n, 3), LUV, of regions of these sizes (n,), px, by k-means."""
    from sklearn.cluster import KMeans  # imported here: it takes a second

    distinct = np.unique(colours.round(1) @ np.array([1.0, 1e4, 1e8]))
    count = min(CLUSTERS, len(distinct))
    found = KMeans(count, n_init=1, random_state=0).fit(colours, sample_weight=sizes)
    return np.asarray(found.labels_, dtype=np.int64)


def _regions_at(labels: Indices, points_px: Floats) -> Indices:
    """Regions at points (k, 2), px; those beside the foliage have none."""
    height, width = labels.shape
    column, row = np.floor(points_px).astype(np.int64).T
    within = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    found = labels[row[within], column[within]]
    return np.asarray(found[found >= 0])
