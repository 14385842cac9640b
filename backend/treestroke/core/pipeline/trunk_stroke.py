"""A trunk's stroke beside its trunk is moved onto it, or doubted; one that begins before its foot is shortened."""

from dataclasses import replace

import numpy as np

from treestroke.core.geometry.polyline import arc_lengths, place_at
from treestroke.core.pipeline.working_copy import WorkingCopy
from treestroke.core.segment.foliage import Foliage
from treestroke.core.strokes import StrokeWarning
from treestroke.core.trace.trunk_place import ground_before_trunk, way_to_trunk
from treestroke.core.types import Floats


def on_its_trunk(working: WorkingCopy, foliage: Foliage) -> WorkingCopy:
    """Return the working copy with the trunk's stroke on the trunk, from its foot on, and warnings where it was not."""
    return _from_its_foot(_beside_no_more(working, foliage), foliage)


def _beside_no_more(working: WorkingCopy, foliage: Foliage) -> WorkingCopy:
    """Move the trunk's stroke onto the trunk; where it is not sure which that is, warn only."""
    trunk, *others = working.strokes.branches
    way, is_sure = way_to_trunk(working.photo, trunk.points, foliage.region, working.height_px(foliage.mask))
    if is_sure and not way.any():
        return working
    if not is_sure:
        return replace(working, warnings=(*working.warnings, _doubt(way / working.frame.scale)))
    height, width = working.photo.shape[:2]
    moved = replace(trunk, points=np.clip(trunk.points + way, 0.0, (width, height)))
    detail = f"it runs beside the trunk and was moved onto it, by {np.hypot(*way) / working.frame.scale:.0f} px"
    strokes = replace(working.strokes, branches=(moved, *others))
    warning = StrokeWarning("trunk_moved", "branches/0", detail)
    return replace(working, strokes=strokes, warnings=(*working.warnings, warning))


def _doubt(way: Floats) -> StrokeWarning:
    """Say that no trunk is seen under its stroke, but perhaps one at the end of a way (2,), px, from it."""
    side = "right" if way[0] > 0 else "left"
    beside = f", but something like one {np.hypot(*way):.0f} px to its {side}" if way.any() else ""
    detail = f"no trunk is seen under it{beside}"
    return StrokeWarning("trunk_unclear", "branches/0", f"{detail}; draw it on the trunk, from where that stands")


def _from_its_foot(working: WorkingCopy, foliage: Foliage) -> WorkingCopy:
    """Leave out the part of the trunk's stroke that lies on the ground before the trunk."""
    trunk, *others = working.strokes.branches
    length = ground_before_trunk(working.photo, trunk.points, foliage.region, working.height_px(foliage.mask))
    if length == 0:
        return working
    rest = trunk.points[arc_lengths(trunk.points) > length]
    shortened = replace(trunk, points=np.vstack([place_at(trunk.points, length), rest]))
    detail = f"it begins on the ground before the trunk, and was shortened by {length / working.frame.scale:.0f} px"
    strokes = replace(working.strokes, branches=(shortened, *others))
    warning = StrokeWarning("trunk_shortened", "branches/0", f"{detail}; draw it from where the trunk stands")
    return replace(working, strokes=strokes, warnings=(*working.warnings, warning))
