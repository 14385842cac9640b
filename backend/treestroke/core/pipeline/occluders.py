"""What stands before a tree: poles and wires are painted over, a trunk goes on down to the ground."""

from dataclasses import replace

import numpy as np

from treestroke.core.pipeline.working_copy import WorkingCopy
from treestroke.core.segment.occluders import find_poles, is_branch, painted_over
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import StrokeWarning
from treestroke.core.trace.hidden_foot import hidden_ground
from treestroke.core.trace.tracing import Traced
from treestroke.core.trace.visible_foot import visible_foot
from treestroke.core.types import Floats

LOW = 0.1
"""Length of a stem above its root that tells how thick it is above its flare, as a share of the tree's height."""


def without_poles(working: WorkingCopy, known: WorkingCopy | None = None) -> WorkingCopy:
    """Return the working copy with the poles and wires before the crown painted over, once the trunk is drawn.

    Those that are ``known`` of the same crown are kept, unless a new stroke follows one.
    """
    crown, strokes = working.strokes.crown.points, [branch.points for branch in working.strokes.branches]
    if working.cut_out is not None or not strokes:
        return working
    same = known is not None and known.frame == working.frame and bool(known.strokes.branches)
    if known is not None and same and not any(is_branch(pole, crown, strokes) for pole in known.poles):
        return replace(working, photo=known.photo, poles=known.poles)
    poles = find_poles(working.photo, crown, strokes)
    return replace(working, photo=painted_over(working.photo, poles), poles=poles) if poles else working


def poles_notice(working: WorkingCopy) -> tuple[StrokeWarning, ...]:
    """Return a warning where poles or wires were painted over."""
    if not working.poles:
        return ()
    what = "a pole or wire" if len(working.poles) == 1 else f"{len(working.poles)} poles or wires"
    detail = f"{what} before the crown was taken for no part of the tree; a branch stroke along one makes it a branch"
    return (StrokeWarning("pole_removed", "crown", detail),)


def on_the_ground(working: WorkingCopy, traced: Traced, height_px: float) -> tuple[WorkingCopy, Traced]:
    """Return both with all stems going on down to the ground, where the trunk's stroke begins above it.

    It does so if the photo shows the trunk to go on, and if a hedge, fence or car hides its foot. ``height_px`` is the
    height of the visible tree. What is added keeps the width of the stem above.
    """
    trunk, *others = working.strokes.branches
    if working.cut_out is not None:
        return working, traced
    root, wood = trunk.points[0], traced.skeleton
    low = (traced.stroke == 0) & (root[1] - wood.points[:, 1] <= LOW * height_px)
    seen = visible_foot(traced.wood, root, float(wood.radii[low].min()), height_px)
    ground = hidden_ground(working.photo, root if seen is None else seen, height_px)
    foot = seen if ground is None else np.array([root[0] if seen is None else seen[0], ground])
    if foot is None:
        return working, traced
    warning = _foot_notice(ground is not None, (foot[1] - root[1]) / working.frame.scale)
    longer = replace(trunk, points=np.vstack([foot, trunk.points]))
    strokes = replace(working.strokes, branches=(longer, *others))
    return replace(working, strokes=strokes, warnings=(*working.warnings, warning)), _standing(traced, foot)


def _foot_notice(hidden: bool, added_px: float) -> StrokeWarning:
    """Return the warning that a trunk goes on to the ground, by ``added_px`` px of the photo."""
    added = f"goes on to the ground, by {added_px:.0f} px; draw it to where it stands"
    if hidden:
        return StrokeWarning("trunk_completed", "branches/0", f"something hides its foot, and it {added}")
    return StrokeWarning("trunk_lengthened", "branches/0", f"it begins above the trunk's foot, and {added}")


def _standing(traced: Traced, foot: Floats) -> Traced:
    """Return traced branches with a joint at the ground below each root, the first one's at a ``foot`` (2,), px."""
    wood = traced.skeleton
    roots = np.flatnonzero(wood.parents < 0)
    aside = foot[0] - wood.points[0, 0]
    feet = np.column_stack([wood.points[roots, 0] + aside, np.maximum(wood.points[roots, 1], foot[1])])
    parents = wood.parents + len(roots)
    parents[roots] = np.arange(len(roots))
    skeleton = Skeleton(
        np.vstack([feet, wood.points]),
        np.concatenate([wood.radii[roots], wood.radii]),
        np.concatenate([np.full(len(roots), -1), parents]),
    )
    stroke = np.concatenate([traced.stroke[roots], traced.stroke])
    measured = np.concatenate([np.zeros(len(roots), dtype=np.bool_), traced.measured])
    return replace(traced, skeleton=skeleton, stroke=stroke, measured=measured)
