"""How a tree moves in 3D: as a clip shows it, or, of a sibling, as was learnt from its example."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.film.motion_field import motion_field
from treestroke.core.film.spectra import Swings, swings
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.pipeline.grown_tree import Filmed, LearntMotion
from treestroke.core.siblings.motion_model import Turns, learn_motion
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.sway.bones import MOST_MEASURED, rig_of
from treestroke.core.sway.measured import Seen, across_bones, fluttered, heads_in_motion, looped, repeated, turns_of
from treestroke.core.sway.motion import Animation, Rig
from treestroke.core.sway.stiffness import moving_branches, thickness
from treestroke.core.types import Floats, Indices


@dataclass(frozen=True, eq=False)
class Measurement:
    """What a clip shows of a tree's motion.

    Attributes
    ----------
    tracks, followed
        Number of points that were followed, and in how many of the frames on average, 0 to 1.
    bones
        (m,) index of the branch bones of which something is seen.
    sway
        (m,) standard deviation of the head of each in the picture, metres.
    swings
        How each swings.
    """

    tracks: int
    followed: float
    bones: Indices
    sway: Floats
    swings: Swings


@dataclass(frozen=True, eq=False)
class TreeMotion:
    """How a tree moves.

    Attributes
    ----------
    rig, animation
        Bones, and the animation ``measured`` or ``drawn``, whose first ``frames`` keyframes are the frames.
    frames, frames_per_second
        Of the clip, or of the example's.
    turns
        (f, b, 3) rotation vectors of the bones in these frames, radians, world axes at rest.
    measured
        What a clip shows; None of a sibling, whose motion is drawn.
    """

    rig: Rig
    animation: Animation
    frames_per_second: float
    turns: Floats
    measured: Measurement | None

    @property
    def frames(self) -> int:
        """Number of the frames."""
        return len(self.turns)

    @property
    def loop_seconds(self) -> float:
        """Length of the animation."""
        return float(self.animation.times[0][-1]) if self.animation.times else 0.0


def filmed_motion(
    skeleton: Skeleton, leaf_joints: Indices | None, filmed: Filmed, camera: OrthographicCamera
) -> TreeMotion:
    """Move a grown tree (metres, world) as the clip shows it; ``camera`` is that of the chosen frame."""
    rig = rig_of(skeleton, leaf_joints, MOST_MEASURED, tips=True)
    places = camera.picture_space_from_world(rig.heads)[:, :2]
    seconds = len(filmed.tracks.points) / filmed.frames_per_second
    height_px = float(camera.pixels_from_metres(rig.extent))
    field = motion_field(filmed.tracks, places, height_px, filmed.chosen, seconds)
    moved = camera.metres_from_pixels(field.moved) * np.array([1.0, -1.0])
    error = camera.metres_from_pixels(field.error_px)
    turns = turns_of(rig, Seen(moved, error, filmed.frames_per_second))
    bones = np.flatnonzero(moving_branches(rig) & np.isfinite(error))
    across = turns[:, bones, 2]  # a turn about the line of sight is what the picture shows best
    measured = Measurement(
        tracks=len(filmed.tracks),
        followed=float(filmed.tracks.seen.mean()) if len(filmed.tracks) else 0.0,
        bones=bones,
        sway=np.linalg.norm(moved[:, bones].std(axis=0), axis=1),
        swings=swings(across, filmed.frames_per_second),
    )
    animation = looped(fluttered(rig, turns, filmed.frames_per_second), filmed.frames_per_second)
    return TreeMotion(rig, animation, filmed.frames_per_second, turns, measured)


def learnt_motion(skeleton: Skeleton, filmed: Filmed, camera: OrthographicCamera) -> LearntMotion:
    """Learn from a filmed tree (metres, world) how its siblings move."""
    motion = filmed_motion(skeleton, None, filmed, camera)
    branches = np.flatnonzero(moving_branches(motion.rig))
    model = learn_motion(motion.turns[:, branches], _branches(motion.rig, branches))
    return LearntMotion(model, filmed.frames_per_second, _sway(motion.rig, motion.turns))


def drawn_motion(
    skeleton: Skeleton, leaf_joints: Indices | None, learnt: LearntMotion, rng: np.random.Generator
) -> TreeMotion:
    """Move a sibling (metres, world) by what was learnt of its example."""
    rig = rig_of(skeleton, leaf_joints, MOST_MEASURED, tips=True)
    branches = np.flatnonzero(moving_branches(rig))
    turns = np.zeros((learnt.model.frames, len(rig.names), 3))
    turns[:, branches] = learnt.model.draw(_branches(rig, branches), rng)
    # on the example, branches make good for what those below them do; drawn ones add up, and would sway further
    turns *= learnt.sway / max(_sway(rig, turns), 1e-9)
    animation = repeated(fluttered(rig, turns, learnt.frames_per_second), learnt.frames_per_second)
    return TreeMotion(rig, animation, learnt.frames_per_second, turns, None)


def _sway(rig: Rig, turns: Floats) -> float:
    """Return how far the heads of branch bones sway in the median, a standard deviation, over the tree's extent."""
    heads = heads_in_motion(rig, turns)[:, moving_branches(rig)]
    return float(np.median(np.linalg.norm(heads.std(axis=0), axis=1))) / rig.extent


def _branches(rig: Rig, branches: Indices) -> Turns:
    """Return what a model of motion sees of a rig's branch bones."""
    along, axes = across_bones(rig)
    return Turns(along[branches], axes[branches], thickness(rig)[branches])
