"""How a tree that was filmed moves in 3D: its rig, its animation, and how its branches swing."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.film.motion_field import motion_field
from treestroke.core.film.spectra import Swings, swings
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.pipeline.grown_tree import Filmed
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.sway.bones import MOST_MEASURED, rig_of
from treestroke.core.sway.measured import Seen, looped, turns_of
from treestroke.core.sway.motion import Animation, Rig
from treestroke.core.sway.stiffness import moving_branches
from treestroke.core.types import Floats, Indices


@dataclass(frozen=True, eq=False)
class MeasuredMotion:
    """The motion that a clip shows.

    Attributes
    ----------
    rig, animation
        Bones, and the animation ``measured``, whose first ``frames`` keyframes are the clip's frames.
    frames, frames_per_second
        Those of the clip.
    tracks, followed
        Number of points that were followed, and in how many of the frames on average, 0 to 1.
    bones
        (m,) index of the branch bones of which something is seen.
    sway
        (m,) standard deviation of the end of each in the picture, metres.
    swings
        How each swings.
    """

    rig: Rig
    animation: Animation
    frames: int
    frames_per_second: float
    tracks: int
    followed: float
    bones: Indices
    sway: Floats
    swings: Swings

    @property
    def loop_seconds(self) -> float:
        """Length of the animation."""
        return float(self.animation.times[0][-1]) if self.animation.times else 0.0


def measured_motion(
    skeleton: Skeleton, leaf_joints: Indices | None, filmed: Filmed, camera: OrthographicCamera
) -> MeasuredMotion:
    """Move a grown tree (metres, world) as the clip shows it; ``camera`` is that of the chosen frame."""
    rig = rig_of(skeleton, leaf_joints, MOST_MEASURED, tips=True)
    places = camera.picture_space_from_world(rig.heads)[:, :2]
    seconds = len(filmed.tracks.points) / filmed.frames_per_second
    field = motion_field(filmed.tracks, places, rig.extent / camera.metres_per_pixel, filmed.chosen, seconds)
    moved = field.moved * camera.metres_per_pixel * np.array([1.0, -1.0])
    error = field.error_px * camera.metres_per_pixel
    turns = turns_of(rig, Seen(moved, error, filmed.frames_per_second))
    bones = np.flatnonzero(moving_branches(rig) & np.isfinite(error))
    across = turns[:, bones, 2]  # a turn about the line of sight is what the picture shows best
    return MeasuredMotion(
        rig=rig,
        animation=looped(turns, filmed.frames_per_second),
        frames=len(turns),
        frames_per_second=filmed.frames_per_second,
        tracks=len(filmed.tracks),
        followed=float(filmed.tracks.seen.mean()),
        bones=bones,
        sway=np.linalg.norm(moved[:, bones].std(axis=0), axis=1),
        swings=swings(across, filmed.frames_per_second),
    )
