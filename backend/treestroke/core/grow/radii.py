"""Radii by the pipe model: at a fork the parent has all the pipes of its children.

Shinozaki et al. 1964, and da Vinci's rule with a free exponent e: r^e is the sum of the children's r^e. Pipes end at
leaves, and leaves grow all along a twig, so every edge adds pipes in proportion to its length, which makes twigs taper.
The exponent is solved for so that the trunk's base has its measured radius.
"""

import numpy as np

from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, child_counts, heaviest_children, limbs
from treestroke.core.types import Floats, Indices

TWIG_TIPS = 40.0
"""Length of a twig that adds as many pipes as its tip, relative to the tip's radius."""
EXPONENTS = (1.8, 3.0)
"""Range of e in real trees (da Vinci 2, Murray 3)."""
FADE = 0.35
"""Share of a visible limb, before its end, over which the radius changes from the measured to the pipe model's one."""


def pipe_radii(points: Floats, parents: Indices, measured: Floats, tip: float, slender: float = 0.0) -> Floats:
    """Return the radius of each joint (n,) of a tree (n, 3), px or metres; no child is thicker than its parent.

    ``measured`` (n,) holds known radii, 0 elsewhere, and is kept where it is known, except near the end of a visible
    limb, where it fades into the pipe model over `FADE` of the limb or ``slender`` times the radius at its end,
    whichever is longer. ``tip`` is the radius of the thinnest twigs. All lengths are in the same unit.
    Source: Shinozaki et al. 1964.
    """
    tree = Skeleton(points, measured, parents)
    pipes = pipe_counts(tree, TWIG_TIPS * tip)
    base = float(measured[0]) if measured[0] > 0 else tip * float(pipes[0]) ** 0.4
    model = radii_of_pipes(pipes, base, tip)
    weight = _weights(tree, pipes, slender)
    known = measured > 0
    mixed = np.where(known, measured, 1.0) ** weight * model ** (1 - weight)
    radii = np.where(known, mixed, model).tolist()
    for joint, parent in enumerate(parents.tolist()):
        if parent >= 0:
            radii[joint] = min(radii[joint], radii[parent])
    return np.array(radii)


def pipe_counts(tree: Skeleton, twig: float) -> Floats:
    """Count the pipes at each joint (n,): one a tip beyond it and one a length of ``twig`` (in the tree's unit)."""
    tips = (child_counts(tree) == 0).astype(np.float64)
    along = edge_lengths(tree) / twig
    return np.asarray(accumulate_to_root(tree, tips + along) - along)


def radii_of_pipes(pipes: Floats, base: float, tip: float) -> Floats:
    """Convert pipe counts (n,) to radii (n,): ``base`` (px or metres) at joint 0 and about ``tip`` at one pipe.

    Where the exponent would leave its range, the tips differ from ``tip``, not the base. Source: Shinozaki et al. 1964.
    """
    most = float(np.log(max(float(pipes[0]), 1.0 + 1e-9)))
    exponent = most / max(float(np.log(max(base / tip, 1.0 + 1e-9))), 1e-9)
    exponent = float(np.clip(exponent, *EXPONENTS))
    return np.asarray(base * (pipes / pipes[0]) ** (1 / exponent))


def _weights(tree: Skeleton, pipes: Floats, slender: float) -> Floats:
    """Return the weight of the measured radius (n,): 1, falling to 0 over the last part of each visible limb."""
    known = tree.radii > 0
    visible = np.where(known, pipes, -1.0)
    weight = np.zeros(len(tree))
    lengths = edge_lengths(tree)
    for limb in limbs(tree, heaviest_children(tree, visible)):
        joints = limb if tree.parents[limb[0]] < 0 else limb[1:]
        if not known[joints[0]]:
            continue
        arc = np.cumsum(np.where(known[joints], lengths[joints], 0.0))
        end = float(tree.radii[joints][known[joints]][-1])
        fade = min(max(FADE * arc[-1], slender * end), arc[-1])
        weight[joints] = np.clip((arc[-1] - arc) / max(fade, 1e-12), 0, 1)
    return np.where(known, weight, 0.0)
