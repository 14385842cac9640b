"""Radii by the pipe model: the wood at a fork carries all the pipes of its branches.

Shinozaki et al. 1964 and da Vinci's rule with a free exponent e: r^e is the sum of the children's r^e. Pipes end at
leaves, and leaves stand all along a twig, so every edge adds pipes by its length, which makes twigs taper. The
exponent is solved so that the trunk's base meets its measured radius.
"""

import numpy as np

from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, child_counts, heaviest_children, limbs
from treestroke.core.types import Floats, Indices

TWIG_TIPS = 40.0
"""Twig length that bears as many pipes as its tip, in tip radii."""
EXPONENTS = (1.8, 3.0)
"""Range of e in real trees (da Vinci 2, Murray 3)."""
FADE = 0.35
"""Share of a visible limb, before its end, over which the measured radius gives way to the pipes' one."""


def pipe_radii(points: Floats, parents: Indices, measured: Floats, tip: float, slender: float = 0.0) -> Floats:
    """Give each joint (n,) of a tree (n, 3) its radius; no child is thicker than its parent.

    ``measured`` (n,) holds known radii, 0 elsewhere, and is kept where it is known, save near the end of a visible
    limb, where it fades into the pipe model. ``tip`` is the radius of the thinnest twigs. All in one unit. A limb still
    thick where it ends fades over ``slender`` of its radii there, if that is further.
    """
    tree = Skeleton(points, measured, parents)
    pipes = pipe_counts(tree, TWIG_TIPS * tip)
    base = float(measured[0]) if measured[0] > 0 else tip * float(pipes[0]) ** 0.4
    model = radii_of_pipes(pipes, base, tip)
    weight = _weights(tree, pipes, slender)
    known = measured > 0
    mixed = np.where(known, measured, 1.0) ** weight * model ** (1 - weight)
    radii = np.where(known, mixed, model)
    for joint, parent in enumerate(parents.tolist()):
        if parent >= 0:
            radii[joint] = min(radii[joint], radii[parent])
    return radii


def pipe_counts(tree: Skeleton, twig: float) -> Floats:
    """Count the pipes at each joint (n,): one for each tip beyond it, and one for each ``twig`` of length."""
    tips = (child_counts(tree) == 0).astype(np.float64)
    own = edge_lengths(tree) / twig
    return np.asarray(accumulate_to_root(tree, tips + own) - own)


def radii_of_pipes(pipes: Floats, base: float, tip: float) -> Floats:
    """Turn pipes (n,) into radii that meet ``base`` at joint 0 and about ``tip`` where one pipe is left.

    Where the exponent would leave its range, the tips give way, not the base.
    """
    most = float(np.log(max(float(pipes[0]), 1.0 + 1e-9)))
    exponent = most / max(float(np.log(max(base / tip, 1.0 + 1e-9))), 1e-9)
    exponent = float(np.clip(exponent, *EXPONENTS))
    return np.asarray(base * (pipes / pipes[0]) ** (1 / exponent))


def _weights(tree: Skeleton, pipes: Floats, slender: float) -> Floats:
    """Weigh the measured radius (n,): 1, falling to 0 over the last part of each visible limb."""
    known = tree.radii > 0
    visible = np.where(known, pipes, -1.0)
    weight = np.zeros(len(tree))
    lengths = edge_lengths(tree)
    for limb in limbs(tree, heaviest_children(tree, visible)):
        own = limb if tree.parents[limb[0]] < 0 else limb[1:]
        if not known[own[0]]:
            continue
        arc = np.cumsum(np.where(known[own], lengths[own], 0.0))
        end = float(tree.radii[own][known[own]][-1])
        fade = min(max(FADE * arc[-1], slender * end), arc[-1])
        weight[own] = np.clip((arc[-1] - arc) / max(fade, 1e-12), 0, 1)
    return np.where(known, weight, 0.0)
