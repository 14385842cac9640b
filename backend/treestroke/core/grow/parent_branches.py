"""Parent branches of small branches, as flat arrays, so that a whole level grows at a time."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.skeleton.branched import Branched
from treestroke.core.types import Floats, Indices

BARE, BARE_STEM = 0.1, 0.35
"""Share of a branch, from its bud on, without small branches; and of a stem that has no limb (else it is bare up to its
lowest limb)."""
STEM_WEIGHT = 0.4
"""Number of small branches on a stem relative to a limb of the same length."""
MAX_OFFSET = 0.25
"""Greatest distance of a copy from its own chord, relative to its length: a limb that begins with a hook is copied less
bent."""
_WINDOW = 2
"""Joints to both sides over which a branch's direction is measured."""


@dataclass(frozen=True, eq=False)
class ParentBranches:
    """k branches with n nodes in all from which a small branch may grow.

    Attributes
    ----------
    points, along
        (n, 3) position of each node, metres, and unit direction of its branch there.
    joints, branch
        (n,) index of its joint in the tree, and of its branch, 0 to k - 1.
    place
        (n,) share of its branch's length that lies before it.
    weight
        (n,) metres of branch that it represents; less where few small branches are to grow, 0 where none.
    lengths
        (k,) lengths of the branches, metres.
    shapes
        (k, m + 1, 3) first part of each branch, scaled to length 1, from the bud at 0; axes: its chord and two sides.
    """

    points: Floats
    along: Floats
    joints: Indices
    branch: Indices
    place: Floats
    weight: Floats
    lengths: Floats
    shapes: Floats


def parents_from_main(main: Branched, share: float, pieces: int) -> ParentBranches:
    """Make parents of the drawn branches (n joints, metres); their first ``share`` is copied in ``pieces``.

    Source: two-sketches paper, section 6.
    """
    chains, points = main.chains(), main.skeleton.points
    places, steps, along, lengths, shapes = [], [], [], [], []
    for chain in chains:
        line = points[chain]
        step = np.append(0.0, np.sqrt((np.diff(line, axis=0) ** 2).sum(axis=1)))
        arc = np.cumsum(step)
        wanted = np.linspace(0, share * arc[-1], pieces + 1)
        lengths.append(arc[-1])
        shapes.append(np.stack([np.interp(wanted, arc, column) for column in line.T], axis=1))
        places.append(arc / max(float(arc[-1]), 1e-12))
        steps.append(step)
        along.append(_directions(line[None])[0])
    joints = np.concatenate(chains)
    branch = np.repeat(np.arange(len(chains)), [len(chain) for chain in chains])
    place, first = np.concatenate(places), _bare_shares(main, places)
    weight = np.concatenate(steps) * (place >= first[branch]) * np.where(branch == 0, STEM_WEIGHT, 1.0)
    own = (main.branch[joints] == branch) & (main.skeleton.parents[joints] >= 0)
    return ParentBranches(
        points[joints[own]],
        np.concatenate(along)[own],
        joints[own],
        branch[own],
        place[own],
        weight[own],
        np.array(lengths),
        _shapes(np.stack(shapes)),
    )


def parents_from_small(points: Floats, joints: Indices, share: float, pieces: int) -> ParentBranches:
    """Make parents of k small branches: points (k, m + 1, 3), metres, from the bud on.

    ``joints`` (k, m + 1) are indices of joints in the tree, -1 where the branch was cut; ``share`` and ``pieces`` as in
    `parents_from_main`. Source: two-sketches paper, section 6.
    """
    k, m = len(points), points.shape[1] - 1
    steps = np.sqrt((np.diff(points, axis=1) ** 2).sum(axis=2))
    own = joints[:, 1:] >= 0
    place = np.broadcast_to(np.arange(1, m + 1) / m, own.shape)
    at = np.linspace(0, share * m, pieces + 1)
    low = np.minimum(at.astype(np.int64), m - 1)
    part = points[:, low] + (at - low)[:, None] * (points[:, low + 1] - points[:, low])
    return ParentBranches(
        points[:, 1:][own],
        _directions(points)[:, 1:][own],
        joints[:, 1:][own],
        np.broadcast_to(np.arange(k)[:, None], own.shape)[own],
        place[own],
        (steps * (place >= BARE))[own],
        steps.sum(axis=1),
        _shapes(part),
    )


def across(directions: Floats) -> tuple[Floats, Floats]:
    """Return two unit vectors (..., 3) perpendicular to each unit direction (..., 3) and to each other."""
    side = unit(np.cross(directions, UP), np.array([1.0, 0.0, 0.0]))
    return side, np.cross(directions, side)


def _directions(lines: Floats) -> Floats:
    """Return the unit directions (k, m, 3) at the points of lines (k, m, 3), over some joints to both sides."""
    m = lines.shape[1]
    after, before = np.minimum(np.arange(m) + _WINDOW, m - 1), np.maximum(np.arange(m) - _WINDOW, 0)
    return unit(lines[:, after] - lines[:, before], UP)


def _bare_shares(main: Branched, places: list[Floats]) -> Floats:
    """Return the share of each branch (k,) without small branches; of a stem, the part below its lowest limb."""
    bare = np.full(len(places), BARE)
    stem, parents = np.flatnonzero(main.branch == 0), main.skeleton.parents
    limbed = parents[(main.branch > 0) & (main.branch[np.maximum(parents, 0)] == 0)]
    bare[0] = places[0][np.searchsorted(stem, limbed.min())] if len(limbed) else BARE_STEM
    return bare


def _shapes(parts: Floats) -> Floats:
    """Scale first parts (k, m + 1, 3) to length 1 and rotate them into the frames of their own chords."""
    parts = parts - parts[:, :1]
    length = np.sqrt((np.diff(parts, axis=1) ** 2).sum(axis=2)).sum(axis=1)
    parts = parts / np.maximum(length, 1e-12)[:, None, None]
    chord = unit(parts[:, -1], UP)
    frame = np.stack([chord, *across(chord)], axis=1)
    local = np.einsum("kmi,kji->kmj", parts, frame)
    off = np.sqrt((local[..., 1:] ** 2).sum(axis=2)).max(axis=1, initial=0.0)
    local[..., 1:] *= np.minimum(1, MAX_OFFSET / np.maximum(off, 1e-12))[:, None, None]
    return np.asarray(local)
