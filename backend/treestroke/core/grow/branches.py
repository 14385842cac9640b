"""Branches: the straight pieces that growth sees instead of the skeleton's dense joints."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Floats
from treestroke.core.skeleton.measure import edge_lengths, path_lengths
from treestroke.core.skeleton.skeleton import Indices, Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children, limbs

TURN_DEG = 30.0
STRAIGHT_SHARE = 0.03
"""Of the longest chain's limit: how far ahead a turn is measured, as the sharpest bends of a traced stroke are noise."""


@dataclass(frozen=True, eq=False)
class Chain:
    """A piece of a visible limb: joints from its base to its tip, and the limb's order (1 on a stem)."""

    joints: Indices
    generation: int


def successors_by_length(skeleton: Skeleton) -> Indices:
    """Give each joint's child that bears the most length (n,), -1 at a tip: limbs go on that way."""
    return heaviest_children(skeleton, accumulate_to_root(skeleton, edge_lengths(skeleton)))


def split_chains(skeleton: Skeleton, inside: NDArray[np.bool_], longest: float) -> list[Chain]:
    """Split a skeleton (any unit) where it forks, turns, enters the crown, or has gone on for long.

    ``inside`` (n,) marks the joints in the crown, ``longest`` (the skeleton's unit) bounds a chain there; a joint
    where the direction turns by 30 degrees ends a chain. No chain is shorter than a tenth of ``longest`` for the
    sake of a fork or a turn. Chains come parents first.
    """
    successors = successors_by_length(skeleton)
    order: dict[int, int] = {}
    chains = []
    for limb in limbs(skeleton, successors):
        generation = 1 if skeleton.parents[limb[0]] < 0 and limb[0] not in order else order[int(limb[0])] + 1
        for joint in limb.tolist():
            order.setdefault(joint, generation)
        cuts = _cuts(skeleton, limb, inside, longest, np.radians(TURN_DEG))
        chains += [Chain(limb[a : b + 1], generation) for a, b in zip(cuts[:-1], cuts[1:], strict=True)]
    return chains


def _cuts(skeleton: Skeleton, limb: Indices, inside: NDArray[np.bool_], longest: float, turn: float) -> list[int]:
    """Place the ends of a limb's chains, as positions in ``limb``."""
    if len(limb) < 2:
        return []
    arc = path_lengths(skeleton)[limb]
    counts = np.bincount(skeleton.parents[skeleton.parents >= 0], minlength=len(skeleton))
    cuts = [0]
    for i in range(1, len(limb) - 1):
        crosses = inside[limb[i]] != inside[limb[i - 1]]
        bends = counts[limb[i]] > 1 or _turn(skeleton.points[limb], arc, cuts[-1], i, longest) >= turn
        if crosses or (bends and min(arc[i] - arc[cuts[-1]], arc[-1] - arc[i]) >= 0.1 * longest):
            cuts.append(i)
    cuts.append(len(limb) - 1)
    return _even(cuts, arc, inside[limb], longest)


def _turn(points: Floats, arc: Floats, start: int, at: int, longest: float) -> float:
    """Measure the angle between the way since ``start`` and the way ahead of ``at``, radians."""
    ahead = min(int(np.searchsorted(arc, arc[at] + STRAIGHT_SHARE * longest)), len(arc) - 1)
    before, after = points[at] - points[start], points[max(ahead, at + 1)] - points[at]
    lengths = np.sqrt((before**2).sum() * (after**2).sum())
    return float(np.arccos(np.clip(before @ after / lengths, -1, 1))) if lengths > 0 else 0.0


def _even(cuts: list[int], arc: Floats, inside: NDArray[np.bool_], longest: float) -> list[int]:
    """Cut what is too long and lies inside into equal parts, at joints."""
    found = [0]
    for a, b in zip(cuts[:-1], cuts[1:], strict=True):
        parts = int(np.ceil((arc[b] - arc[a]) / longest)) if inside[(a + b) // 2] else 1
        aims = arc[a] + (arc[b] - arc[a]) * np.arange(1, parts) / max(parts, 1)
        found += [int(at) for at in np.searchsorted(arc, aims)] + [b]
    return sorted(set(found))
