"""A tree's limbs by what sways together: tracks are halved again and again by normalized cuts.

Source: Li et al. 2011, appendix A, after Diener et al. 2006; Shi and Malik 2000.
"""

import numpy as np
from numpy.typing import NDArray
from sklearn.cluster import SpectralClustering

from treestroke.core.film.tracks import Tracks
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats

LEVELS = 6
"""Greatest number of times that the tracks are halved."""
FEWEST = 16
"""Tracks that are not halved any more."""
FOLD = 0.4
"""Share of the way by which a node is drawn toward its parent (Li et al.)."""
_MOST = 500  # tracks that are compared with each other
_LASTING = 0.5  # share of the frames in which a track must be seen
_NEAR = 0.12  # over the tree's height, at which two tracks are half as alike
_ALIKE = 0.35  # by which the correlation of two tracks must fall for them to be half as alike


def sway_skeleton(tracks: Tracks, root_px: Floats, height_px: float) -> Skeleton | None:
    """Return the limbs of a tree, px, from its root (2,) to the groups of tracks that sway together.

    Joints are the middles of the groups, drawn toward their parents but for the last ones; radii follow from the number
    of tracks that a limb carries, 1 at the root. None where too few points are followed.
    """
    index = np.flatnonzero(tracks.seen.mean(axis=0) >= _LASTING)
    if len(index) < 2 * FEWEST:
        return None
    index = index[np.linspace(0, len(index) - 1, min(len(index), _MOST)).astype(int)]
    rest = tracks.rest[index]
    points, parents, counts = [np.asarray(root_px, dtype=np.float64)], [-1], [len(index)]
    last = [False]
    waiting = [(np.arange(len(index)), 0, 0)]
    alike = _alike(tracks, index, height_px)
    while waiting:
        members, parent, level = waiting.pop(0)
        points.append(rest[members].mean(axis=0))
        parents.append(parent)
        counts.append(len(members))
        ends = level == LEVELS or len(members) < 2 * FEWEST
        last.append(ends)
        if not ends:
            half = _halved(alike[np.ix_(members, members)])
            here = len(points) - 1
            waiting += [(members[half], here, level + 1), (members[~half], here, level + 1)]
    folded = _folded(np.array(points), np.array(parents), np.array(last))
    return Skeleton(folded, np.sqrt(np.array(counts) / len(index)), np.array(parents))


def _alike(tracks: Tracks, index: NDArray[np.intp], height_px: float) -> Floats:
    """Return how alike tracks are (k, k), 0 to 1: by their distance and by how they move."""
    moved = tracks.moved[:, index] - tracks.moved[:, index].mean(axis=0)
    flat = moved.transpose(1, 0, 2).reshape(len(index), -1)
    flat = flat / np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-9)
    rest = tracks.rest[index]
    away = np.linalg.norm(rest[:, None] - rest[None], axis=2) / (_NEAR * height_px)
    return np.asarray(np.exp2(-(away**2)) * np.exp2(-(1.0 - flat @ flat.T) / _ALIKE) + 1e-9)


def _halved(alike: Floats) -> NDArray[np.bool_]:
    """Return one half of a group (k,) by the normalized cut of how alike its members are (k, k)."""
    cut = SpectralClustering(2, affinity="precomputed", assign_labels="cluster_qr", random_state=0)
    half = cut.fit_predict(alike) == 0
    if half.all() or not half.any():
        half = np.arange(len(alike)) < len(alike) // 2
    return np.asarray(half)


def _folded(points: Floats, parents: NDArray[np.intp], last: NDArray[np.bool_]) -> Floats:
    """Draw each joint toward its parent, from the root to the tips, but for the last ones."""
    points = points.copy()
    for joint in range(1, len(points)):
        if not last[joint]:
            points[joint] += FOLD * (points[parents[joint]] - points[joint])
    return points
