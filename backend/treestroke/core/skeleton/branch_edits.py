"""Edits of visible branches: removed, added, moved, made thicker or thinner, joined (Tan et al. 2007, section 5.1)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from treestroke.core.geometry.similarity import Similarity
from treestroke.core.skeleton.edit import densified, subskeleton
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import child_counts
from treestroke.core.types import Floats, Indices, Mask

REACH = 0.05
"""Greatest distance of an edit's place from the joint that it names, as a share of the tree's height."""
FAR = 3.0
"""Greatest distance from the root of what an edit places, and greatest length of an added branch, in heights."""
THICKEST = 0.5
"""Greatest radius that an edit may give, in heights."""
SHORTEST = 1e-6
"""Least distance of two joints, in heights."""
FINEST = 0.005
"""Least distance, in heights, at which joints are laid along what is added."""
OF_PARENT = 0.6
"""Radius at the start of a branch that is added without one, as a share of that of the joint which it leaves."""
OF_START = 0.25
"""Radius at the tip of a branch that is added, as a share of that at its start."""


@dataclass(frozen=True, eq=False)
class Remove:
    """The branch from the joint nearest ``at`` (3,) on goes, with all that leaves it."""

    at: Floats


@dataclass(frozen=True, eq=False)
class Add:
    """A branch from the joint nearest ``start`` (3,) through ``points`` (n, 3), of a ``radius`` where it starts."""

    start: Floats
    points: Floats
    radius: float | None = None


@dataclass(frozen=True, eq=False)
class Move:
    """The joint nearest ``at`` (3,) goes ``to`` (3,); what is beyond goes with it, the way from the last fork bends."""

    at: Floats
    to: Floats


@dataclass(frozen=True, eq=False)
class SetRadius:
    """The joint nearest ``at`` (3,) gets a ``radius``; radii beyond it are scaled alike, back to the last fork less."""

    at: Floats
    radius: float


@dataclass(frozen=True, eq=False)
class Join:
    """The piece that holds the joint nearest ``at`` (3,) is hung onto the joint nearest ``to`` (3,).

    A piece starts where what is seen follows what is not; where all is seen back to the root, it starts at the last
    fork.
    """

    at: Floats
    to: Floats


BranchEdit = Remove | Add | Move | SetRadius | Join


@dataclass(frozen=True)
class LostEdit:
    """An edit that was not applied: its index, and the reason for people."""

    index: int
    detail: str


@dataclass(frozen=True, eq=False)
class EditedBranches:
    """Visible branches after edits: the skeleton, whether wood is seen at each joint (n,), and the edits left out."""

    skeleton: Skeleton
    seen: Mask
    lost: tuple[LostEdit, ...]


def edits_in_frame(edits: Sequence[BranchEdit], frame: Similarity) -> tuple[BranchEdit, ...]:
    """Return edits carried into another frame."""

    def moved(edit: BranchEdit) -> BranchEdit:
        match edit:
            case Remove(at):
                return Remove(place(at))
            case Add(start, points, radius):
                return Add(place(start), frame.points(points), None if radius is None else radius * frame.scale)
            case SetRadius(at, radius):
                return SetRadius(place(at), radius * frame.scale)
            case Move(at, to) | Join(at, to):
                return replace(edit, at=place(at), to=place(to))

    def place(point: Floats) -> Floats:
        return np.asarray(frame.points(point[None])[0])

    return tuple(moved(edit) for edit in edits)


def edited(skeleton: Skeleton, seen: Mask, edits: Sequence[BranchEdit], height: float) -> EditedBranches:
    """Apply edits, in the skeleton's frame, one after another to visible branches (3D, one root).

    ``height`` is that of the whole tree, of which perhaps only the trunk's foot is visible.

    Each names joints by places: the nearest joint counts, within `REACH`. One that finds none, or would break the tree,
    is left out and told. ``seen`` (n,) tells whether wood is seen at each joint; it is not where a joint was added. The
    root stays; a joint is thicker than its parent only where a radius was asked for. The same edits give the same bits.
    """
    tree, lost = _Branches(skeleton, seen, height), list[LostEdit]()
    for index, edit in enumerate(edits):
        try:
            tree = _applied(tree, edit)
        except _Lost as why:
            lost.append(LostEdit(index, str(why)))
    return EditedBranches(tree.skeleton, tree.seen, tuple(lost))


class _Lost(Exception):
    """An edit cannot be applied; the message says why."""


@dataclass(frozen=True, eq=False)
class _Branches:
    """Branches that are edited, whether each joint is seen (n,), and the height of the whole tree."""

    skeleton: Skeleton
    seen: Mask
    height: float

    def nearest(self, place: Floats) -> int:
        """Return the joint nearest a place (3,)."""
        away = np.linalg.norm(self.skeleton.points - place, axis=1)
        joint = int(away.argmin())
        if away[joint] > REACH * self.height:
            raise _Lost("there is no branch near the place that it names")
        return joint

    def beyond(self, joint: int) -> Mask:
        """Mark (n,) a joint and all that leaves it."""
        marked = [False] * len(self.skeleton)
        for index, parent in enumerate(self.skeleton.parents.tolist()):
            marked[index] = index == joint or (parent >= 0 and marked[parent])
        return np.array(marked)

    def back_to_fork(self, joint: int) -> tuple[Indices, Floats]:
        """Return the joints (m,) after the last fork before a joint, and how far each is on the way to it (m,), 0 to 1.

        The joint itself, at 1, is the last of them; a root counts as a fork.
        """
        counts, parents = child_counts(self.skeleton), self.skeleton.parents
        way = [joint]
        while parents[way[-1]] >= 0 and parents[parents[way[-1]]] >= 0 and counts[parents[way[-1]]] == 1:
            way.append(int(parents[way[-1]]))
        joints = np.array(way[::-1])
        far = np.cumsum(edge_lengths(self.skeleton)[joints])
        return joints, far / max(float(far[-1]), 1e-12)

    def check_place(self, points: Floats) -> None:
        """Check that places (n, 3) lie near the tree."""
        if np.linalg.norm(points - self.skeleton.points[0], axis=1).max() > FAR * self.height:
            raise _Lost("it leads far away from the tree")

    def check_radius(self, radius: float) -> None:
        """Check that a radius is one of a branch."""
        if radius > THICKEST * self.height:
            raise _Lost("no branch is that thick")

    def with_chain(self, parent: int, points: Floats, radii: Floats) -> "_Branches":
        """Add unseen joints along a line (m, 3) of radii (m,) that starts at a joint, with more of them between."""
        lengths = edge_lengths(self.skeleton)
        step = max(float(np.median(lengths[lengths > 0])) if (lengths > 0).any() else 0.0, FINEST * self.height)
        dense, _ = densified(Skeleton(points, radii, np.arange(len(points)) - 1), step)
        added, count = len(dense) - 1, len(self.skeleton)
        skeleton = Skeleton(
            np.concatenate([self.skeleton.points, dense.points[1:]]),
            np.concatenate([self.skeleton.radii, dense.radii[1:]]),
            np.concatenate([self.skeleton.parents, [parent], np.arange(count, count + added - 1)]),
        )
        return replace(self, skeleton=skeleton, seen=np.append(self.seen, np.zeros(added, dtype=np.bool_)))


def _applied(tree: _Branches, edit: BranchEdit) -> _Branches:
    match edit:
        case Remove():
            return _removed(tree, edit)
        case Add():
            return _added(tree, edit)
        case Move():
            return _moved(tree, edit)
        case SetRadius():
            return _thickened(tree, edit)
        case Join():
            return _joined(tree, edit)


def _removed(tree: _Branches, edit: Remove) -> _Branches:
    joint = tree.nearest(edit.at)
    if joint == 0:
        raise _Lost("the whole tree would be removed")
    skeleton, kept = subskeleton(tree.skeleton, ~tree.beyond(joint))
    return replace(tree, skeleton=skeleton, seen=tree.seen[kept])


def _added(tree: _Branches, edit: Add) -> _Branches:
    parent = tree.nearest(edit.start)
    tree.check_place(edit.points)
    line = np.concatenate([tree.skeleton.points[[parent]], edit.points])
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    line = line[np.append(True, steps > SHORTEST * tree.height)]
    far = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))
    if len(line) < 2:
        raise _Lost("the branch has no length")
    if far[-1] > FAR * tree.height:
        raise _Lost("the branch is far longer than the tree is high")
    start = OF_PARENT * tree.skeleton.radii[parent] if edit.radius is None else edit.radius
    tree.check_radius(start)
    return tree.with_chain(parent, line, start * (1 - (1 - OF_START) * far / far[-1]))


def _moved(tree: _Branches, edit: Move) -> _Branches:
    joint = tree.nearest(edit.at)
    if joint == 0:
        raise _Lost("the root stays; the trunk's stroke says where it is")
    tree.check_place(edit.to[None])
    way, share = tree.back_to_fork(joint)
    points, shift = tree.skeleton.points.copy(), edit.to - tree.skeleton.points[joint]
    points[tree.beyond(joint)] += shift
    points[way[:-1]] += share[:-1, None] * shift
    skeleton = replace(tree.skeleton, points=points)
    if edge_lengths(skeleton)[way].min() <= SHORTEST * tree.height:
        raise _Lost("the joint would lie on the one before it")
    return replace(tree, skeleton=skeleton)


def _thickened(tree: _Branches, edit: SetRadius) -> _Branches:
    joint = tree.nearest(edit.at)
    tree.check_radius(edit.radius)
    radii, now = tree.skeleton.radii.copy(), float(tree.skeleton.radii[joint])
    if now <= 0:
        raise _Lost("the branch has no radius that could be scaled")
    way, share = tree.back_to_fork(joint)
    radii[tree.beyond(joint)] *= edit.radius / now
    radii[way[:-1]] *= 1 + share[:-1] * (edit.radius / now - 1)
    radii[joint] = edit.radius
    return replace(tree, skeleton=replace(tree.skeleton, radii=radii))


def _joined(tree: _Branches, edit: Join) -> _Branches:
    start, onto = _piece_start(tree, tree.nearest(edit.at)), tree.nearest(edit.to)
    piece = tree.beyond(start)
    if piece[onto]:
        raise _Lost("a piece cannot be joined to itself")
    parents, counts = tree.skeleton.parents, child_counts(tree.skeleton)
    gone, before = np.zeros(len(piece), dtype=np.bool_), int(parents[start])
    while before not in (0, onto) and not tree.seen[before] and counts[before] == 1:
        gone[before], before = True, int(parents[before])
    rest, kept = subskeleton(tree.skeleton, ~piece & ~gone)
    whole = replace(tree, skeleton=rest, seen=tree.seen[kept])
    return _with_piece(whole, int(np.searchsorted(kept, onto)), tree, np.flatnonzero(piece))


def _piece_start(tree: _Branches, joint: int) -> int:
    """Return the first joint of the piece that holds a joint, or that hangs at one which is not seen."""
    parents, seen = tree.skeleton.parents, tree.seen
    starts = seen & ~seen[np.maximum(parents, 0)]
    outward = np.flatnonzero(starts & tree.beyond(joint))
    at = int(outward[0]) if len(outward) and not seen[joint] else joint
    while at > 0 and not starts[at]:
        at = int(parents[at])
    if at == 0:
        at = int(tree.back_to_fork(joint)[0][0])
    if at == 0:
        raise _Lost("the piece at the root is joined to nothing")
    return at


def _with_piece(tree: _Branches, onto: int, whole: _Branches, piece: Indices) -> _Branches:
    """Hang joints (m,) of the ``whole``, the first of which the others leave, onto a joint; unseen ones bridge the gap.

    The piece becomes thinner where it is thicker than what it hangs on.
    """
    points, radii = whole.skeleton.points[piece], whole.skeleton.radii[piece]
    ends = np.stack([tree.skeleton.points[onto], points[0]])
    if np.linalg.norm(ends[1] - ends[0]) <= SHORTEST * tree.height:
        raise _Lost("the piece would lie on the joint that it is joined to")
    radii = radii * min(1.0, float(tree.skeleton.radii[onto]) / max(float(radii[0]), 1e-12))
    bridged = tree.with_chain(onto, ends, np.full(2, radii[0]))
    count = len(bridged.skeleton) - 1  # the bridge ends where the piece starts
    number = np.searchsorted(piece, whole.skeleton.parents[piece]) + count
    number[0] = bridged.skeleton.parents[-1]
    skeleton = Skeleton(
        np.concatenate([bridged.skeleton.points[:-1], points]),
        np.concatenate([bridged.skeleton.radii[:-1], radii]),
        np.concatenate([bridged.skeleton.parents[:-1], number]),
    )
    return replace(tree, skeleton=skeleton, seen=np.concatenate([bridged.seen[:-1], whole.seen[piece]]))
