"""What the photos of a capture show, after a person's edits, or for another height of the tree."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from treestroke.core.geometry.similarity import Similarity
from treestroke.core.pipeline.tree_frame import cloud_in_frame, in_frame
from treestroke.core.pipeline.viewing import ViewsEvidence
from treestroke.core.skeleton.branch_edits import BranchEdit, LostEdit, edited, edits_in_frame
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import StrokeWarning


def edited_views(evidence: ViewsEvidence, edits: Sequence[BranchEdit]) -> ViewsEvidence:
    """Apply edits, which are in the structure's frame, to the visible branches; warnings tell which were left out."""
    found = edited(evidence.seen.skeleton, evidence.seen.seen, edits_in_frame(edits, evidence.frame))
    seen = replace(evidence.seen, skeleton=found.skeleton, seen=found.seen)
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
