"""Trace a solved capture: where its photos show the tree, its visible branches after edits, its crown."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import numpy as np

from treestroke.codec.skeleton import plain_grown
from treestroke.core.capture import CapturedPhoto, Structure
from treestroke.core.geometry.clumped_crown import Cells
from treestroke.core.geometry.surface_nets import surface
from treestroke.core.imaging.outline import rings_of_mask
from treestroke.core.pipeline.edited_views import at_height, edited_views, traced_views
from treestroke.core.pipeline.grown_tree import LiveTree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.viewing import ViewsEvidence, live_views
from treestroke.core.skeleton.branch_edits import BranchEdit
from treestroke.core.strokes import CaptureStrokes
from treestroke.core.types import Floats
from treestroke.core.undistortion import distorted_points
from treestroke.service.execution import one_thread
from treestroke.service.report import plain_taken

MOST_TRIANGLES = 4000
"""Most triangles of a crown's surface."""
_PX_DIGITS = 1
"""Decimals of a pixel of an outline: it was found in a picture that is no larger than the photo."""
_SHARE_DIGITS = 5
"""Decimals of a length in the capture's frame, for a tree that is one unit high there."""


@dataclass(frozen=True, eq=False)
class CaptureReading:
    """What the photos of a capture show, before any edit: the recipe's own ``evidence``, and plain values of it."""

    evidence: ViewsEvidence

    @cached_property
    def photos(self) -> list[dict[str, Any]]:
        """Where each photo that is used shows the tree, as plain values: closed rings, px of the upright photo."""
        read = zip(self.evidence.photos, self.evidence.structure.photos, self.evidence.mattes, strict=True)
        return [
            {
                "photo": photo.name,
                "foliage": [
                    (distorted_points(ring, solved) / photo.reduction).round(_PX_DIGITS).tolist()
                    for ring in rings_of_mask(matte.tree)
                ],
            }
            for photo, solved, matte in read
        ]

    @cached_property
    def crown(self) -> dict[str, Any]:
        """The surface of the cells that no photo excludes from the tree, as plain values in the capture's frame."""
        crown = self.evidence.crown
        points, triangles = surface(Cells(crown.hull, crown.cells.corner, crown.cells.side), MOST_TRIANGLES)
        guessed = crown.guessed_at(points)
        return {
            "points": _rounded(self.evidence, self.evidence.frame.inverse.points(points)),
            "triangles": triangles.tolist(),
            "guessed": guessed.tolist(),
        }


def read_capture(photos: Sequence[CapturedPhoto], structure: Structure, drawn: CaptureStrokes) -> CaptureReading:
    """Read photos of a capture; ``drawn`` is in px of the upright photos.

    Raises
    ------
    StrokesError, CaptureError
        As `traced_views`.
    """
    with one_thread():
        return CaptureReading(traced_views(photos, structure, drawn))


def trace_capture(
    reading: CaptureReading, edits: Sequence[BranchEdit], settings: ModelSettings, grow: bool
) -> dict[str, Any]:
    """Return a capture's trace as plain values: what was read, the branches after ``edits``, warnings.

    With ``grow`` also the tree that grows by ``settings`` and seed 0.
    """
    evidence = edited_views(reading.evidence, edits)
    standing = at_height(evidence, settings.height)
    values = {
        "photos": reading.photos,
        "skeleton": _plain_branches(evidence),
        "crown": reading.crown,
        "tree_from_capture": standing.frame.matrix.tolist(),
        "taken": plain_taken(evidence.front.taken(ModelSettings())),
        "warnings": [asdict(warning) for warning in evidence.warnings],
    }
    return {**values, **(_plain_growth(standing, settings) if grow else {})}


def _plain_branches(evidence: ViewsEvidence) -> dict[str, Any]:
    """Return the visible branches in the capture's frame."""
    skeleton, back = evidence.seen.skeleton, evidence.frame.inverse
    return {
        "points": _rounded(evidence, back.points(skeleton.points)),
        "radii": _rounded(evidence, back.scale * skeleton.radii),
        "parents": skeleton.parents.tolist(),
        "seen": evidence.seen.seen.tolist(),
    }


def _plain_growth(evidence: ViewsEvidence, settings: ModelSettings) -> dict[str, Any]:
    with one_thread():
        grown: LiveTree = live_views(evidence, settings, np.random.default_rng(0))
    plain = plain_grown(grown)
    return {"grown": plain, "photo": plain["photo"]}


def _rounded(evidence: ViewsEvidence, lengths: Floats) -> list[Any]:
    """Return lengths in the capture's frame, to a small share of the tree's height there."""
    height = float(np.ptp(evidence.crown.bounds[:, 1])) / evidence.frame.scale
    digits = _SHARE_DIGITS - int(np.ceil(np.log10(max(height, 1e-9))))
    plain: list[Any] = lengths.round(digits).tolist()
    return plain
