"""Bark for a tree that is seen small: fewer, coarser tubes that hide about as much."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.mesh import Hold, Mesh
from treestroke.core.mesh.chains import Chains, chains_of, missed_without, subset, thinned
from treestroke.core.mesh.stations import stations_of
from treestroke.core.mesh.tube_surface import Grid
from treestroke.core.mesh.tubes import THINNEST, TubeParams, wrapping
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children
from treestroke.core.types import Floats, Indices

LEAST_TRIANGLES = 100
"""A single stem takes about that many."""
_TRIES = 4
"""Times that the number of rings is corrected for what flares add and what stands too close."""
_FINE_SIDES = 5
"""Sides of a tube whose mean breadth those of fewer sides are given."""
_LEAST_RADIUS = 1e-9
"""Metres: wood without a radius hides something yet."""
_FINEST_PX, _BLUNT_PX = 0.05, 1.0
"""How far axes may miss their joints before rings are chosen, and from which radius on tips are round."""
_ENOUGH_PX = 0.05
"""Miss, by the same weight, of rings without which sides do not matter."""
_ROUNDNESS, _MOST_SIDES = (6.0, 4.0, 2.5, 1.2), 12
"""Sides beyond 2 of a tube of 1 px radius, from fine to coarse, growing with the radius' root."""
_FLARE = 0.5
"""How much a root flare widens a stem, about: what its rings are worth."""
_FAINT = 0.05
"""Least weight of a miss of the axis, in px of the wood's radius, up to half a px."""


@dataclass(frozen=True)
class CoarseParams:
    """How bark is made coarser.

    Attributes
    ----------
    max_triangles
        Most triangles, `LEAST_TRIANGLES` at least.
    height_px
        How tall the tree is seen, px.
    limb_triangles
        Triangles that a limb is worth on average: where there are fewer for each, the least limbs go.
    most_thickened
        Most that a limb is thickened for those that went.
    """

    max_triangles: int
    height_px: int
    limb_triangles: float = 14.0
    most_thickened: float = 1.3

    def __post_init__(self) -> None:
        if self.max_triangles < LEAST_TRIANGLES or self.height_px < 1:
            raise ValueError(f"coarse bark needs {LEAST_TRIANGLES} triangles and a height, got {self}")
        if self.limb_triangles <= 0 or self.most_thickened < 1:
            raise ValueError(f"a limb is worth some triangles and never thinned, got {self}")


def coarse_tubes(skeleton: Skeleton, params: CoarseParams) -> Mesh:
    """Wrap a 3D skeleton in bark of few triangles, much as `tubes` does, but without collars and round tips.

    Limbs that hide least (length by thickness, with all that they bear) go; those that are about as thin are
    thickened for them, so that the tree hides as much in all. Vertices hold to joints of the whole skeleton.

    Raises
    ------
    ValueError
        The skeleton is not 3D or has no length.
    """
    if skeleton.points.shape[1] != 3:
        raise ValueError(f"tubes need a 3D skeleton, got {skeleton.points.shape[1]} coordinates")
    limb = _limbs(skeleton)
    hidden = 2.0 * edge_lengths(skeleton) * np.maximum(skeleton.radii, _LEAST_RADIUS)
    area = np.bincount(limb, hidden).astype(np.float64)
    order = np.argsort(-_with_borne(skeleton, limb, area), kind="stable")
    # A stem whose joints all stand on its root bears what has length.
    least = int((area[order] > 0).argmax()) + 1
    count = min(len(order), max(least, int(params.max_triangles / params.limb_triangles)))
    while True:
        kept = np.zeros(len(area), dtype=bool)
        kept[order[:count]] = True
        left, joints = _left(skeleton, limb, area, kept, params.most_thickened)
        mesh = _fitted(left, params, count == least)
        if mesh is not None and mesh.hold is not None:
            return replace(mesh, hold=Hold(joints[mesh.hold.joints], mesh.hold.share))
        count = max(least, count * 3 // 4)


def _fitted(skeleton: Skeleton, params: CoarseParams, whatever: bool) -> Mesh | None:
    """Wrap a skeleton as exactly as the triangles suffice for; None where they do not, unless ``whatever`` is asked."""
    height = max(float(np.ptp(skeleton.points, axis=0).max()), 1e-6)
    pixel = height / params.height_px
    chains = chains_of(skeleton, THINNEST * height)
    needed = subset(chains, thinned(chains, np.full(len(chains.limb), _FINEST_PX * pixel)))
    rings = stations_of(needed, 1.0, _BLUNT_PX * pixel, np.inf)
    shape = rings.radii * (1.0 + _FLARE * rings.swell)
    missed = missed_without(rings.points, shape, rings.limb) * np.clip(rings.radii / pixel, _FAINT, 0.5)
    # A stem's first ring closes it: the second is its foot.
    missed[rings.first + (rings.radii[rings.first] == 0)] = np.inf
    sides = _sides(chains, pixel, rings.limb[missed > _ENOUGH_PX * pixel], params.max_triangles)
    rings = replace(rings, radii=rings.radii * (_breadth(np.maximum(sides, _FINE_SIDES)) / _breadth(sides))[rings.limb])
    ends, inner = np.flatnonzero(np.isinf(missed)), np.flatnonzero(np.isfinite(missed))
    order = inner[np.argsort(-missed[inner], kind="stable")]
    cost = np.cumsum(2 * sides[rings.limb[order]])
    allowed, best = params.max_triangles, None
    for _ in range(_TRIES):
        left = rings.select(np.union1d(order[: int(np.searchsorted(cost, allowed, side="right"))], ends))
        grid = Grid.of(left, sides)
        spare = params.max_triangles - len(grid.triangles)
        if spare >= 0 and (best is None or len(grid.triangles) > len(best[1].triangles)):
            best = left, grid
        allowed += spare
    if best is None and whatever:
        best = left, grid
    return None if best is None else wrapping(best[1], best[0], chains, TubeParams())


def _breadth(sides: Indices) -> Floats:
    """Mean breadth of a prism (k,) with so many sides, over that of the cylinder around it."""
    return np.asarray(sides * np.sin(np.pi / sides) / np.pi)


def _sides(chains: Chains, pixel: float, rings: Indices, most: int) -> Indices:
    """Choose the number of sides (k,) of each limb's tube: as round as the triangles allow for rings on limbs (r,)."""
    thick = np.maximum.reduceat(chains.radii, chains.first) / pixel
    for roundness in _ROUNDNESS:
        sides = np.clip(np.floor(2.0 + roundness * np.sqrt(thick)), 3, _MOST_SIDES).astype(np.int64)
        if 2 * int(sides[rings].sum()) <= most:
            break
    return sides


def _left(
    skeleton: Skeleton, limb: Indices, area: Floats, kept: NDArray[np.bool_], most: float
) -> tuple[Skeleton, Indices]:
    """Take the limbs kept, thickened: the skeleton that is left, and its joints in the whole one."""
    joints = np.flatnonzero(kept[limb])
    index = np.cumsum(kept[limb]) - 1
    parents = skeleton.parents[joints]
    radii = _thickened(skeleton, limb, area, kept, most)[joints]
    return Skeleton(skeleton.points[joints], radii, np.where(parents < 0, -1, index[parents])), joints


def _limbs(skeleton: Skeleton) -> Indices:
    """Give the number of each joint's limb (n,), a limb after the one that bears it."""
    successors = heaviest_children(skeleton, skeleton.radii)
    parents = skeleton.parents
    starts = (parents < 0) | (successors[np.maximum(parents, 0)] != np.arange(len(skeleton)))
    limb = np.cumsum(starts) - 1
    for joint in np.flatnonzero(~starts).tolist():
        limb[joint] = limb[parents[joint]]
    return limb.astype(np.int64)


def _with_borne(skeleton: Skeleton, limb: Indices, area: Floats) -> Floats:
    """Count a limb (k,) for no less than the greatest that it bears, near or far."""
    worth = area.copy()
    parent = skeleton.parents
    first = np.flatnonzero((parent >= 0) & (limb[np.maximum(parent, 0)] != limb))
    for start in first[::-1].tolist():
        bearer = limb[parent[start]]
        worth[bearer] = max(worth[bearer], worth[limb[start]])
    return worth


def _thickened(skeleton: Skeleton, limb: Indices, area: Floats, kept: NDArray[np.bool_], most: float) -> Floats:
    """Give radii (n,) at which thin limbs hide what those that went have hidden.

    All wood up to a radius is thickened by one factor, and what is thicker at least to that.
    """
    if kept.all():
        return skeleton.radii
    girth = np.zeros(len(area))
    np.maximum.at(girth, limb, skeleton.radii)
    thin = skeleton.radii <= 2.0 * np.quantile(girth[~kept], 0.9)
    own = float((2.0 * edge_lengths(skeleton) * skeleton.radii)[kept[limb] & thin].sum())
    factor = 1.0 + float(area[~kept].sum()) / own if own > 0 else 1.0
    grown = skeleton.radii * min(factor, most)
    return np.where(thin, grown, np.maximum(skeleton.radii, grown[thin].max(initial=0.0)))
