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
_RIGHT = np.array([[0, 0, 0], [0, 0, 1], [0, 0, 0]])
_DOWN = np.array([[0, 0, 0], [0, 0, 0], [0, 1, 0]])
"""Links of a pixel to its neighbours, as PyMaxflow takes them."""


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
    texture = np.zeros((*params.size, sample.shape[2]))
    filled = np.zeros(params.size, dtype=bool)
    rows, columns = (_starts(s, p, o) for s, p, o in zip(params.size, params.patch, params.overlap, strict=True))
    for row in rows:
        for column in columns:
            place = np.ix_(
                _around(row, params.patch[0], params.size[0]), _around(column, params.patch[1], params.size[1])
            )
            old, known = texture[place], filled[place]
            patch = _best_patch(sample, clean, old, known, rng)
            new = _newer_side(_squared_distances(patch, old), known, params.overlap)
            share = _feathered(new, known)[..., None]
            texture[place] = share * patch + (1.0 - share) * old
            filled[place] = True
    return texture


def _around(start: int, count: int, size: int) -> NDArray[np.int64]:
    """Return ``count`` indices (count,) from ``start`` on, modulo ``size``."""
    return (start + np.arange(count)) % size


def _starts(size: int, patch: int, overlap: int) -> list[int]:
    """Return evenly spaced starts of patches, px, around a circle of ``size`` px."""
    count = -(-size // (patch - overlap))
    return [size * i // count for i in range(count)]


def _best_patch(
    sample: Floats, clean: NDArray[np.bool_], old: Floats, filled: NDArray[np.bool_], rng: np.random.Generator
) -> Floats:
    """Choose among random patches (h, w, c) the one that differs least from the old texture, where that is filled."""
    h, w = filled.shape
    row = rng.integers(0, sample.shape[0] - h + 1, _CANDIDATES)
    column = rng.integers(0, sample.shape[1] - w + 1, _CANDIDATES)
    spread = float(sample[::_STEP, ::_STEP].var(axis=(0, 1)).sum())
    compared = (slice(None, None, _STEP), slice(None, None, _STEP))
    old, known = old[compared], filled[compared]
    costs = []
    for y, x in zip(row.tolist(), column.tolist(), strict=True):
        difference = _squared_distances(sample[y : y + h, x : x + w][compared], old)
        misfit = float(difference[known].mean()) if known.any() else 0.0
        costs.append(misfit + 4.0 * spread * float(1.0 - clean[y : y + h, x : x + w][compared].mean()))
    best = int(np.argmin(costs))
    y, x = int(row[best]), int(column[best])
    return sample[y : y + h, x : x + w]


def _squared_distances(first: Floats, second: Floats) -> Floats:
    """Return the squared distance (h, w) of values (h, w, c), channel by channel: numpy sums short axes slowly."""
    return np.asarray(sum(np.moveaxis(first - second, 2, 0) ** 2))


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
    """Cut between an old and a new patch: mask (h, w) of where the new one shows."""
    rim = np.ones_like(filled)
    rim[1:-1, 1:-1] = False
    core = np.zeros_like(filled)
    core[overlap[0] : -overlap[0], overlap[1] : -overlap[1]] = True
    graph = maxflow.Graph[float](filled.size, 2 * filled.size)
    nodes = graph.add_grid_nodes(filled.shape)
    for structure, shift in ((_RIGHT, (0, -1)), (_DOWN, (-1, 0))):
        weight = difference + np.roll(difference, shift, axis=(0, 1)) + 1e-9
        graph.add_grid_edges(nodes, weight, structure, symmetric=True)
    graph.add_grid_tedges(nodes, np.where(rim & filled, _UNCUTTABLE, 0.0), np.where(core | ~filled, _UNCUTTABLE, 0.0))
    graph.maxflow()
    newer: NDArray[np.bool_] = graph.get_grid_segments(nodes)
    return newer
