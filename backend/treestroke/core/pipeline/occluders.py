"""What stands before a tree is taken away from its working copy."""

from dataclasses import replace

from treestroke.core.pipeline.working_copy import WorkingCopy
from treestroke.core.segment.occluders import find_lines, is_branch, painted_over
from treestroke.core.strokes import StrokeWarning


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
