"""Lifts a bare tree whose wood was all traced: every limb and twig turns out of the picture in its own direction.

Limbs that stand all round a stem end, seen in one line of sight, evenly between the crown's front and its back: little
apart at its left and right edge, most in its middle. Successive ones take places far from each other, by the golden
ratio as in phyllotaxis, and begin in their parent's direction.
"""

import numpy as np

from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.lift.spread import FrontCrown
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children, limbs
from treestroke.core.types import Floats, Indices

GOLDEN = (np.sqrt(5.0) - 1) / 2
"""Step between places, as a share of the depth."""
STEEPEST = 1.8
"""Greatest slope of a limb's depth against its length in the picture, beside what it has of its parent."""
FOLLOW = 0.6
"""Share of its parent's slope that a limb keeps."""
BEND = 0.3
"""Share of its length over which a limb turns from its parent's slope to its own."""
JITTER = 0.06
"""Greatest deviation of a limb from its place in depth, as a share of the crown's half depth."""
SLOPES = np.linspace(-STEEPEST, STEEPEST, 13)
"""Slopes with which a limb is tried: of those with which it stays in the crown, the one that ends nearest to its place
is taken."""
ROOM, AROUND = 1.2, 0.08
"""Half the width of the sections that limbs may fill, relative to the crown's greatest within this share of the tree's
height."""
ROUNDED, LEAST = 3.0, 0.25
"""Exponent of those sections, between a circle (2) and a square: limbs that are seen in their full length hide others
that reach as far aslant; and least share of depth to that power, so that no limb at the edge is alone."""


def fan_out(skeleton: Skeleton, stroke: Indices, crown: FrontCrown, rng: np.random.Generator) -> Skeleton:
    """Lift a traced skeleton (2D, px) to the world (3D, metres), radii too; each joint still projects onto its pixel.

    Stems stay in the picture's plane. ``stroke`` (n,) tells which stroke each joint follows: a limb goes on along its
    own stroke. The heaviest limbs take their places first, so that few large ones stand on all sides, too.
    """
    points, radii = crown.camera.world_from_pixels(skeleton.points), crown.camera.metres_from_pixels(skeleton.radii)
    flat = Skeleton(points, radii, skeleton.parents)
    lengths = edge_lengths(flat)
    weights = accumulate_to_root(flat, lengths)
    same = stroke == stroke[np.maximum(flat.parents, 0)]
    chains = limbs(flat, heaviest_children(flat, np.where(same, weights + weights.max(), weights)))
    stems = np.isin(stroke, stroke[skeleton.parents < 0])
    places = _places([float(weights[chain[min(1, len(chain) - 1)]]) for chain in chains], rng)
    most = _most_depth(points, crown.volume)
    depth, slope = np.zeros(len(flat)), np.zeros(len(flat))
    for chain, place in zip(chains, places.tolist(), strict=True):
        if stems[chain[min(1, len(chain) - 1)]]:
            continue
        first, rest = chain[0], chain[1:]
        slopes, depths = _turns(lengths[rest], float(slope[first]))
        depths += depth[first]
        over = np.maximum(np.max(np.abs(depths) - most[rest], axis=1), 0.0)
        away = np.abs(depths[:, -1] - place * most[rest[-1]])
        best = int(np.lexsort([away, over])[0])
        slope[rest], depth[rest] = slopes[best], depths[best]
    return Skeleton(np.column_stack([points[:, :2], depth]), radii, flat.parents)


def _turns(lengths: Floats, start: float) -> tuple[Floats, Floats]:
    """Return slopes and depths (k, n) along a limb of such edges (n,) that begins at a slope, for each of `SLOPES`."""
    along = np.cumsum(lengths)
    own = FOLLOW * start + SLOPES[:, None]
    slopes = start + (own - start) * along / (along + BEND * along[-1] + 1e-9)
    return slopes, np.cumsum(slopes * lengths, axis=1)


def _places(weights: list[float], rng: np.random.Generator) -> Floats:
    """Return the places (k,) in depth, -1 to 1, where limbs of such weights are to end, the heaviest chosen first."""
    rank = np.argsort(np.argsort(-np.array(weights), kind="stable"), kind="stable")
    turn = (rng.uniform() + GOLDEN * rank) % 1.0
    return np.asarray(2 * turn - 1 + rng.uniform(-JITTER, JITTER, len(weights)))


def _most_depth(points: Floats, volume: CrownVolume) -> Floats:
    """Return the greatest depth (n,), metres, of limbs at points (n, 3), metres."""
    tall = float(points[:, 1].max())
    around = points[:, 1] + tall * np.linspace(-AROUND, AROUND, 9)[:, None]
    radius = ROOM * np.max([volume.half_width(heights) for heights in around], axis=0)
    aside = np.abs(points[:, 0] - volume.axis(points[:, 1])[:, 0]) / np.maximum(radius, 1e-9)
    return np.asarray(radius * np.maximum(1.0 - aside**ROUNDED, LEAST) ** (1 / ROUNDED))
