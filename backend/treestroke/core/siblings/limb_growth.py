"""Grows the limbs of a sibling, root to tips, in a crown: bifurcations drawn from what was learnt of an example.

Source: Li et al. 2011, section 5.3. There a tree grows in the plane and is lifted afterwards; ours grows in space, by
the same two terms: limbs fill the crown, and leave as steeply as those of the example.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.geometry.polyline import arc_lengths, resample
from treestroke.core.geometry.vectors import unit
from treestroke.core.siblings.bifurcations import AROUND, SHORTEST
from treestroke.core.siblings.branching_model import (
    MOST_RATIO,
    BranchingModel,
    LimbShape,
    OrderModel,
    PartModel,
    limb_frame,
    nearest_shapes,
)
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

SPACING = 0.015
"""Distance between joints, as a share of the tree's height."""
ATTRACTORS = 900
"""About how many places of the crown attract limbs."""
OUTER = 0.35
"""How far out in its section, as a share of the way, such a place is: what is inside is filled on the way."""
TURNS = 16
"""Directions about its parent that are tried for each limb."""
SIMILAR = 6
"""Limbs of the example, the most alike, of which one gives its shape."""
SHORTER = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4)
"""Shares of its drawn length at which it is tried whether a limb stays in the crown."""
ENDS_OUT = 0.35
"""Share of a limb, from its base, that may lie outside the crown: limbs leave a stem below it."""
SAMPLES = 6
"""Places on a limb that are compared with the attractors."""
STRAIGHTENED = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Shares of the way to a straight line by which a stem is drawn to it, as far as it takes to stay in the crown."""
INSIDE, BESIDE, ENTRY = 0.95, 0.03, 0.12
"""How far out in the crown a stem may stand; how far from its axis, as a share of the tree's height, where the crown is
narrow; and the share of the crown's height, from below, in which it may stand anywhere."""
REDRAWN = 3
"""Bifurcations that are drawn in one's place before it is given up, where the crown has no room for it."""
LEAST = 1.1
"""Least length of a limb that is drawn, over that of the shortest that is learnt."""
MOST_LIMBS = 1500
"""Most limbs of a sibling."""


@dataclass(frozen=True, eq=False)
class _Grown:
    """A limb of the sibling: its joints' numbers, points (m, 3) and radii (m,), from the fork on."""

    joints: Indices
    points: Floats
    radii: Floats


@dataclass(frozen=True, eq=False)
class _Draw:
    """A limb that was drawn: where it leaves which limb, at which angle to it, how long it is, and its part's model."""

    parent: _Grown
    at: int
    angle_rad: float
    length: float
    part: PartModel


def grow_limbs(model: BranchingModel, crown: CrownVolume, height: float, rng: np.random.Generator) -> Skeleton:
    """Grow stems and limbs of a ``height``, metres, in a crown: a 3D skeleton, metres, with radii.

    Limbs stay within the crown's sections and silhouettes, except near their bases.

    Source: Li et al. 2011, section 5.3.
    """
    growth = _Growth(model, crown, height, rng)
    limbs = growth.stems()
    for order in model.orders:
        limbs = growth.limbs_on(limbs, order)
    return growth.skeleton()


class _Growth:
    """The sibling while it grows."""

    def __init__(self, model: BranchingModel, crown: CrownVolume, height: float, rng: np.random.Generator) -> None:
        self.model, self.crown, self.height, self.rng = model, crown, height, rng
        self.scale = height / model.height
        self.points, self.radii, self.parents = list[Floats](), list[Floats](), list[Indices]()
        self.count = self.grown = 0
        self.attractors = _attractors(crown)
        self.away = np.full(len(self.attractors), np.inf)

    def stems(self) -> list[_Grown]:
        """Set the stems: those of the example, turned about the vertical and perhaps mirrored."""
        turn, mirror = self.rng.uniform(0, 2 * np.pi), float(self.rng.choice((-1.0, 1.0)))
        cos, sin = np.cos(turn), np.sin(turn)
        turned = np.array([[cos, 0.0, sin * mirror], [0.0, 1.0, 0.0], [-sin, 0.0, cos * mirror]])
        found = []
        for stem in self.model.stems:
            points = self._within(self.scale * stem.points @ turned.T)
            radii = self.scale * np.interp(arc_lengths(points), self.scale * arc_lengths(stem.points), stem.radii)
            found.append(self._add(points, radii, -1))
        return found

    def limbs_on(self, parents: list[_Grown], order: OrderModel) -> list[_Grown]:
        """Grow the limbs of an order on all limbs of the order before, in an order of chance."""
        bearing = [parent for parent in parents for _ in range(self._number_on(parent, order))]
        found = []
        for index in self.rng.permutation(len(bearing)).tolist():
            for _ in range(REDRAWN):
                if self.grown < MOST_LIMBS and (limb := self._grow(self._drawn(bearing[index], order), order)):
                    found.append(limb)
                    break
        return found

    def skeleton(self) -> Skeleton:
        """Return what has grown."""
        return Skeleton(np.vstack(self.points), np.concatenate(self.radii), np.concatenate(self.parents))

    def _within(self, points: Floats) -> Floats:
        """Draw a stem (m, 3) toward the line from its foot to the crown's top, and cut it, so that it stays inside."""
        top = self.crown.axis(self.crown.bounds[1:, 1])[0]
        up = (points[:, 1] - points[0, 1]) / max(float(top[1] - points[0, 1]), 1e-9)
        line = points[0] + np.clip(up, 0, 1)[:, None] * (top - points[0])
        line[:, 1] = points[:, 1]
        best, reached, score = points, 0, 0
        for share in STRAIGHTENED:
            tried = points + share * (line - points)
            inside = self._admits_stem(tried)
            end = int(np.flatnonzero(inside)[-1]) + 1
            if end + inside[:end].sum() > score:
                best, reached, score = tried, end, end + int(inside[:end].sum())
        return resample(best[: max(reached, 2)], SPACING * self.height)

    def _admits_stem(self, points: Floats) -> Mask:
        """Tell which points (n, 3) of a stem are below the crown, in it, or near enough to its axis below its top."""
        aside = np.linalg.norm((points - self.crown.axis(points[:, 1]))[:, [0, 2]], axis=1)
        low, high = self.crown.bounds[:, 1]
        near = (aside <= BESIDE * self.height) & (points[:, 1] <= high)
        foot = points[:, 1] <= low + ENTRY * (high - low)
        return np.asarray(foot | near & self.crown.shown(points) | (self.crown.reach(points) <= INSIDE))

    def _number_on(self, parent: _Grown, order: OrderModel) -> int:
        """Return how many limbs leave a limb: as many as its length bears in the example."""
        arc = float(arc_lengths(parent.points)[-1])
        return int(order.per_metre / self.scale * arc + self.rng.random()) if len(parent.points) > 2 else 0

    def _drawn(self, parent: _Grown, order: OrderModel) -> _Draw:
        """Draw a bifurcation on a limb."""
        arc = arc_lengths(parent.points)
        share = np.array([part.share for part in order.parts])
        part = order.parts[int(self.rng.choice(len(share), p=share / share.sum()))]
        angle = np.pi - order.angle_sum_rad * float(order.angles.sample(1, self.rng)[0, 2])
        up_to, rest, own = part.lengths.sample(1, self.rng)[0].tolist()
        whole = max(up_to + rest, 1e-9)
        at = int(np.clip(np.searchsorted(arc, up_to / whole * arc[-1]), 1, len(arc) - 2))
        length = min(own / whole, order.longest) * float(arc[-1])
        return _Draw(parent, at, angle, max(length, LEAST * SHORTEST * self.height), part)

    def _grow(self, draw: _Draw, order: OrderModel) -> _Grown | None:
        """Grow a limb in the direction of the highest posterior; None where the crown has no room for it."""
        ahead = self._directions(draw)
        near = nearest_shapes(order.shapes, draw.part.rise, draw.length / self.scale)[:SIMILAR]
        shape = order.shapes[int(near[self.rng.integers(len(near))])]
        side = np.array([1.0, 1.0, float(self.rng.choice((-1.0, 1.0)))])
        start = draw.parent.points[draw.at]
        curves = draw.length * np.stack([(shape.points * side) @ limb_frame(way) for way in ahead])
        kept = self._kept(start, curves)
        natural = np.exp(-((ahead[:, 1] - draw.part.rise) ** 2) / (2 * order.rise_spread**2))
        samples = _places(shape.points, SAMPLES)
        ends = start + kept[:, None, None] * curves[:, samples]
        gains = np.maximum(self.away - self._away(ends.reshape(-1, 3)).reshape(len(ends), SAMPLES, -1).min(axis=1), 0)
        filling = gains.sum(axis=1)
        filling = filling / filling.sum() if filling.sum() > 0 else np.ones(len(ends)) / len(ends)
        posterior = filling * natural * kept**2
        best = int(posterior.argmax())
        if posterior[best] <= 0 or kept[best] * draw.length < SHORTEST * self.height:
            return None
        return self._add_limb(draw, order, shape, start + kept[best] * curves[best])

    def _directions(self, draw: _Draw) -> Floats:
        """Return directions (k, 3), evenly about the parent, at the drawn angle to it."""
        parent = draw.parent
        arc = arc_lengths(parent.points)
        before = int(np.abs(arc[: draw.at + 1] - (arc[draw.at] - AROUND * self.height)).argmin())
        ahead = unit(parent.points[draw.at] - parent.points[min(before, draw.at - 1)])
        axes = limb_frame(ahead)
        turn = (np.arange(TURNS) + self.rng.random()) / TURNS * 2 * np.pi
        across = np.outer(np.cos(turn), axes[1]) + np.outer(np.sin(turn), axes[2])
        return np.asarray(np.cos(draw.angle_rad) * ahead + np.sin(draw.angle_rad) * across)

    def _kept(self, start: Floats, curves: Floats) -> Floats:
        """Return the share (k,) of each curve's (k, m, 3) size at which it stays in the crown; 0 where none does."""
        outer = curves[:, _places(curves[0], SAMPLES)][:, int(ENDS_OUT * SAMPLES) :]
        kept = np.zeros(len(curves))
        for share in reversed(SHORTER):
            places = (start + share * outer).reshape(-1, 3)
            inside = (self.crown.reach(places) <= 1) & self.crown.shown(places)
            kept[inside.reshape(len(curves), -1).all(axis=1)] = share
        return kept

    def _away(self, points: Floats) -> Floats:
        """Distances (n, attractors) of points (n, 3), metres, from the attractors."""
        squares = np.zeros((len(points), len(self.attractors)))
        for axis in range(3):
            squares += (points[:, axis, None] - self.attractors[:, axis]) ** 2
        return np.sqrt(squares)

    def _add_limb(self, draw: _Draw, order: OrderModel, shape: LimbShape, curve: Floats) -> _Grown:
        mean, spread = order.radius_ratio
        ratio = min(float(np.exp(self.rng.normal(mean, spread))), MOST_RATIO)
        points = resample(curve, SPACING * self.height)
        along = np.linspace(0, 1, len(points))
        taper = np.interp(along, arc_lengths(shape.points) / arc_lengths(shape.points)[-1], shape.radii)
        base = float(draw.parent.radii[draw.at])
        radii = ratio * base * np.minimum(taper, 1.0)
        self.grown += 1
        limb = self._add(points[1:], radii[1:], int(draw.parent.joints[draw.at]))
        joints = np.concatenate([draw.parent.joints[draw.at, None], limb.joints])
        return _Grown(joints, points, radii)

    def _add(self, points: Floats, radii: Floats, parent: int) -> _Grown:
        """Add joints (m, 3) that hang one on the other, the first on ``parent``, -1 for a root."""
        joints = np.arange(self.count, self.count + len(points))
        self.points.append(points)
        self.radii.append(np.minimum.accumulate(radii))
        self.parents.append(np.concatenate([[parent], joints[:-1]]))
        self.count += len(points)
        if len(self.attractors):
            self.away = np.minimum(self.away, self._away(points).min(axis=0))
        return _Grown(joints, points, radii)


def _places(curve: Floats, count: int) -> Indices:
    """Return the indices (count,) of joints spread evenly over a curve (m, 3)."""
    arc = arc_lengths(curve)
    at = np.searchsorted(arc, (np.arange(count) + 1) / count * arc[-1] - 1e-9)
    return np.asarray(np.minimum(at, len(arc) - 1), dtype=np.int64)


def _attractors(crown: CrownVolume) -> Floats:
    """Spread places (m, 3), metres, evenly over the outer part of a crown."""
    low, high = crown.bounds
    step = max(float(np.cbrt(np.prod(high - low) / ATTRACTORS / 2)), 1e-6)
    axes = (np.arange(start + step / 2, end, step) for start, end in zip(low, high, strict=True))
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return places[crown.inside(places) & (crown.reach(places) >= OUTER)]
