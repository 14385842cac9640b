"""What the photos of a capture show as they are traced, after a person's edits, or for another height of the tree."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from treestroke.core.capture import CapturedPhoto, Structure
from treestroke.core.geometry.similarity import Similarity
from treestroke.core.pipeline.captured_photos import TRACED_SIDE, reduced
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.tree_frame import cloud_in_frame, in_frame
from treestroke.core.pipeline.viewing import ViewsEvidence, read_views
from treestroke.core.skeleton.branch_edits import BranchEdit, LostEdit, edited, edits_in_frame
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import CaptureStrokes, StrokeWarning


def traced_views(photos: Sequence[CapturedPhoto], structure: Structure, drawn: CaptureStrokes) -> ViewsEvidence:
    """Read the photos of a capture as they are read for tracing: small, and a tree without a scale at a usual height.

    Raises
    ------
    StrokesError, CaptureError
        As `read_views`.
    """
    small = [reduced(photo, TRACED_SIDE) for photo in photos]
    return read_views(small, structure, drawn, ModelSettings().height)


def with_edits(evidence: ViewsEvidence, traced: ViewsEvidence, edits: Sequence[BranchEdit]) -> ViewsEvidence:
    """Return evidence with the visible branches of the same capture as it was traced, after ``edits`` of them.

    Edits name joints by places, so they are applied to the very branches that the person saw: of an oak, half as many
    were seen at `TRACED_SIDE` px as at twice that, and at every fifth joint another tenth of the tree hung.
    """
    done = edited_views(traced, edits)
    over = traced.frame.inverse.then(evidence.frame)
    points = over.points(done.seen.skeleton.points)
    skeleton = Skeleton(points - points[0], over.scale * done.seen.skeleton.radii, done.seen.skeleton.parents)
    seen = replace(evidence.seen, skeleton=skeleton, seen=done.seen.seen)
    return replace(evidence, seen=seen, edited=done.edited)


def edited_views(evidence: ViewsEvidence, edits: Sequence[BranchEdit]) -> ViewsEvidence:
    """Apply edits, which are in the structure's frame, to the visible branches; warnings tell which were left out."""
    seen, top = evidence.seen, float(evidence.crown.bounds[1, 1])
    found = edited(seen.skeleton, seen.seen, edits_in_frame(edits, evidence.frame), top)
    seen = replace(seen, skeleton=found.skeleton, seen=found.seen)
    return replace(evidence, seen=seen, edited=tuple(_told(lost) for lost in found.lost))


def at_height(evidence: ViewsEvidence, height_m: float) -> ViewsEvidence:
    """Return what would have been read of a tree that is ``height_m`` high; one with a scale stays as it is."""
    factor = height_m / evidence.height_m
    if evidence.known or factor == 1:
        return evidence
    larger, skeleton = Similarity(np.zeros(3), np.eye(3), factor), evidence.seen.skeleton
    seen = replace(
        evidence.seen,
        skeleton=Skeleton(factor * skeleton.points, factor * skeleton.radii, skeleton.parents),
        leaf_points=factor * evidence.seen.leaf_points,
    )
    return replace(
        evidence,
        shots=tuple(in_frame(shot, larger) for shot in evidence.shots),
        cloud=cloud_in_frame(evidence.cloud, larger),
        crown=evidence.crown.scaled(factor),
        seen=seen,
        height_m=height_m,
        frame=evidence.frame.then(larger),
    )


def _told(lost: LostEdit) -> StrokeWarning:
    return StrokeWarning("edit_lost", f"edits/{lost.index}", f"this edit was left out: {lost.detail}")
