"""Lifts a bare tree whose wood was all traced: every limb and twig turns out of the picture in its own direction.

Successive branches of a limb stand around it, each turned by the golden angle from the one before (phyllotaxis). Seen
from the front that angle shows as a slope in depth, forward or back. A branch begins in its parent's direction.
"""

import numpy as np

from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.geometry.polyline import smoothed
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
INSIDE = 0.85
"""Depth that limbs come near to, as a share of half the crown's width at their height."""
LEAST_DEPTH, SMOOTH = 0.05, 0.06
"""Least of that depth, and the distance over which it is evened, as shares of the tree's height."""


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
    depth, slope = np.zeros(len(flat)), np.zeros(len(flat))
    for chain, steep in zip(chains, steepness.tolist(), strict=True):
        if stems[chain[-1]] or stems[chain[min(1, len(chain) - 1)]]:
            continue
        along = np.cumsum(lengths[chain[1:]])
        start = slope[chain[0]]
        own = FOLLOW * start + steep
        slopes = start + (own - start) * along / (along + BEND * along[-1] + 1e-9)
        slope[chain[1:]] = slopes
        depth[chain[1:]] = depth[chain[0]] + np.cumsum(slopes * lengths[chain[1:]])
    most = _most_depth(points[:, 1], crown.volume)
    return Skeleton(np.column_stack([points[:, :2], most * np.tanh(depth / most)]), radii, flat.parents)


def _steepness(weights: list[float], rng: np.random.Generator) -> Floats:
    """Return the own slope (k,) of limbs of such weights: the heaviest first, each turned by the golden angle."""
    rank = np.argsort(np.argsort(-np.array(weights), kind="stable"), kind="stable")
    turn_rad = rng.uniform(0, 2 * np.pi) + GOLDEN_RAD * rank + rng.uniform(-JITTER_RAD, JITTER_RAD, len(weights))
    return np.asarray(STEEPEST * np.sin(turn_rad))


def _most_depth(heights_m: Floats, volume: CrownVolume) -> Floats:
    """Return the depth (n,), metres, that limbs come near to at heights (n,), metres."""
    tall = float(heights_m.max())
    places = np.linspace(0.0, tall, 101)
    width = smoothed(np.maximum(INSIDE * volume.half_width(places), LEAST_DEPTH * tall), 100 * SMOOTH)
    return np.interp(heights_m, places, width)
