"""Measured motion as plain values for files and reports."""

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from treestroke.core.pipeline.measured_motion import MeasuredMotion


def plain_motion(motion: "MeasuredMotion") -> dict[str, Any]:
    """Return the facts of a measured motion: its frames, its loop (seconds), and how each branch swings.

    A frequency is given with how sure it is, 0 to 1; the damping, a share of the critical one, is None where the clip
    is too short to tell it.
    """
    found = motion.swings
    rows = zip(
        motion.bones.tolist(),
        motion.sway.tolist(),
        found.frequency_hz.tolist(),
        found.damping.tolist(),
        found.sureness.tolist(),
        strict=True,
    )
    return {
        "frames_per_second": motion.frames_per_second,
        "frames": motion.frames,
        "loop": round(motion.loop_seconds, 6),
        "measured": {
            "tracks": motion.tracks,
            "followed": round(motion.followed, 3),
            "branches": [
                {
                    "bone": motion.rig.names[bone],
                    "sway_m": round(sway, 4),
                    "frequency_hz": round(hertz, 3),
                    "damping": None if math.isnan(damping) else round(damping, 3),
                    "sureness": round(sure, 2),
                }
                for bone, sway, hertz, damping, sure in rows
            ],
        },
    }
