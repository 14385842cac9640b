"""Lifts a bare tree whose wood was all traced: every limb and twig turns out of the picture in its own direction.

Successive branches of a limb stand around it, each turned by the golden angle from the one before (phyllotaxis). Seen
from the front that angle shows as a slope in depth, forward or back. A branch begins in its parent's direction.
"""

import numpy as np

from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.lift.spread import FrontCrown
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children, limbs
from treestroke.core.types import Floats, Indices

GOLDEN_RAD = np.pi * (3 - np.sqrt(5.0))
STEEPEST = 1.8
"""Greatest slope of a limb's depth against its length in the picture, beside what it has of its parent."""
FOLLOW = 0.6
"""Share of its parent's slope that a limb keeps."""
BEND = 0.3
"""Share of its length over which a limb turns from its parent's slope to its own."""
JITTER_RAD = 0.4
"""Greatest deviation of a limb from its turn, radians."""
TURNS = np.array([1.0, 0.75, 0.5, 0.25, 0.0, -0.25, -0.5])
"""Shares of its slope with which a limb is tried: the first with which it stays in the crown is taken."""
INSIDE, AROUND = 1.0, 0.08
"""Greatest depth of limbs, as a share of half the crown's greatest width within this share of the tree's height."""


def fan_out(skeleton: Skeleton, stroke: Indices, crown: FrontCrown, rng: np.random.Generator) -> Skeleton:
    """Lift a traced skeleton (2D, px) to the world (3D, metres), radii too; each joint still projects onto its pixel.

    Stems stay in the picture's plane. ``stroke`` (n,) tells which stroke each joint follows: a limb goes on along its
    own stroke. The heaviest limbs turn first, so that few large ones stand on all sides, too.
    """
    points, radii = crown.camera.world_from_pixels(skeleton.points), crown.camera.metres_from_pixels(skeleton.radii)
    flat = Skeleton(points, radii, skeleton.parents)
    lengths = edge_lengths(flat)
    weights = accumulate_to_root(flat, lengths)
    same = stroke == stroke[np.maximum(flat.parents, 0)]
    chains = limbs(flat, heaviest_children(flat, np.where(same, weights + weights.max(), weights)))
    stems = np.isin(stroke, stroke[skeleton.parents < 0])
    steepness = _steepness([float(weights[chain[min(1, len(chain) - 1)]]) for chain in chains], rng)
    most = _most_depth(points[:, 1], crown.volume)
    depth, slope = np.zeros(len(flat)), np.zeros(len(flat))
    for chain, steep in zip(chains, steepness.tolist(), strict=True):
        if stems[chain[min(1, len(chain) - 1)]]:
            continue
        first, rest = chain[0], chain[1:]
        slopes, depths = _turns(lengths[rest], float(slope[first]), steep)
        over = np.max(np.abs(depth[first] + depths) - most[rest], axis=1)
        best = int(np.argmax(over <= max(0.0, float(over.min()))))
        slope[rest], depth[rest] = slopes[best], depth[first] + depths[best]
    return Skeleton(np.column_stack([points[:, :2], depth]), radii, flat.parents)


def _turns(lengths: Floats, start: float, steep: float) -> tuple[Floats, Floats]:
    """Return slopes and depths (k, n) along a limb of such edges (n,) that begins at a slope, for each of `TURNS`."""
    along = np.cumsum(lengths)
    own = (FOLLOW * start + steep) * TURNS[:, None]
    slopes = start + (own - start) * along / (along + BEND * along[-1] + 1e-9)
    return slopes, np.cumsum(slopes * lengths, axis=1)


def _steepness(weights: list[float], rng: np.random.Generator) -> Floats:
    """Return the own slope (k,) of limbs of such weights: the heaviest first, each turned by the golden angle."""
    rank = np.argsort(np.argsort(-np.array(weights), kind="stable"), kind="stable")
    turn_rad = rng.uniform(0, 2 * np.pi) + GOLDEN_RAD * rank + rng.uniform(-JITTER_RAD, JITTER_RAD, len(weights))
    return np.asarray(STEEPEST * np.sin(turn_rad))


def _most_depth(heights_m: Floats, volume: CrownVolume) -> Floats:
    """Return the greatest depth (n,), metres, of limbs at heights (n,), metres."""
    tall = float(heights_m.max())
    around = heights_m + tall * np.linspace(-AROUND, AROUND, 9)[:, None]
    return np.asarray(INSIDE * np.max([volume.half_width(heights) for heights in around], axis=0))
