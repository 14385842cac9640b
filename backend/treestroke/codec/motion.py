"""Measured motion as plain values for files and reports."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from treestroke.core.pipeline.tree_motion import Measurement, TreeMotion


def plain_motion(motion: "TreeMotion") -> dict[str, Any]:
    """Return the facts of a tree's motion: its frames, its loop (seconds), and, of a clip, how each branch swings.

    A frequency is given with how sure it is, 0 to 1; the damping, a share of the critical one, is None where the clip
    is too short to tell it.
    """
    facts = {
        "frames_per_second": motion.frames_per_second,
        "frames": motion.frames,
        "loop": round(motion.loop_seconds, 6),
    }
    return facts if motion.measured is None else {**facts, "measured": _plain(motion.measured, motion.rig.names)}


def _plain(measured: "Measurement", names: Sequence[str]) -> dict[str, Any]:
    """Return what a clip shows of bones with these names."""
    found = measured.swings
    rows = zip(
        measured.bones.tolist(),
        measured.sway.tolist(),
        found.frequency_hz.tolist(),
        found.damping.tolist(),
        found.sureness.tolist(),
        strict=True,
    )
    return {
        "tracks": measured.tracks,
        "followed": round(measured.followed, 3),
        "branches": [
            {
                "bone": names[bone],
                "sway_m": round(sway, 4),
                "frequency_hz": round(hertz, 3),
                "damping": None if math.isnan(damping) else round(damping, 3),
                "sureness": round(sure, 2),
            }
            for bone, sway, hertz, damping, sure in rows
        ],
    }
