"""Motion in 3D from how a tree moves in the picture: bones keep their length and turn.

Source: Li et al. 2011, section 4. The paper takes, from the root to the tips, for each branch the rotation of highest
posterior: a normal track term about the tracked point, times a normal shape term about its angle in the first frame.
Both are squares in the logarithm, and rotations in the wind are small, so that the posterior of all branches together
has its maximum where a linear system is solved, and no branch has to mend what was decided for its parent:
docs/decisions/0019.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.vectors import unit
from treestroke.core.sway.motion import Animation, Rig
from treestroke.core.sway.stiffness import fluttering, moving_branches, softness
from treestroke.core.sway.wind import quaternions
from treestroke.core.types import Floats, Indices

SHAPE_RAD = 0.06
"""Standard deviation of the turn of a branch of middling thickness."""
TRACK = 0.0015
"""Standard deviation of what is known of a place where tracks agree, over the tree's height."""
DOUBT = 2.0
"""Factor on the standard error of what is seen: tracks near each other err alike."""
SOFTEST, STIFFEST = 4.0, 0.1
"""Bounds of the turn's standard deviation by thickness, over that of a branch of middling thickness."""
MOST_RAD = 0.7
"""Greatest turn of a branch about the one that it grows from, and..."""
MOST_RAD_S = 6.0
"""... its greatest speed, radians a second."""
RETURN_SECONDS = 0.6
"""Time in which the pose of the last frame becomes that of the first, so that the animation loops."""
_CORRECTIONS = 2  # times the solution is corrected by what turns differ from small ones
_DELAY_S = 0.12  # by which a branch of middling thickness that is not seen follows its parent
_FOLLOWS = 0.5  # share of its parent's turn
_FLUTTER_HZ = 2.6
_FLUTTER = 0.35  # of the speed of the branch's end, m/s, as a turn of its leaves, rad
_MOST_FLUTTER = 0.25
_GOLDEN = 0.6180339887498949


@dataclass(frozen=True, eq=False)
class Seen:
    """What a video shows of the motion of a rig's bones.

    Attributes
    ----------
    moved
        (f, b, 2) how far each bone's head is from where it is at rest, metres: to the picture's right, and up.
    error
        (b,) standard error of that, metres; infinite where nothing is known.
    frames_per_second
        Of the frames.
    """

    moved: Floats
    error: Floats
    frames_per_second: float


def turns_of(rig: Rig, seen: Seen) -> Floats:
    """Return the rotation vectors (f, b, 3), radians, world axes at rest, by which bones turn about their heads.

    Those of highest posterior, bounded in angle and speed. Branches of which nothing is seen follow their parents later
    and less, as thick as they are. Flutter bones swing as fast as their branch moves.
    """
    axes = _axes(rig)
    solve = _Posterior(rig, axes, seen.error)
    turns = solve(seen.moved)
    for _ in range(_CORRECTIONS):
        bent = heads_in_motion(rig, turns)[:, :, :2] - rig.heads[:, :2]
        turns = _bounded(solve(seen.moved - (bent - solve.straight(turns))), seen.frames_per_second)
    turns = _followed(rig, turns, solve.known, seen.frames_per_second)
    return turns + _flutter(rig, turns, seen.frames_per_second)


def looped(turns: Floats, frames_per_second: float) -> Animation:
    """Make an animation ``measured`` of the turns (f, b, 3) of each frame, which then leads back to the first."""
    back = max(2, round(RETURN_SECONDS * frames_per_second))
    whole = np.concatenate([turns, _return(turns, back)])
    bones = tuple(np.flatnonzero(np.abs(whole).max(axis=(0, 2)) > 0).tolist())
    times = np.arange(len(whole)) / frames_per_second
    rotations = tuple(quaternions(whole[:, bone]) for bone in bones)
    return Animation("measured", bones, (times,) * len(bones), rotations, many=True)


def heads_in_motion(rig: Rig, turns: Floats) -> Floats:
    """Return where the heads of bones (f, b, 3) are, metres, world, when bones turn by vectors (f, b, 3)."""
    heads = np.tile(rig.heads, (len(turns), 1, 1))
    world = np.tile(np.eye(3), (len(turns), len(rig.names), 1, 1))
    local = _matrices(turns)
    for bone, parent in enumerate(rig.parents.tolist()):
        if parent >= 0:
            heads[:, bone] = heads[:, parent] + world[:, parent] @ (rig.heads[bone] - rig.heads[parent])
            world[:, bone] = world[:, parent] @ local[:, bone]
    return heads


class _Posterior:
    """The turns of highest posterior for what is seen: one linear system for all frames."""

    def __init__(self, rig: Rig, axes: Floats, error: Floats) -> None:
        self._axes = axes
        self._branches = np.flatnonzero(moving_branches(rig))
        ancestors = _ancestors(rig)
        places = np.flatnonzero(~fluttering(rig))[1:]
        arms = rig.heads[places, None] - rig.heads[self._branches]
        moves = ancestors[rig.parents[places]][:, self._branches]
        design = np.cross(axes[self._branches], arms[:, :, None])[..., :2] * moves[:, :, None, None]
        self._places = places
        self._design = design.transpose(0, 3, 1, 2).reshape(2 * len(places), -1)
        weight = np.repeat(1.0 / ((TRACK * rig.extent) ** 2 + (DOUBT * error[places]) ** 2), 2)
        soft = softness(rig)[self._branches]
        bend = SHAPE_RAD * np.clip(soft / np.median(soft), STIFFEST, SOFTEST)
        evidence = self._design.T @ (self._design * weight[:, None])
        self._pull = np.linalg.solve(evidence + np.diag(np.repeat(bend**-2.0, 2)), self._design.T * weight)
        self.known = np.zeros(len(rig.names), dtype=bool)
        self.known[self._branches] = (np.isfinite(error[places, None]) & moves).any(axis=0)

    def straight(self, turns: Floats) -> Floats:
        """Return how far heads (f, b, 2) would move by turns (f, b, 3), if these were small."""
        along = np.einsum("fbx,bax->fba", turns[:, self._branches], self._axes[self._branches])
        moved = np.zeros((*turns.shape[:2], 2))
        moved[:, self._places] = (along.reshape(len(turns), -1) @ self._design.T).reshape(len(turns), -1, 2)
        return moved

    def __call__(self, moved: Floats) -> Floats:
        """Return the turns (f, b, 3) for how far the bones' heads moved (f, b, 2)."""
        flat = moved[:, self._places].reshape(len(moved), -1)
        found = (flat @ self._pull.T).reshape(len(moved), -1, 2)
        turns = np.zeros((len(moved), moved.shape[1], 3))
        turns[:, self._branches] = np.einsum("fba,bax->fbx", found, self._axes[self._branches])
        return turns


def _axes(rig: Rig) -> Floats:
    """Return the two axes (b, 2, 3) about which each bone turns: across it, the first as near to the view as can be."""
    along = unit(rig.ends - rig.heads, np.array([0.0, 1.0, 0.0]))
    view = np.array([0.0, 0.0, 1.0])
    first = unit(view - along * (along @ view)[:, None], np.array([1.0, 0.0, 0.0]))
    return np.stack([first, np.cross(along, first)], axis=1)


def _ancestors(rig: Rig) -> NDArray[np.bool_]:
    """Tell which bones (b, b) each bone turns with: itself, and those on the path to the root, without the root."""
    found = np.eye(len(rig.names), dtype=bool)
    for bone in range(1, len(rig.names)):
        found[bone] |= found[rig.parents[bone]]
    found[:, 0] = False
    return found


def _bounded(turns: Floats, frames_per_second: float) -> Floats:
    """Bound the angle of turns (f, b, 3), and how much they change from frame to frame."""
    angle = np.linalg.norm(turns, axis=2, keepdims=True)
    turns = turns * np.minimum(1.0, MOST_RAD / np.maximum(angle, 1e-12))
    most = MOST_RAD_S / frames_per_second
    for frame in range(1, len(turns)):
        step = turns[frame] - turns[frame - 1]
        length = np.linalg.norm(step, axis=1, keepdims=True)
        turns[frame] = turns[frame - 1] + step * np.minimum(1.0, most / np.maximum(length, 1e-12))
    return turns


def _followed(rig: Rig, turns: Floats, known: NDArray[np.bool_], frames_per_second: float) -> Floats:
    """Let branches of which nothing is seen turn as their parents did a while before."""
    soft, frames = softness(rig), np.arange(len(turns))
    middling = np.median(soft[soft > 0]) if (soft > 0).any() else 1.0
    for bone in np.flatnonzero(moving_branches(rig) & ~known).tolist():
        parent = int(rig.parents[bone])
        delay = _DELAY_S * frames_per_second * np.clip(middling / soft[bone], 0.25, 4.0)
        for axis in range(3):
            turns[:, bone, axis] = _FOLLOWS * np.interp(frames - delay, frames, turns[:, parent, axis])
    return turns


def _flutter(rig: Rig, turns: Floats, frames_per_second: float) -> Floats:
    """Return the turns (f, b, 3) of flutter bones alone (Li et al. 2011, appendix B.2)."""
    out = np.zeros_like(turns)
    bones: Indices = np.flatnonzero(fluttering(rig))
    if not len(bones):
        return out
    heads = heads_in_motion(rig, turns)[:, bones]
    speed = np.linalg.norm(np.gradient(heads, axis=0), axis=2) * frames_per_second
    seconds = np.arange(len(turns)) / frames_per_second
    phase = np.arange(len(bones)) * _GOLDEN
    swing = np.sin(2.0 * np.pi * (_FLUTTER_HZ * seconds[:, None] + phase))
    angle = np.minimum(_FLUTTER * speed / rig.extent**0.5, _MOST_FLUTTER) * swing
    along = unit(rig.ends[bones] - rig.heads[bones], np.array([0.0, 1.0, 0.0]))
    out[:, bones] = angle[..., None] * along
    return out


def _return(turns: Floats, count: int) -> Floats:
    """Return the turns (count + 1, b, 3) that lead from the last frame to the first, with their speeds (Hermite)."""
    share = (np.arange(1, count + 1) / count)[:, None, None]
    leaving, coming = (turns[-1] - turns[-2]) * count, (turns[1] - turns[0]) * count
    return np.asarray(
        (2 * share**3 - 3 * share**2 + 1) * turns[-1]
        + (share**3 - 2 * share**2 + share) * leaving
        + (3 * share**2 - 2 * share**3) * turns[0]
        + (share**3 - share**2) * coming
    )


def _matrices(turns: Floats) -> Floats:
    """Convert rotation vectors (..., 3), radians, to matrices (..., 3, 3) (Rodrigues)."""
    angle = np.linalg.norm(turns, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(turns, -1, 0)
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*x.shape, 3, 3)
    half = np.sinc(angle / (2.0 * np.pi))
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * cross + 0.5 * half**2 * (cross @ cross))
