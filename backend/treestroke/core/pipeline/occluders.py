"""What stands before a tree: poles and wires are painted over, a hidden trunk goes on down to the ground."""

from dataclasses import replace

import numpy as np

from treestroke.core.pipeline.working_copy import WorkingCopy
from treestroke.core.segment.occluders import find_lines, is_branch, painted_over
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import StrokeWarning
from treestroke.core.trace.hidden_foot import hidden_ground
from treestroke.core.trace.tracing import Traced


def without_lines(working: WorkingCopy, known: WorkingCopy | None = None) -> WorkingCopy:
    """Return the working copy with the poles and wires before the crown painted over, once the trunk is drawn.

    Those that are ``known`` of the same crown are kept, unless a new stroke follows one.
    """
    crown, strokes = working.strokes.crown.points, [branch.points for branch in working.strokes.branches]
    if working.cut_out is not None or not strokes:
        return working
    same = known is not None and known.frame == working.frame and bool(known.strokes.branches)
    if known is not None and same and not any(is_branch(line, crown, strokes) for line in known.lines):
        return replace(working, photo=known.photo, lines=known.lines)
    lines = find_lines(working.photo, crown, strokes)
    return replace(working, photo=painted_over(working.photo, lines), lines=lines) if lines else working


def lines_notice(working: WorkingCopy) -> tuple[StrokeWarning, ...]:
    """Return a warning where poles or wires were painted over."""
    if not working.lines:
        return ()
    what = "a pole or wire" if len(working.lines) == 1 else f"{len(working.lines)} poles or wires"
    detail = f"{what} before the crown was taken for no part of the tree; a branch stroke along one makes it a branch"
    return (StrokeWarning("line_removed", "crown", detail),)


def on_the_ground(working: WorkingCopy, traced: Traced, height_px: float) -> tuple[WorkingCopy, Traced]:
    """Return both with all stems going on to the ground, where a hedge, fence or car hides the trunk's foot.

    ``height_px`` is the height of the visible tree. What is added keeps the width of the stem above.
    """
    trunk, *others = working.strokes.branches
    ground = None if working.cut_out is not None else hidden_ground(working.photo, trunk.points[0], height_px)
    if ground is None:
        return working, traced
    x, end = trunk.points[0]
    longer = replace(trunk, points=np.vstack([[x, ground], trunk.points]))
    by = f"{(ground - end) / working.frame.scale:.0f} px"
    detail = f"something hides its foot, and it goes on to the ground, by {by}; draw it to where it stands"
    warning = StrokeWarning("trunk_completed", "branches/0", detail)
    strokes = replace(working.strokes, branches=(longer, *others))
    return replace(working, strokes=strokes, warnings=(*working.warnings, warning)), _standing(traced, ground)


def _standing(traced: Traced, ground: float) -> Traced:
    """Return traced branches with a joint at the row of the ground, px, below each root."""
    wood = traced.skeleton
    roots = np.flatnonzero(wood.parents < 0)
    feet = np.column_stack([wood.points[roots, 0], np.maximum(wood.points[roots, 1], ground)])
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
