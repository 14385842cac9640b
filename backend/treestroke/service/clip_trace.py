"""The trace of a clip as plain values: what the frame that was drawn on shows, and the tracks through all frames."""

import math
from typing import Any

import numpy as np

from treestroke.core.film.tracks import Tracks
from treestroke.core.pipeline.filming import ClipTrace
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.strokes import FrameStrokes
from treestroke.core.video import Video
from treestroke.service.trace import trace_values

_MOST_PLACES = 60_000
"""Most places of all tracks together that an answer holds; of longer clips one frame of several is told."""
_PX_DIGITS = 1


def plain_trace(video: Video, drawn: FrameStrokes, traced: ClipTrace, growing: ModelSettings | None) -> dict[str, Any]:
    """Return what was traced as plain values; with settings also the skeleton that grows by them and seed 0."""
    found = trace_values(video.picture, drawn.strokes, traced.photo, growing)
    notes = [{"code": note.code, "stroke": note.stroke, "detail": note.detail} for note in video.notes]
    return {
        **found,
        "warnings": [*notes, *found["warnings"]],
        "frame": drawn.frame,
        "tracks": _plain_tracks(traced.tracks, video.frames_per_second, drawn.frame - video.chosen),
    }


def _plain_tracks(tracks: Tracks, frames_per_second: float, before: int) -> dict[str, Any]:
    """Return tracks by frames of the whole clip, of which so many come ``before`` the part that is used."""
    count, followed = tracks.seen.shape
    every = max(1, math.ceil((before + count) * followed / _MOST_PLACES))
    told = range(0, before + count, every)
    points = tracks.points.round(_PX_DIGITS).tolist()
    seen = (tracks.seen & np.isfinite(tracks.points).all(axis=2)).tolist()
    return {
        "frames_per_second": frames_per_second,
        "every": every,
        "points": [
            [points[at - before][one] if at >= before and seen[at - before][one] else None for at in told]
            for one in range(followed)
        ],
    }
