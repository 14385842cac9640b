"""Lifts a traced tree to 3D by probability: each piece of a limb takes the push with the highest posterior.

Source: Li, Deussen, Song, Willis and Hall 2011, section 3: a local term keeps forks natural, a global one fills the
crown. The trunk stays in the picture's plane. Where we differ: the 2D skeleton is not copied into a second plane, since
growth adds the limbs that no picture shows; and a limb that goes on has an expected angle of its own beside that of one
that leaves.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.lift.spread import FrontCrown, FrontTree
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, child_counts, heaviest_children, limbs
from treestroke.core.types import Floats, Indices

SEEN = 0.3
"""Share of a piece's wood, with all that it bears, that is seen among leaves if it lies on the viewer's side."""
EVEN = 1e-9
"""Relative difference below which two posteriors count as equal."""


@dataclass(frozen=True)
class PosteriorParams:
    """How far pieces are pushed.

    Attributes
    ----------
    options
        Pushes tried, evenly spaced over both sides (paper: L).
    farthest
        Greatest push as a share of the crown's width (paper: delta).
    attractors
        About how many places on the crown's surface draw wood (paper: m, 200 to 300).
    steepest
        Greatest slope of a piece's depth against its length in the picture (no symbol in the paper: its nodes are far
        apart).
    inside
        Share of the crown's half depth that wood may use.
    """

    options: int = 21
    farthest: float = 0.2
    attractors: int = 250
    steepest: float = 0.85
    inside: float = 0.8

    def __post_init__(self) -> None:
        if self.options < 1 or self.attractors < 1:
            raise ValueError(f"lifting needs options and attractors, got {self}")
        if min(self.farthest, self.steepest) < 0 or not 0 <= self.inside <= 1:
            raise ValueError(f"lifting needs a push and a slope >= 0 and a share of the depth, got {self}")


@dataclass(frozen=True, eq=False)
class _Piece:
    """A limb's joints (m,) from one fork to the next, the first apart; and which piece it leaves or goes on from.

    Attributes
    ----------
    joints
        The first is that of the piece before.
    before
        Index of the piece before; -1 on a stem's first one.
    goes_on
        Whether it is of the same limb.
    depth
        How many pieces lead to it (paper: d).
    """

    joints: Indices
    before: int
    goes_on: bool
    depth: int


def lift_by_posterior(
    tree: FrontTree, crown: FrontCrown, rng: np.random.Generator, params: PosteriorParams = PosteriorParams()
) -> Skeleton:
    """Lift a traced tree to the world (3D, metres), radii too.

    Each joint still projects onto its pixel. The first stem stays in the picture's plane. From root to tip, each piece
    between forks is pushed toward or away from the viewer, and all that it bears with it, by the distance of highest
    posterior; ``rng`` decides between equals. A piece that is seen among leaves does not go back.

    Source: Li et al. 2011, section 3, equations 2 to 6; the module's head says where we differ.
    """
    points = crown.camera.world_from_pixels(tree.skeleton.points)
    flat = Skeleton(points, crown.camera.metres_from_pixels(tree.skeleton.radii), tree.skeleton.parents)
    weights = accumulate_to_root(flat, edge_lengths(flat))
    same = tree.stroke == tree.stroke[np.maximum(flat.parents, 0)]
    chains = limbs(flat, heaviest_children(flat, np.where(same, weights + weights.max(), weights)))
    seen = accumulate_to_root(flat, edge_lengths(flat) * tree.before_leaves) > SEEN * weights
    pieces = _pieces(flat, chains)
    pushing = _Pushing(flat, pieces, crown.volume, params)
    stem = set(chains[0].tolist())
    for number in sorted(range(len(pieces)), key=lambda n: (pieces[n].depth, -weights[pieces[n].joints[1]], n)):
        if int(pieces[number].joints[1]) not in stem:
            pushing.push(number, bool(seen[pieces[number].joints[1]]), rng)
    return Skeleton(np.column_stack([points[:, :2], pushing.depth]), flat.radii, flat.parents)


def _pieces(tree: Skeleton, chains: list[Indices]) -> list[_Piece]:
    """Split limbs at their forks."""
    forks, pieces, ending = child_counts(tree) > 1, list[_Piece](), dict[int, int]()
    for chain in chains:
        inner = np.flatnonzero(forks[chain[1:-1]]) + 1
        for start, end in pairwise([0, *inner.tolist(), len(chain) - 1]):
            before = ending.get(int(chain[start]), -1)
            depth = 0 if before < 0 else pieces[before].depth + 1
            ending[int(chain[end])] = len(pieces)
            pieces.append(_Piece(chain[start : end + 1], before, start > 0, depth))
    return pieces


class _Pushing:
    """The tree while its pieces are pushed, one after another.

    Attributes
    ----------
    depth
        (n,) Z of each joint, metres.
    """

    def __init__(self, flat: Skeleton, pieces: list[_Piece], volume: CrownVolume, params: PosteriorParams) -> None:
        self.flat, self.pieces, self.params = flat, pieces, params
        self.depth = np.zeros(len(flat))
        self._last = _last_descendants(flat)
        self._room = params.inside * volume.half_depth(flat.points)
        self._reach = params.farthest * 2 * volume.widest
        attractors = _attractors(volume, params.attractors).astype(np.float32)
        self._attractor_depth = attractors[:, 2]
        flat_points = flat.points.astype(np.float32)
        aside, along = (attractors[:, axis, None] - flat_points[:, axis] for axis in (0, 1))
        self._across = aside * aside + along * along
        self._deepest = max((piece.depth for piece in pieces), default=0)
        self._expected = {goes_on: self._mean_angle(goes_on) for goes_on in (False, True)}

    def push(self, number: int, toward: bool, rng: np.random.Generator) -> None:
        """Push a piece, with all that it bears, by the distance of highest posterior; ``toward`` keeps it in front."""
        piece = self.pieces[number]
        moved, share = self._moved(piece)
        pushes = self._options(piece, toward)
        posterior = self._filling(moved, share, pushes) * self._natural(piece, pushes)
        best = np.flatnonzero(posterior >= posterior.max() * (1 - EVEN))
        self.depth[moved] += share * pushes[best[rng.integers(len(best))]]

    def _moved(self, piece: _Piece) -> tuple[Indices, Floats]:
        """Return the joints that move with a piece (m,), and by which share of its push each moves (m,)."""
        own, end = piece.joints[1:], int(piece.joints[-1])
        steps = np.linalg.norm(np.diff(self.flat.points[piece.joints, :2], axis=0), axis=1)
        along = np.cumsum(steps) / max(float(steps.sum()), 1e-9)
        beyond = self._last[end]
        return np.concatenate([own, beyond]), np.concatenate([along, np.ones(len(beyond))])

    def _options(self, piece: _Piece, toward: bool) -> Floats:
        """Return the pushes (k,), metres, with which a piece's end stays in the crown and no steeper than allowed."""
        start, end = piece.joints[[0, -1]]
        length = float(np.linalg.norm(self.flat.points[end, :2] - self.flat.points[start, :2]))
        most = min(self._reach, self.params.steepest * length)
        pushes = np.linspace(-most, most, self.params.options)
        depth = self.depth[end] + pushes
        room = max(float(self._room[end]), abs(float(self.depth[end])))
        allowed = (np.abs(depth) <= room) & ((depth >= 0) | (not toward))
        return np.asarray(pushes[allowed]) if allowed.any() else np.zeros(1)

    def _filling(self, moved: Indices, share: Floats, pushes: Floats) -> Floats:
        """Global term (k,): how much nearer each push brings the wood to the crown's surface, normalised."""
        stays = np.ones(len(self.flat), dtype=np.bool_)
        stays[moved] = False
        others = self._squares(np.flatnonzero(stays), self.depth[stays]).min(axis=1, initial=np.inf)
        total = [self._sum(others, moved, self.depth[moved] + share * push) for push in pushes]
        gains = np.maximum(self._sum(others, moved, self.depth[moved]) - np.array(total), 0.0)
        return gains / gains.sum() if gains.sum() > 0 else np.ones(len(pushes))

    def _sum(self, others: NDArray[np.float32], joints: Indices, depth: Floats) -> float:
        """Sum of the attractors' distances from the wood, where some joints (m,) have these depths (m,) (paper: D)."""
        nearest = np.minimum(others, self._squares(joints, depth).min(axis=1))
        return float(np.sqrt(nearest.astype(np.float64)).sum())

    def _squares(self, joints: Indices, depth: Floats) -> NDArray[np.float32]:
        away = self._attractor_depth[:, None] - depth.astype(np.float32)
        return np.asarray(self._across[:, joints] + away * away, dtype=np.float32)

    def _natural(self, piece: _Piece, pushes: Floats) -> Floats:
        """Local term (k,): how natural the angle to the piece before is after each push (paper: equation 4)."""
        if piece.before < 0:
            return np.ones(len(pushes))
        before = self._chord(self.pieces[piece.before].joints, np.zeros(1))
        angle = _angles_rad(before, self._chord(piece.joints, pushes))
        sigma = np.pi * (self._deepest - piece.depth + 1) / (self._deepest + 1)
        return np.asarray(np.exp(-((angle - self._expected[piece.goes_on]) ** 2) / (2 * sigma**2)))

    def _chord(self, joints: Indices, pushes: Floats) -> Floats:
        """Return the ways (k, 3) from a piece's start to its pushed end."""
        start, end = joints[[0, -1]]
        across = self.flat.points[end, :2] - self.flat.points[start, :2]
        deep = self.depth[end] - self.depth[start] + pushes
        return np.column_stack([np.broadcast_to(across, (len(pushes), 2)), deep])

    def _mean_angle(self, goes_on: bool) -> float:
        """Mean angle between pieces and those before them in the picture, radians (paper: mu)."""
        here = [piece for piece in self.pieces if piece.before >= 0 and piece.goes_on == goes_on]
        none = np.zeros(1)
        chords = ((self._chord(self.pieces[p.before].joints, none), self._chord(p.joints, none)) for p in here)
        found = [float(_angles_rad(before, after)[0]) for before, after in chords]
        return float(np.mean(found)) if found else 0.0


def _last_descendants(tree: Skeleton) -> list[Indices]:
    """List the joints that hang on each joint."""
    found: list[list[int]] = [[] for _ in range(len(tree))]
    for joint in range(len(tree) - 1, 0, -1):
        if (parent := int(tree.parents[joint])) >= 0:
            found[parent] += [joint, *found[joint]]
    return [np.array(sorted(joints), dtype=np.int64) for joints in found]


def _angles_rad(one: Floats, others: Floats) -> Floats:
    """Angles (k,) between a direction (1, 3) and others (k, 3), radians."""
    lengths = np.linalg.norm(one, axis=1) * np.linalg.norm(others, axis=1)
    return np.asarray(np.arccos(np.clip((one * others).sum(axis=1) / np.maximum(lengths, 1e-12), -1.0, 1.0)))


def _attractors(volume: CrownVolume, count: int) -> Floats:
    """Spread about ``count`` places (m, 3), metres, evenly over a crown's surface."""
    low, high = volume.bounds[:, 1].tolist()
    levels = max(3, round(np.sqrt(count / 2)))
    heights = low + (np.arange(levels) + 0.5) / levels * (high - low)
    middle, wide = volume.axis(heights), volume.half_width(heights)
    deep = volume.half_depth(middle)
    around = np.maximum(np.round(count * wide / max(float(wide.sum()), 1e-9)), 1).astype(np.int64)
    level = np.repeat(np.arange(levels), around)
    turn = np.concatenate([(np.arange(n) + 0.5 * (k % 2)) / n for k, n in enumerate(around.tolist())]) * 2 * np.pi
    out = np.column_stack([wide[level] * np.cos(turn), np.zeros(len(level)), deep[level] * np.sin(turn)])
    return np.asarray(middle[level] + out)
