"""The plain evaluator: growth's mathematics in component-wise numpy, every placement in every iteration.

It has only the cache of Tan et al. 2008 (section 3.2): each attractor keeps its distance, so only new shoots are
measured. `compiled` must choose the same sequence; the arithmetic that decides (placing, clipping, closeness) has the
same order of operations in both, so that the results agree to the last bit. It is used where the extension is not
built, and in tests as the reference.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from treestroke.core.grow.growth_space import GrowthSpace
from treestroke.core.grow.library import Subtree
from treestroke.core.grow.placements import TIE, Choice, Rules, Shoot, turn_library
from treestroke.core.types import Floats, Indices

BLOCK = 12_000
"""Point pairs measured at a time: their scratch arrays fit into the processor's first cache levels."""


class _Laid(NamedTuple):
    """All placements on one branch: base and step, px (s, a, k, 3), counts of samples and of kept samples (s, a, k)."""

    base: Floats
    step: Floats
    samples: Indices
    kept: Indices


def _dot(a: Floats, b: Floats) -> Floats:
    """Return the dot products of vectors (..., 3), in a fixed order of operations."""
    return (a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]) + a[..., 2] * b[..., 2]


def _cross(a: Floats, b: Floats) -> Floats:
    """Return the cross product of two vectors (3,), in a fixed order of operations."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _frame(chord: Floats) -> tuple[Floats, Floats, Floats, float]:
    """Return an orthonormal frame of a chord (3,): side, along, other side; and the chord's length."""
    length = float(np.sqrt(_dot(chord, chord)))
    along = chord / length
    across = _cross(along, np.array([1.0, 0, 0]) if abs(along[2]) > 0.9 else np.array([0, 0, 1.0]))
    side = across / np.sqrt(_dot(across, across))
    return side, along, _cross(along, side), length


def _steered(along: Floats, steering: Floats) -> Floats:
    """Turn shoots (..., 3) by a branch's steering (2,): the share of rise that is kept, and the rise that is added."""
    kept, added = steering.tolist()
    if kept == 1 and added == 0:
        return along
    length = np.sqrt(_dot(along, along))
    turned = np.stack([along[..., 0], along[..., 1] * kept - length * added, along[..., 2]], axis=-1)
    new = np.sqrt(_dot(turned, turned))
    factor = length / np.where(new > 0, new, 1.0)
    return np.where((new > 0)[..., None], turned * factor[..., None], along)


class PlainEvaluator:
    """An `Evaluator` that keeps each attractor's distance and nothing else."""

    def __init__(self, space: GrowthSpace, library: tuple[Subtree, ...], rules: Rules) -> None:
        self._space, self._rules = space, rules
        self._library = turn_library(library, rules.angles)
        self._bases = self._tips = np.zeros((0, 3))
        self._scales = np.zeros((0, len(library)))
        self._steering = np.zeros((0, 2))
        self._wood = np.zeros((0, 3))
        self._points = {False: np.zeros((0, 2)), True: np.zeros((0, 3))}
        self._distances = {False: np.zeros(0), True: np.zeros(0)}
        self.pairs = 0

    def add_branches(self, bases: Floats, tips: Floats, scales: Floats, steering: Floats) -> None:
        """Add branches, bases and tips (k, 3) px, factors (k, subtrees), steering (k, 2); see `Evaluator`."""
        self._bases, self._tips = np.vstack([self._bases, bases]), np.vstack([self._tips, tips])
        self._scales, self._steering = np.vstack([self._scales, scales]), np.vstack([self._steering, steering])
        chords = tips - bases
        samples = self._sample_counts(chords)
        new = [
            base + np.arange(1, n + 1)[:, None] * (chord / n)
            for base, chord, n in zip(bases, chords, samples.tolist(), strict=True)
        ]
        self._wood = np.vstack([self._wood, *new])
        for in_space, points in self._points.items():
            nearer = self._nearest(points, np.vstack(new)) if new else np.inf
            self._distances[in_space] = np.minimum(self._distances[in_space], nearer)

    def add_attractors(self, points: Floats) -> None:
        """Add attractors, px: those of the image (m, 2), or in space (m, 3)."""
        in_space = points.shape[1] == 3
        self._points[in_space] = np.vstack([self._points[in_space], points])
        distances = self._nearest(points, self._wood)
        self._distances[in_space] = np.concatenate([self._distances[in_space], distances])

    def best(self, candidates: Indices, in_space: bool) -> Choice:
        """Find the best placement on the candidates, branch indices (c,); see `Evaluator`."""
        gains = [self._gains(branch, in_space) for branch in sorted(candidates.tolist())]
        limit = max((float(gain.max()) for gain in gains), default=0.0) * (1 - TIE)
        for branch, gain in zip(sorted(candidates.tolist()), gains, strict=True):
            first = int(np.argmax((gain > 0) & (gain >= limit)))
            if gain.flat[first] > 0 and gain.flat[first] >= limit:
                subtree, angle = divmod(first, self._rules.angles)
                return Choice(branch, subtree, angle, float(gain.flat[first]))
        return Choice(-1, 0, 0, 0.0)

    def place(self, choice: Choice) -> list[Shoot]:
        """List the shoots that remain; see `Evaluator`."""
        laid, at = self._lay(choice.branch), (choice.subtree, choice.angle)
        kept = self._uncrowded(laid, at, self._surroundings(laid))
        remaining = np.flatnonzero(kept)
        order = {int(shoot): i for i, shoot in enumerate(remaining)}
        shoots = []
        for i in remaining.tolist():
            parent = int(self._library.parents[choice.subtree, i])
            fraction = float(self._library.fractions[choice.subtree, i])
            if parent >= 0:
                fraction = fraction * float(laid.samples[at][parent]) / float(kept[parent])
            base = laid.base[at][i]
            tip = base + float(kept[i]) * laid.step[at][i]
            shoots.append(Shoot(order.get(parent, -1), fraction, base, tip))
        return shoots

    def image_distances(self) -> Floats:
        """Return each image attractor's distance (m,), px, to the tree's projection."""
        return self._distances[False]

    def _sample_counts(self, along: Floats) -> Indices:
        """Return the number of samples of vectors (..., 3), px."""
        return np.clip(np.rint(np.sqrt(_dot(along, along)) / self._rules.spacing), 1, 60000).astype(np.int64)

    def _lay(self, branch: int) -> _Laid:
        """Place every subtree at every angle on a branch and clip the shoots at the crown's edge."""
        turned, base = self._library, self._bases[branch]
        chord = self._tips[branch] - base
        side, axis, other, length = _frame(chord)
        v = turned.vectors
        size = (length * self._scales[branch])[:, None, None, None]
        along = _steered(
            ((v[..., 0:1] * side + v[..., 1:2] * axis) + v[..., 2:3] * other) * size, self._steering[branch]
        )
        samples = self._sample_counts(along)
        bases, kept = np.zeros_like(along), np.zeros_like(samples)
        for s, k in zip(*np.nonzero(np.arange(v.shape[2]) < turned.counts[:, None]), strict=True):
            parent, fraction = int(turned.parents[s, k]), turned.fractions[s, k]
            if parent < 0:
                bases[s, :, k] = base + chord * fraction
            else:
                bases[s, :, k] = bases[s, :, parent] + along[s, :, parent] * fraction
            kept[s, :, k] = self._kept(bases[s, :, k], along[s, :, k], samples[s, :, k])
            if parent >= 0:
                torn = (kept[s, :, parent] == 0) | (fraction * samples[s, :, parent] > kept[s, :, parent])
                kept[s, torn, k] = 0
        kept[self._scales[branch] <= 0] = 0
        return _Laid(bases, along / samples[..., None], samples, kept)

    def _kept(self, base: Floats, along: Floats, samples: Indices) -> Indices:
        """Return the number of leading samples of shoots (a,) in the crown; 0 where inward or clipped too short."""
        count = np.arange(1, samples.max() + 1)
        points = base[:, None] + count[:, None] * (along / samples[:, None])[:, None]
        inside = self._space.inside(points) & (count <= samples[:, None])
        kept = np.where(inside.all(axis=1), len(count), np.argmin(inside, axis=1))
        out = (base + along * 0.5) - self._space.foot
        limit = self._rules.inward_cosine * (np.sqrt(_dot(along, along)) * np.sqrt(_dot(out, out)))
        return np.asarray(np.where((_dot(along, out) >= limit) & (kept >= self._rules.keep * samples), kept, 0))

    def _surroundings(self, laid: _Laid) -> Floats:
        """Return the tree's samples (q, 3) near the shoots of a branch."""
        ends = laid.base + laid.step * laid.kept[..., None]
        low = np.minimum(laid.base, ends)[laid.kept > 0].min(axis=0, initial=np.inf) - self._rules.closeness
        high = np.maximum(laid.base, ends)[laid.kept > 0].max(axis=0, initial=-np.inf) + self._rules.closeness
        return np.asfortranarray(self._wood[((self._wood >= low) & (self._wood <= high)).all(axis=1)])

    def _uncrowded(self, laid: _Laid, at: tuple[int, int], near: Floats) -> Indices:
        """Return the kept samples of a placement's shoots (k,): 0 if the outer half, or the parent's, is too close."""
        kept = laid.kept[at].copy()
        shoot, order, points = _samples(laid, at, kept)
        outer = 2 * order >= kept[shoot]
        kept[shoot[outer][self._crowded(points[outer], near)]] = 0
        for i in np.flatnonzero(kept).tolist():
            parent = int(self._library.parents[at[0], i])
            if parent >= 0 and kept[parent] == 0:
                kept[i] = 0
        return np.asarray(kept)

    def _crowded(self, points: Floats, near: Floats) -> NDArray[np.bool_]:
        """Return a mask of the points (q, 3) that are too close to one of the tree's samples."""
        if len(points) == 0 or len(near) == 0:
            return np.zeros(len(points), dtype=bool)
        limit = self._rules.closeness
        low, high = points.min(axis=0) - limit, points.max(axis=0) + limit
        within = np.logical_and.reduce([(c >= a) & (c <= b) for c, a, b in zip(near.T, low, high, strict=True)])
        columns = [column[within] for column in near.T]
        scratch = np.empty((2, len(points), len(columns[0])))
        return np.asarray((_squares(columns, points, scratch) < limit * limit).any(axis=1))

    def _gains(self, branch: int, in_space: bool) -> Floats:
        """Return the gain of every placement (s, a) on a branch, px."""
        laid = self._lay(branch)
        near = self._surroundings(laid)
        gains = np.zeros(laid.kept.shape[:2])
        for subtree, angle in np.argwhere(laid.kept.any(axis=2)).tolist():
            at = subtree, angle
            samples = _samples(laid, at, self._uncrowded(laid, at, near))[2]
            if len(samples):
                distances = self._nearest(self._points[in_space], samples)
                gains[at] = np.maximum(self._distances[in_space] - distances, 0).sum()
        return gains

    def _nearest(self, points: Floats, samples: Floats) -> Floats:
        """Return the distance of each point (m, 2 or 3) to the nearest of the samples (q, 3), px."""
        nearest = np.full(len(points), np.inf)
        step = max(BLOCK // max(len(points), 1), 1)
        self.pairs += len(points) * len(samples)
        columns = [np.ascontiguousarray(column) for column in points.T]
        scratch = np.empty((2, min(step, max(len(samples), 1)), len(points)))
        for start in range(0, len(samples), step):
            block = samples[start : start + step]
            np.minimum(nearest, _squares(columns, block, scratch[:, : len(block)]).min(axis=0), out=nearest)
        return np.asarray(np.sqrt(nearest))


def _samples(laid: _Laid, at: tuple[int, int], kept: Indices) -> tuple[Indices, Indices, Floats]:
    """Return a placement's kept samples: their shoots (q,), numbers on these from 1 (q,), and points (q, 3), px."""
    shoot = np.repeat(np.arange(len(kept)), kept)
    order = np.arange(1, len(shoot) + 1) - np.repeat(np.cumsum(kept) - kept, kept)
    return shoot, order, laid.base[at][shoot] + order[:, None] * laid.step[at][shoot]


def _squares(columns: list[Floats], samples: Floats, scratch: NDArray[np.float64]) -> Floats:
    """Return the squared distances (q, m) of points, given by columns (m,), to samples (q, 3), axis by axis."""
    total, part = scratch
    for axis, column in enumerate(columns):
        target = total if axis == 0 else part
        np.subtract(column, samples[:, axis, None], out=target)
        np.multiply(target, target, out=target)
        if axis:
            np.add(total, part, out=total)
    return np.asarray(total)
