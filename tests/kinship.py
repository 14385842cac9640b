"""How far two trees are apart by the features of their branching, for siblings and for other kinds."""

from itertools import combinations, product

import numpy as np
from tests.branching import QUANTILES, branching

from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats

UNITS = np.array([30.0, 0.25, 0.25])
"""Distances of angle (degrees), length ratio and radius ratio that count alike: about half of what trees differ by."""
ORDERS = (1, 2)
ROWS = 12
"""Levels of the tree at which its wood is measured."""


def features(tree: Skeleton) -> Floats:
    """Return a tree's features (k,): the mean distance of two trees' is in units of which 1 tells kinds apart.

    Quantiles of angle, length ratio and radius ratio of the limbs of orders 1 and 2, and of where wood is: heights, and
    distances from the axis, over the tree's height.
    """
    found, parts = branching(tree), []
    for order in ORDERS:
        here = np.array(found[1:])[:, found.order == order]
        parts += [np.quantile(row, QUANTILES) / unit for row, unit in zip(here, UNITS, strict=True)]
    height = float(np.ptp(tree.points[:, 1]))
    length = edge_lengths(tree)
    away = np.hypot(tree.points[:, 0], tree.points[:, 2]) / height
    for values in (tree.points[:, 1] / height, away):
        order = np.argsort(values)
        parts.append(np.interp(QUANTILES, np.cumsum(length[order]) / length.sum(), values[order]) / 0.2)
    return np.array(parts)


def apart(one: Floats, other: Floats) -> float:
    """Mean of the 1-Wasserstein distances of all features."""
    return float(np.abs(one - other).mean())


def within(trees: list[Floats]) -> Floats:
    """Return the distances of all pairs of a set."""
    return np.array([apart(a, b) for a, b in combinations(trees, 2)])


def between(trees: list[Floats], others: list[Floats]) -> Floats:
    """Return the distances of all pairs of two sets."""
    return np.array([apart(a, b) for a, b in product(trees, others)])
