"""The strokes a person draws over a photo, as values."""

from dataclasses import dataclass, field

from treestroke.core.geometry.camera import Floats


@dataclass(frozen=True, eq=False)
class Stroke:
    """One drawn line: points (n, 2) in px of the upright photo, n >= 2; width in px where the person gave one."""

    points: Floats
    width: float | None = None


@dataclass(frozen=True, eq=False)
class Strokes:
    """All strokes of one tree.

    Attributes
    ----------
    crown
        Closed outline around the foliage (its last point joins its first).
    branches
        The first runs from the root up the trunk, each later one outward from its parent.
    erase
        Each drops the traced (not stroked) branches that it crosses.
    """

    crown: Stroke
    branches: tuple[Stroke, ...] = ()
    erase: tuple[Stroke, ...] = ()


@dataclass(frozen=True)
class StrokeWarning:
    """Something mended: ``code`` for programs, ``stroke`` (a pointer such as ``branches/1``), ``detail`` for people."""

    code: str
    stroke: str
    detail: str


@dataclass(frozen=True, eq=False)
class MendedStrokes:
    """Strokes that can be used, and what was mended to make them so."""

    strokes: Strokes
    warnings: tuple[StrokeWarning, ...] = field(default=())
