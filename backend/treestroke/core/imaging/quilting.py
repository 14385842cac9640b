"""Seamlessly repeating textures from a small sample, by patches cut along their least visible seams."""

from dataclasses import dataclass

import cv2
import maxflow
import numpy as np
from numpy.typing import NDArray

from treestroke.core.types import Floats

_CANDIDATES = 24
"""Random patches that are compared for each place."""
_STEP = 3
"""Distance, px, of the pixels by which patches are compared."""
_FEATHER_PX = 4.0
"""Standard deviation of the blur of a cut, px."""
_UNCUTTABLE = 1e9
"""Capacity of a link that must not be cut."""


@dataclass(frozen=True)
class QuiltParams:
    """Sizes in px, rows first.

    Attributes
    ----------
    size
        Size of the texture.
    patch
        Size of a patch; the sample must be at least as large.
    overlap
        Least overlap of neighbouring patches; a patch must be more than twice as large.
    """

    size: tuple[int, int] = (512, 256)
    patch: tuple[int, int] = (176, 120)
    overlap: tuple[int, int] = (40, 32)

    def __post_init__(self) -> None:
        if any(p <= 2 * o or o < 2 or s < p for s, p, o in zip(self.size, self.patch, self.overlap, strict=True)):
            raise ValueError(f"a patch must exceed two overlaps and fit into the texture, got {self}")


@dataclass(frozen=True, eq=False)
class _Sample:
    """What patches are cut from: its channels (c, h, w), where it is clean (h, w), and the sum of their variances."""

    planes: Floats
    clean: NDArray[np.bool_]
    spread: float


def quilt(sample: Floats, clean: NDArray[np.bool_], params: QuiltParams, rng: np.random.Generator) -> Floats:
    """Fill a texture (*size, c), px, that repeats in both directions, with patches of a sample (h, w, c).

    Each patch is the best of some random ones: it fits the patches below it and has few pixels outside ``clean``
    (h, w). It is joined along a minimal cut. Opposite edges of the texture are treated as neighbours from the start.

    Raises
    ------
    ValueError
        The sample is smaller than a patch.

    Notes
    -----
    Kwatra et al., "Graphcut Textures", 2003, section 3 (cost: equation 1), here on a torus.
    """
    if sample.shape[0] < params.patch[0] or sample.shape[1] < params.patch[1]:
        raise ValueError(f"a sample {sample.shape[:2]} holds no patch {params.patch}")
    spread = float(sample[::_STEP, ::_STEP].var(axis=(0, 1)).sum())
    source = _Sample(np.ascontiguousarray(np.moveaxis(sample, 2, 0)), clean, spread)
    texture, filled = np.zeros((sample.shape[2], *params.size)), np.zeros(params.size, dtype=bool)
    rows, columns = (_starts(s, p, o) for s, p, o in zip(params.size, params.patch, params.overlap, strict=True))
    for row in rows:
        for column in columns:
            down = _around(row, params.patch[0], params.size[0])[:, None]
            across = _around(column, params.patch[1], params.size[1])
            old, known = texture[:, down, across], filled[down, across]
            patch = _best_patch(source, old, known, rng)
            new = _newer_side(_squared_distances(patch, old), known, params.overlap)
            share = _feathered(new, known)
            texture[:, down, across] = share * patch + (1.0 - share) * old
            filled[down, across] = True
    return np.ascontiguousarray(np.moveaxis(texture, 0, 2))


def _around(start: int, count: int, size: int) -> NDArray[np.int64]:
    """Return ``count`` indices (count,) from ``start`` on, modulo ``size``."""
    return (start + np.arange(count)) % size


def _starts(size: int, patch: int, overlap: int) -> list[int]:
    """Return evenly spaced starts of patches, px, around a circle of ``size`` px."""
    count = -(-size // (patch - overlap))
    return [size * i // count for i in range(count)]


def _best_patch(sample: _Sample, old: Floats, filled: NDArray[np.bool_], rng: np.random.Generator) -> Floats:
    """Choose among random patches (c, h, w) the one that differs least from the old texture, where that is filled."""
    h, w = filled.shape
    row = rng.integers(0, sample.clean.shape[0] - h + 1, _CANDIDATES)
    column = rng.integers(0, sample.clean.shape[1] - w + 1, _CANDIDATES)
    old, known = np.ascontiguousarray(old[:, ::_STEP, ::_STEP]), filled[::_STEP, ::_STEP]
    costs = []
    for y, x in zip(row.tolist(), column.tolist(), strict=True):
        compared = slice(y, y + h, _STEP), slice(x, x + w, _STEP)
        misfit = 0.0
        if known.any():
            misfit = float(_squared_distances(sample.planes[:, *compared], old)[known].mean())
        costs.append(misfit + 4.0 * sample.spread * float(1.0 - sample.clean[compared].mean()))
    best = int(np.argmin(costs))
    y, x = int(row[best]), int(column[best])
    return sample.planes[:, y : y + h, x : x + w]


def _squared_distances(first: Floats, second: Floats) -> Floats:
    """Return the squared distance (h, w) of values (c, h, w)."""
    return np.asarray(sum((first - second) ** 2))


def _feathered(new: NDArray[np.bool_], filled: NDArray[np.bool_]) -> Floats:
    """Soften a cut over a few pixels: opacity (h, w), 0 to 1, of the new patch, for patches that do not match well."""
    blurred = cv2.GaussianBlur(new.astype(np.float64), (0, 0), _FEATHER_PX, borderType=cv2.BORDER_REPLICATE)
    share = np.clip((blurred - 0.2) / 0.6, 0.0, 1.0)
    return np.where(filled, share * _ramp_from_rim(new.shape), 1.0)


def _ramp_from_rim(shape: tuple[int, ...]) -> Floats:
    """Return a ramp (h, w) from 0 on a patch's rim to 1 a few pixels inside."""
    y, x = (np.minimum(np.arange(n), np.arange(n)[::-1]) for n in shape)
    return np.minimum(np.minimum(y[:, None], x[None, :]) / (3.0 * _FEATHER_PX), 1.0)


def _newer_side(difference: Floats, filled: NDArray[np.bool_], overlap: tuple[int, int]) -> NDArray[np.bool_]:
    """Cut between an old and a new patch: mask (h, w) of where the new one shows.

    Only where both may show, in the filled overlap, is there something to cut.
    """
    rim = np.ones_like(filled)
    rim[1:-1, 1:-1] = False
    free = filled.copy()
    free[overlap[0] : -overlap[0], overlap[1] : -overlap[1]] = False
    if not free.any():
        return ~free
    node, count = np.cumsum(free).reshape(free.shape) - 1, np.count_nonzero(free)
    to_old, to_new = np.where(rim[free], _UNCUTTABLE, 0.0), np.zeros(count)
    graph = maxflow.Graph[float](count, 2 * count)
    nodes = graph.add_nodes(count)
    every, ahead, behind = slice(None), slice(1, None), slice(None, -1)
    for this, following in (((every, behind), (every, ahead)), ((behind, every), (ahead, every))):
        weight = difference[this] + difference[following] + 1e-9
        inner = free[this] & free[following]
        graph.add_edges(node[this][inner], node[following][inner], weight[inner], weight[inner])
        for near, far in ((this, following), (following, this)):
            edge = free[near] & ~free[far]
            to_new[node[near][edge]] += weight[edge]
    graph.add_grid_tedges(nodes, to_old, to_new)
    graph.maxflow()
    newer = ~free
    newer[free] = graph.get_grid_segments(nodes)
    return newer
