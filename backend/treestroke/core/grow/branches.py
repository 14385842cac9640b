"""The visible tree as straight branches, which growth replaces, instead of the skeleton's dense joints."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from treestroke.core.geometry.polyline import arc_lengths
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children, limbs
from treestroke.core.types import Floats, Indices, Mask

TURN_DEG = 30.0
"""Turn that ends a branch, degrees (Tan et al. 2008, section 2)."""
TURN_REACH = 0.03
"""Distance ahead over which a turn is measured, relative to the longest chain: sharp bends of a stroke are noise."""


@dataclass(frozen=True, eq=False)
class Chain:
    """A piece of a visible limb: joint indices (m,) from its base to its tip, and the limb's order (1 on a stem)."""

    joints: Indices
    generation: int


def successors_by_wood(skeleton: Skeleton) -> Indices:
    """Return the index of the child that continues each joint's limb (n,), -1 at a tip; px or metres, y down.

    A limb follows the most wood (length times radius); each stem leads to its highest joint, so that a long low limb
    does not take the leader's place.
    """
    wood = edge_lengths(skeleton) * (skeleton.radii + 1e-3 * skeleton.radii.max())
    successors = heaviest_children(skeleton, accumulate_to_root(skeleton, wood))
    highest: dict[int, int] = {}
    root = np.arange(len(skeleton))
    for joint, parent in enumerate(skeleton.parents.tolist()):
        root[joint] = root[parent] if parent >= 0 else joint
        best = highest.setdefault(int(root[joint]), joint)
        if skeleton.points[joint, 1] < skeleton.points[best, 1]:
            highest[int(root[joint])] = joint
    for joint in highest.values():
        while skeleton.parents[joint] >= 0:
            successors[skeleton.parents[joint]] = joint
            joint = int(skeleton.parents[joint])
    return successors


def split_chains(skeleton: Skeleton, inside: Mask, longest: tuple[float, float]) -> list[Chain]:
    """Split a skeleton (any unit) where it forks, turns, enters the crown, or has gone on for long.

    ``inside`` (n,) is the mask of the joints in the crown; ``longest`` is the greatest length there of a stem's and of
    a limb's chain, in the skeleton's unit. A turn of 30 degrees ends a chain. No fork or turn makes a chain shorter
    than a tenth of ``longest``. Chains come parents first. Source: Tan et al. 2008, section 2 (simplification).
    """
    successors = successors_by_wood(skeleton)
    forks = np.bincount(skeleton.parents[skeleton.parents >= 0], minlength=len(skeleton)) > 1
    order: dict[int, int] = {}
    chains = []
    for limb in limbs(skeleton, successors):
        generation = order.get(int(limb[0]), 0) + 1
        for joint in limb.tolist():
            order.setdefault(joint, generation)
        cuts = _cuts(skeleton.points[limb], inside[limb], forks[limb], longest[min(generation, 2) - 1])
        chains += [Chain(limb[a : b + 1], generation) for a, b in pairwise(cuts)]
    return chains


def _cuts(points: Floats, inside: Mask, forks: Mask, longest: float) -> list[int]:
    """Return the ends of a limb's chains, as positions along its joints (m, 3)."""
    if len(points) < 2:
        return []
    arc = arc_lengths(points)
    cuts = [0]
    for i in range(1, len(points) - 1):
        crosses = inside[i] != inside[i - 1]
        ends = min(arc[i] - arc[cuts[-1]], arc[-1] - arc[i]) >= 0.1 * longest
        if crosses or (ends and (forks[i] or _turn(points, arc, cuts[-1], i, longest) >= TURN_DEG)):
            cuts.append(i)
    cuts.append(len(points) - 1)
    return _even(cuts, arc, inside, longest)


def _turn(points: Floats, arc: Floats, start: int, at: int, longest: float) -> float:
    """Return the angle, degrees, between the line from ``start`` to ``at`` and the line ahead of ``at``."""
    ahead = min(int(np.searchsorted(arc, arc[at] + TURN_REACH * longest)), len(arc) - 1)
    before, after = points[at] - points[start], points[max(ahead, at + 1)] - points[at]
    lengths = np.sqrt((before**2).sum() * (after**2).sum())
    return float(np.degrees(np.arccos(np.clip(before @ after / lengths, -1, 1)))) if lengths > 0 else 0.0


def _even(cuts: list[int], arc: Floats, inside: Mask, longest: float) -> list[int]:
    """Cut chains inside the crown that are too long into equal parts, at joints."""
    found = [0]
    for a, b in pairwise(cuts):
        parts = int(np.ceil((arc[b] - arc[a]) / longest)) if inside[(a + b) // 2] else 1
        aims = arc[a] + (arc[b] - arc[a]) * np.arange(1, parts) / max(parts, 1)
        found += [int(at) for at in np.searchsorted(arc, aims)] + [b]
    return sorted(set(found))
