"""What a photo and its strokes show of a tree: the foliage, the traced branches, and what is in doubt."""

from dataclasses import dataclass, replace

import numpy as np

from treestroke.core.pipeline.occluders import on_the_ground, poles_notice, without_poles
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sides import draw_side
from treestroke.core.pipeline.taken import Taken, shown_kind, taken_for
from treestroke.core.pipeline.trunk_stroke import on_its_trunk
from treestroke.core.pipeline.working_copy import WorkingCopy, working_copy
from treestroke.core.progress import Report, silent
from treestroke.core.segment.bare import wood_in_crown
from treestroke.core.segment.foliage import Foliage, segment_foliage
from treestroke.core.segment.form import crown_form
from treestroke.core.segment.kind import UNJUDGED, KindOdds, kind_odds, likeliest
from treestroke.core.strokes import Sketch, Strokes, StrokeWarning
from treestroke.core.trace.appearance import Surroundings
from treestroke.core.trace.crown_picture import see_crown
from treestroke.core.trace.drawing import Drawing
from treestroke.core.trace.tracing import Traced, trace_branches
from treestroke.core.types import FoliageKind, Picture

UNCLEAR = StrokeWarning(
    "crown_unclear",
    "crown",
    "what is inside it hardly differs from what is around it; draw it around the tree's foliage, or take another photo",
)


@dataclass(frozen=True, eq=False)
class PhotoEvidence:
    """What photo and strokes show, at the working size, and a sketch of the tree's left side where there is one.

    Nothing is traced without a branch stroke. ``foliage`` is the wood in a bare tree's crown once its trunk is known;
    ``outlined`` is what the crown stroke alone tells, ``odds`` the probability of each kind of foliage. ``completed``
    names the photo's edges beyond which the crown was completed.
    """

    working: WorkingCopy
    foliage: Foliage
    outlined: Foliage
    odds: KindOdds
    traced: Traced | None
    side: Drawing | None = None
    completed: tuple[str, ...] = ()

    @property
    def warnings(self) -> tuple[StrokeWarning, ...]:
        """What was mended, and what makes the reading doubtful."""
        unclear = () if self.foliage.clear else (UNCLEAR,)
        beyond = (_completion_notice(self.completed),) if self.completed else ()
        hidden = poles_notice(self.working)
        return (*self.working.warnings, *hidden, *unclear, *beyond, *(() if self.side is None else self.side.warnings))

    @property
    def height_px(self) -> float:
        """The tree's height, px of the working copy."""
        return self.working.height_px(self.foliage.mask)

    def taken(self, settings: ModelSettings) -> Taken:
        """Return what the tree is taken for; a branch stroke is needed."""
        branches_px = [branch.points for branch in self.working.strokes.branches]
        kind = shown_kind(self.odds, settings)
        return taken_for(self.odds, crown_form(self.foliage.cues, kind, branches_px, self.height_px), settings)


def read_photo(
    photo: Picture,
    strokes: Strokes,
    known: PhotoEvidence | None = None,
    report: Report = silent,
    side: Sketch | None = None,
) -> PhotoEvidence:
    """Find the foliage, unless it is ``known``, and trace the branches of a photo (h, w, 3 or 4), sRGB.

    What an earlier reading knows is kept where it saw the same part of the photo.

    Raises
    ------
    StrokesError
        The strokes, or the sketch of the left side, do not describe a tree.
    """
    side_drawing = None if side is None else draw_side(side, "side")
    report("foliage", 0.0)
    before = None if known is None else known.working
    working = without_poles(working_copy(photo, strokes), before)
    report("foliage", 0.05)
    if known is not None and (known.working.frame, known.working.poles) == (working.frame, working.poles):
        outlined = known.outlined
    else:
        crown = working.strokes.crown.points
        outlined = segment_foliage(working.photo, crown, report=report, cut_out=working.cut_out)
    if not strokes.branches:
        return PhotoEvidence(working, outlined, outlined, UNJUDGED, None, side_drawing)
    report("trace", 0.0)
    working, wood = on_its_trunk(working, outlined), None
    odds = kind_odds(outlined.cues, working.strokes.crown.points, working.strokes.branches[0].points)
    kind = likeliest(odds)
    surroundings = _surroundings(outlined, kind, working)
    if kind == "bare":
        wood = _wood(outlined, working, known)
        surroundings = replace(surroundings, leaf=None, bare_wood=None if wood is None else wood.alpha)
    foliage = outlined if wood is None else wood
    height_px = working.height_px(foliage.mask)
    seen = known.traced.picture if known is not None and known.traced and known.outlined is outlined else None
    if seen is None or seen.tree_px != height_px:
        seen = see_crown(working.photo, surroundings, height_px)
    traced = trace_branches(working.photo, working.strokes, surroundings, seen)
    working, traced = on_the_ground(working, traced, height_px)
    return PhotoEvidence(working, foliage, outlined, odds, traced, side_drawing)


def _surroundings(outlined: Foliage, kind: FoliageKind, working: WorkingCopy) -> Surroundings:
    """Return what surrounds the branches of a tree of this kind in leaf."""
    masks, cut_out = (outlined.region, outlined.mask), working.cut_out is not None
    return Surroundings(outlined.leaf, outlined.ground, *masks, broad=kind == "leaves", cut_out=cut_out)


def _wood(outlined: Foliage, working: WorkingCopy, known: PhotoEvidence | None) -> Foliage | None:
    """Return the wood in a bare tree's crown, the known one where neither crown nor trunk changed; None if unclear."""
    if working.cut_out is not None:
        return outlined
    trunk = working.strokes.branches[0].points
    if known is None or known.traced is None or known.outlined is not outlined:
        return wood_in_crown(outlined, working.photo, trunk)
    if not np.array_equal(known.working.strokes.branches[0].points, trunk):
        return wood_in_crown(outlined, working.photo, trunk)
    return known.foliage if known.traced.whole else None


def _completion_notice(sides: tuple[str, ...]) -> StrokeWarning:
    """Say beyond which of the photo's edges the crown was completed."""
    edges = f"{' and '.join(sides)} edge{'s' * (len(sides) > 1)}"
    detail = f"the photo's {edges} cut it, and it was completed there; with the setting edge at cut it is left as it is"
    return StrokeWarning("edge_completed", "crown", detail)
