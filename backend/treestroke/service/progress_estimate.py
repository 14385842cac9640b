"""An estimate of how far a job is, by the phases that it goes through and about how long each takes."""

from collections.abc import Mapping, Sequence
from itertools import accumulate

from treestroke.codec.inputs import SourceName
from treestroke.core.pipeline.settings import ModelSettings

_READING: Mapping[SourceName, Mapping[str, float]] = {
    "photo": {"decode": 0.06, "foliage": 0.45, "trace": 0.14},
    "views": {"decode": 4.0, "mattes": 28.0, "hull": 7.0, "density": 6.0, "points": 28.0, "branches": 35.0},
    "clip": {"decode": 3.0, "foliage": 0.45, "trace": 0.14, "follow": 5.0},
    "sketches": {"decode": 0.02, "trace": 0.2},
}
_FROM_ONE_SIDE: Mapping[str, float] = {"lift": 0.02, "grow": 0.35, "leaf": 0.35, "mesh": 0.3}
_GROWING: Mapping[SourceName, Mapping[str, float]] = {
    "photo": _FROM_ONE_SIDE,
    "views": {"grow": 27.0, "leaf": 35.0, "mesh": 1.5},
    "clip": {**_FROM_ONE_SIDE, "motion": 0.6},
    "sketches": _FROM_ONE_SIDE,
}
_PREVIEW = 0.6
_LEVELS, _WRITE, _COMPRESS = 3.0, 0.1, 0.8
_FILES: Mapping[str, float] = {"gltf": 0.1, "obj": 1.0, "usdz": 1.0, "ply": 0.2, "instanced": 0.2}
_SMALL_FILE = 0.05
"""Seconds of each phase and file, measured on photos of 1500 px, of a capture on 18 photos; only ratios matter."""


class ProgressEstimate:
    """The phases that one job goes through in order, each with about how long it takes."""

    def __init__(self, phases: Sequence[tuple[str, float]]) -> None:
        self._names = [name for name, _ in phases]
        self._ends = list(accumulate(seconds for _, seconds in phases))
        self._at = 0

    def progress(self, phase: str, fraction: float) -> float:
        """Return the share of the job, 0 to 1, that is done when a phase is at this fraction; it never falls."""
        self._at = self._names.index(phase, self._at) if phase in self._names[self._at :] else self._at
        start = self._ends[self._at - 1] if self._at else 0.0
        return (start + fraction * (self._ends[self._at] - start)) / self._ends[-1]


def model_phases(settings: ModelSettings, source: SourceName) -> list[tuple[str, float]]:
    """Return the phases of one model; those of growth are repeated for each variant and sibling."""
    each = {**_GROWING[source], "levels": 0.0 if settings.lod == "none" else _LEVELS, "write": _writing(settings)}
    return [
        *_READING[source].items(),
        *(list(each.items()) * (settings.variants + settings.siblings)),
        ("preview", _PREVIEW),
    ]


def _writing(settings: ModelSettings) -> float:
    levels = 1 if settings.lod == "none" else 2
    further = sum(_FILES.get(file, _SMALL_FILE) for file in settings.files)
    return levels * (_WRITE + (_COMPRESS if settings.compress else 0.0)) + further
