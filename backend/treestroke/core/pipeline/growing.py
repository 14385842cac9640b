"""The first half of a photo's recipe, for live trees and models: from photo and strokes to a grown tree."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from treestroke.core.appearance import Appearance, StemPixels, View
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette
from treestroke.core.geometry.outline_volume import turned_outline
from treestroke.core.grow.library import choose_library
from treestroke.core.grow.palm import grow_palm
from treestroke.core.grow.params import growth_for
from treestroke.core.grow.replacement import CrownToFill, Replacement, grow
from treestroke.core.grow.trimming import trimmed
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.lift.spread import FrontCrown, FrontTree, lift
from treestroke.core.pipeline.completion import completed
from treestroke.core.pipeline.crowns import (
    CLOSED_SHARE,
    LEAFED_SHARE,
    closed,
    drawn,
    drawn_depth,
    frayed,
    seen_from_front,
)
from treestroke.core.pipeline.grown_tree import GrownTree, Reading
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sides import Side, crown_height, draw_side, side_of, with_depth
from treestroke.core.pipeline.taken import Taken, shown_kind, taken_for
from treestroke.core.pipeline.trunk_stroke import on_its_trunk
from treestroke.core.pipeline.working_copy import WORKING_SIDE, WorkingCopy, working_copy
from treestroke.core.progress import Report, silent
from treestroke.core.segment.foliage import Foliage, segment_foliage
from treestroke.core.segment.form import crown_form
from treestroke.core.segment.kind import KindOdds, kind_odds, likeliest
from treestroke.core.skeleton.branched import branched
from treestroke.core.skeleton.edit import densified
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children
from treestroke.core.strokes import Sketch, Strokes, StrokeWarning
from treestroke.core.survey.measures import BREAST_HEIGHT, ENDS_PX, Scale, Stature
from treestroke.core.trace.appearance import Surroundings
from treestroke.core.trace.crown_picture import see_crown
from treestroke.core.trace.drawing import Drawing
from treestroke.core.trace.tracing import Traced, trace_branches
from treestroke.core.types import FoliageKind, Indices, Mask, Picture

JOINT_SHARE = 0.015
"""Distance between joints, as a share of the tree's height, so that growth can split a straight trunk anywhere."""
BULGE = 1.08
"""Radius of the crown's sections over half their width in the photo: in other directions some limbs reach further
(4 trees known in 3D; 1.15 is too deep for a slim one)."""
BARE_BREADTH = 0.5
"""Share of a visible branch's width in front of which no leaf hangs; more would show sky beside thinner wood."""
READ = "the foliage and branches as they were read in the photo"
UNCLEAR = StrokeWarning(
    "crown_unclear",
    "crown",
    "what is inside it hardly differs from what is around it; draw it around the tree's foliage, or take another photo",
)
DOUBTFUL = ("trunk_level", "outside_photo", UNCLEAR.code)
"""Codes of warnings after which the strokes may not describe a tree."""


@dataclass(frozen=True, eq=False)
class PhotoEvidence:
    """What photo and strokes show, at the working size, and a sketch of the tree's left side where there is one.

    Nothing is traced without a branch stroke. ``completed`` names the photo's edges beyond which the crown was
    completed.
    """

    working: WorkingCopy
    foliage: Foliage
    traced: Traced | None
    side: Drawing | None = None
    completed: tuple[str, ...] = ()

    @property
    def warnings(self) -> tuple[StrokeWarning, ...]:
        """What was mended, and what makes the reading doubtful."""
        unclear = () if self.foliage.clear else (UNCLEAR,)
        beyond = (_completion_notice(self.completed),) if self.completed else ()
        return (*self.working.warnings, *unclear, *beyond, *(() if self.side is None else self.side.warnings))

    @property
    def height_px(self) -> float:
        """The tree's height, px of the working copy."""
        return self.working.height_px(self.foliage.mask)

    @property
    def odds(self) -> KindOdds:
        """Probability of each kind of foliage by the photo."""
        return kind_odds(self.foliage.cues)

    def taken(self, settings: ModelSettings) -> Taken:
        """Return what the tree is taken for; a branch stroke is needed."""
        branches_px = [branch.points for branch in self.working.strokes.branches]
        kind = shown_kind(self.odds, settings)
        return taken_for(self.odds, crown_form(self.foliage.cues, kind, branches_px, self.height_px), settings)


@dataclass(frozen=True, eq=False)
class _PhotoCrown:
    """The crown that a photo shows.

    Attributes
    ----------
    kind
        What the twigs bear.
    shows_leaves
        Whether the photo shows leaves, or the tree has none.
    wood
        (h, w) the traced branches.
    front
        The foliage with its holes closed.
    as_seen, volume
        The crown's volume as wide as the photo shows it, and as growth may fill it.
    side
        The tree's left side, where there is a sketch of it.
    """

    kind: FoliageKind
    shows_leaves: bool
    wood: Mask
    front: Silhouette[OrthographicCamera]
    as_seen: CrownVolume
    volume: CrownVolume
    side: Side | None

    @property
    def camera(self) -> OrthographicCamera:
        """The working copy's camera."""
        return self.front.camera


@dataclass(frozen=True, eq=False)
class _LiftedTrace:
    """The traced branches, lifted into the world.

    Attributes
    ----------
    tree
        (n joints) metres.
    visible
        The same tree in the picture, px.
    owner
        (n,) traced joint at whose edge each lies.
    score
        How well it matches the sketch of its left side, by name.
    """

    tree: Skeleton
    visible: Skeleton
    owner: Indices
    score: dict[str, float]


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
    working = working_copy(photo, strokes)
    report("foliage", 0.05)
    if known is not None and known.working.frame == working.frame:
        foliage = known.foliage
    else:
        crown = working.strokes.crown.points
        foliage = segment_foliage(working.photo, crown, report=report, cut_out=working.cut_out)
    if not strokes.branches:
        return PhotoEvidence(working, foliage, None, side_drawing)
    report("trace", 0.0)
    working = on_its_trunk(working, foliage)
    height_px = working.height_px(foliage.mask)
    kind = likeliest(kind_odds(foliage.cues))
    leaf = None if kind == "bare" else foliage.leaf
    surroundings = Surroundings(leaf, foliage.ground, foliage.region, foliage.mask, kind == "leaves")
    before = known.traced if known is not None and known.foliage is foliage else None
    if before is not None and before.picture.tree_px == height_px:
        picture = before.picture
    else:
        picture = see_crown(working.photo, surroundings, height_px)
    traced = trace_branches(working.photo, working.strokes, surroundings, picture)
    return PhotoEvidence(working, foliage, traced, side_drawing)


def grow_tree(
    evidence: PhotoEvidence, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> GrownTree:
    """Lift the traced branches into the world and let them fill the crown.

    Raises
    ------
    ValueError
        Nothing was traced.
    """
    report("lift", 0.0)
    taken, evidence = evidence.taken(settings), _completed(evidence, settings)
    traced, foliage = evidence.traced, evidence.foliage
    if traced is None:
        raise ValueError("nothing grows without a branch stroke")
    if taken.foliage == "palm":
        traced = traced.stroked  # limbs found in a palm's crown are midribs of its fronds
    crown = _crown_of(evidence, traced, taken.foliage, settings)
    lifted = _lifted(evidence, traced, crown, rng)
    report("grow", 0.0)
    method = Replacement(
        choose_library(settings.library, crown.kind, lifted.tree, taken.form),
        growth_for(crown.kind, settings.iterations, taken.form),
    )
    room = CrownToFill(crown.volume, crown.front)
    if crown.kind == "palm":
        grown = grow_palm(lifted.tree, room, settings.iterations, rng)
    else:
        grown = grow(lifted.tree, room, method, rng, report)
    leafy = foliage.covered if crown.shows_leaves else frayed(crown.front.mask, rng)
    tree = leafy | crown.wood
    if crown.kind not in ("bare", "palm"):
        grown = trimmed(grown, Silhouette(tree, crown.camera))
    return GrownTree(
        taken=taken,
        grown=grown,
        volume=crown.volume,
        appearance=_appearance(evidence, traced, crown, lifted, leafy),
        camera=evidence.working.full_size_camera(crown.camera),
        expected_cover=evidence.working.in_photo(tree),
        stature=_stature(evidence, traced, crown),
        score={"attractors_reached": grown.attractors_reached, **lifted.score},
        reading=_reading(evidence, taken),
        warnings=evidence.warnings,
    )


def _completed(evidence: PhotoEvidence, settings: ModelSettings) -> PhotoEvidence:
    """Return the evidence with the crown completed beyond the photo's edges, if the settings want it."""
    traced = evidence.traced
    if traced is None or settings.edge == "cut":
        return evidence
    shown = shown_kind(evidence.odds, settings)
    crown = closed(evidence.foliage.mask, CLOSED_SHARE[shown])
    whole = completed(evidence.working, evidence.foliage, traced, crown, shown == "needles")
    if whole is None:
        return evidence
    return replace(evidence, working=whole.working, foliage=whole.foliage, traced=whole.traced, completed=whole.sides)


def _completion_notice(sides: tuple[str, ...]) -> StrokeWarning:
    """Say beyond which of the photo's edges the crown was completed."""
    edges = f"{' and '.join(sides)} edge{'s' * (len(sides) > 1)}"
    detail = f"the photo's {edges} cut it, and it was completed there; with the setting edge at cut it is left as it is"
    return StrokeWarning("edge_completed", "crown", detail)


def _crown_of(evidence: PhotoEvidence, traced: Traced, kind: FoliageKind, settings: ModelSettings) -> _PhotoCrown:
    """Close the foliage to a crown and make a volume of it; ``kind`` is what its twigs are to bear."""
    foliage, shown = evidence.foliage, shown_kind(evidence.odds, settings)
    wood = drawn(traced.skeleton, foliage.mask.shape)
    shows_leaves = shown != "bare" or kind == "bare"
    mask = closed(foliage.mask | (wood & foliage.region), CLOSED_SHARE[shown] if shows_leaves else LEAFED_SHARE)
    front = Silhouette(mask, evidence.working.camera(foliage.mask, settings.height))
    outline = turned_outline(front)
    bulged = outline.widened(BULGE)
    if evidence.side is None:
        return _PhotoCrown(kind, shows_leaves, wood, front, outline, bulged, None)
    side = side_of(evidence.side, crown_height, evidence.height_px, front.camera)
    as_seen, volume = outline.with_side(side.crown), bulged.with_side(side.crown)
    return _PhotoCrown(kind, shows_leaves, wood, front, as_seen, volume, side)


def _lifted(evidence: PhotoEvidence, traced: Traced, crown: _PhotoCrown, rng: np.random.Generator) -> _LiftedTrace:
    """Lift the traced branches into the world: by the left side, or with a guessed depth."""
    visible, owner = densified(traced.skeleton, JOINT_SHARE * evidence.height_px)
    stroke = traced.stroke[owner]
    if crown.side is None:
        leafy = crown.front.mask & crown.shows_leaves & (crown.kind != "bare")
        seen = (traced.measured[owner] | (stroke < 0)) & sample_nearest(leafy, visible.points, False)
        tree = lift(FrontTree(visible, stroke, seen), FrontCrown(crown.volume, crown.camera), rng)
        return _LiftedTrace(tree, visible, owner, {})
    weights = accumulate_to_root(visible, edge_lengths(visible))
    same = stroke == stroke[np.maximum(visible.parents, 0)]
    front = branched(visible, heaviest_children(visible, np.where(same, weights + weights.max(), weights)))
    retrieved = with_depth(front, crown.side, evidence.height_px, crown.camera)
    tree = retrieved.tree.skeleton
    return _LiftedTrace(tree, seen_from_front(tree, crown.camera), owner[retrieved.front], retrieved.score)


def _appearance(
    evidence: PhotoEvidence, traced: Traced, crown: _PhotoCrown, lifted: _LiftedTrace, leafy: Mask
) -> Appearance:
    """Return the tree's appearance in the photo; ``leafy`` (h, w) is where the tree is to have leaves."""
    stem = np.flatnonzero(traced.stroke == 0)
    view = View(
        camera=crown.camera,
        picture=evidence.working.photo,
        leaves_from=_leaves_from(evidence.foliage, traced, crown, lifted, leafy),
        opacity=evidence.foliage.alpha if crown.shows_leaves else leafy.astype(np.float32),
        leaf_coloured=evidence.foliage.pure,
        tree=leafy | crown.wood,
        stem=StemPixels(
            traced.skeleton.points[stem], np.where(traced.measured[stem], traced.skeleton.radii[stem], 0.0)
        ),
    )
    return Appearance((view,), crown.shows_leaves)


def _leaves_from(
    foliage: Foliage, traced: Traced, crown: _PhotoCrown, lifted: _LiftedTrace, leafy: Mask
) -> NDArray[np.float32]:
    """Depth (h, w), metres, from which on leaves may lie, as `View` has it.

    Pixels that are leaves by their colour hang before the wood; none hangs before what is wood by its colour.
    """
    depth, seen = crown.camera.depth(lifted.tree.points), traced.measured[lifted.owner]
    wood, middle = (
        drawn_depth(lifted.visible, seen, depth, foliage.mask.shape, breadth) for breadth in (1.0, BARE_BREADTH)
    )
    leaves_from = np.where(np.isnan(wood) | ~foliage.region, np.inf, wood)
    leaves = foliage.pure & ~traced.wood & crown.shows_leaves
    leaves_from[leafy & (np.isnan(wood) | np.isnan(middle) & ~traced.wood | leaves)] = -np.inf
    return leaves_from.astype(np.float32)


def _stature(evidence: PhotoEvidence, traced: Traced, crown: _PhotoCrown) -> Stature:
    """Return the tree's height, by the scale of the strokes or the settings, and whether its trunk is visible."""
    working, camera = evidence.working, crown.camera
    known, error, stem = working.strokes.scale, 0.0, np.flatnonzero(traced.stroke == 0)
    if known is not None:
        ends_px = ENDS_PX * max(working.photo.shape) / WORKING_SIDE
        error = min(0.9, ends_px / float(np.hypot(*(known.points[1] - known.points[0]))))
    rows = traced.skeleton.points[:, 1]
    heights = camera.metres_from_pixels(rows[stem[0]] - rows[stem])
    trunk_seen = bool(traced.measured[stem[np.abs(heights - BREAST_HEIGHT).argmin()]])
    scale = Scale(float(working.full_size_camera(camera).metres_from_pixels(1.0)), known is not None, error)
    return Stature(float(camera.metres_from_pixels(evidence.height_px)), scale, trunk_seen, crown.as_seen)


def _reading(evidence: PhotoEvidence, taken: Taken) -> Reading:
    """Return what was read in the photo, and what makes that doubtful."""
    doubts = [warning.code for warning in evidence.warnings if warning.code in DOUBTFUL]
    return Reading(READ, tuple(doubts + ["kind_unsure"] * taken.ask), evidence.completed)
