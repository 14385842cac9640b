"""A trunk's stroke that was drawn beside its trunk is moved onto it."""

from dataclasses import replace

import numpy as np

from treestroke.core.pipeline.working_copy import WorkingCopy
from treestroke.core.segment.foliage import Foliage
from treestroke.core.strokes import StrokeWarning
from treestroke.core.trace.trunk_place import way_to_trunk


def on_its_trunk(working: WorkingCopy, foliage: Foliage) -> WorkingCopy:
    """Return the working copy with the trunk's stroke on the trunk, and a warning where it had to be moved."""
    trunk, *others = working.strokes.branches
    way = way_to_trunk(working.photo, trunk.points, foliage.region, working.height_px(foliage.mask))
    if not way.any():
        return working
    height, width = working.photo.shape[:2]
    moved = replace(trunk, points=np.clip(trunk.points + way, 0.0, (width, height)))
    detail = f"it runs beside the trunk and was moved onto it, by {np.hypot(*way) / working.frame.scale:.0f} px"
    strokes = replace(working.strokes, branches=(moved, *others))
    warning = StrokeWarning("trunk_moved", "branches/0", detail)
    return replace(working, strokes=strokes, warnings=(*working.warnings, warning))
