"""The photo's first half of the recipe, which the live tree and the model share: to a grown tree."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.envelope import Envelope, envelope_of_mask
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.library import Subtree, choose_library
from treestroke.core.grow.params import GrowthParams, growth_for
from treestroke.core.grow.replacement import grow
from treestroke.core.grow.trimming import trimmed
from treestroke.core.lift.spread import lift
from treestroke.core.paint.seasons import LEAFY
from treestroke.core.paint.species import AUTO, SPECIES
from treestroke.core.pipeline.crowns import CLOSED_SHARE, LEAFED_SHARE, closed, drawn, drawn_depth, frayed
from treestroke.core.pipeline.grown_tree import GrownTree, Portrait, Reading, Stature
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sides import Side, crown_height, deepened, draw_side, side_of, with_depth
from treestroke.core.pipeline.working_copy import WORKING_SIDE, WorkingCopy, look
from treestroke.core.progress import Report, silent
from treestroke.core.segment.foliage import Foliage, segment_foliage
from treestroke.core.segment.kind import UNSURE, foliage_kind
from treestroke.core.skeleton.branched import branched
from treestroke.core.skeleton.edit import densified
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children
from treestroke.core.strokes import Sketch, Strokes, StrokeWarning
from treestroke.core.survey.measures import BREAST_HEIGHT, ENDS_PX, Scale
from treestroke.core.trace.appearance import Surroundings
from treestroke.core.trace.drawing import Drawing
from treestroke.core.trace.tracing import Traced, trace_branches
from treestroke.core.types import FoliageKind, Indices, Mask, Picture

JOINT_SHARE = 0.015
"""Of the tree's height: joints this near let growth cut a straight trunk where it likes."""
BULGE = 1.08
"""Radius of the crown's sections over half their width in the photo. A crown is no turned solid: away from the outline
that the photo shows some limbs reach further (4 trees known in 3D; 1.15 is too deep again for a slim one)."""
BARE_BREADTH = 0.5
"""Of a visible branch's width: no leaf hangs before it there. More would show sky where the grown wood is thinner."""
READ = "the foliage and branches as they were read in the photo"
UNCLEAR = StrokeWarning(
    "crown_unclear",
    "crown",
    "what is inside it hardly differs from what is around it; draw it around the tree's foliage, or take another photo",
)
DOUBTFUL = ("trunk_level", "outside_photo", UNCLEAR.code)
"""Codes of warnings of strokes that may mean no tree."""
_KINDS: dict[str, FoliageKind] = {"leaves": "leaves", "needles": "needles", "bare": "bare"}


@dataclass(frozen=True, eq=False)
class Seen:
    """What photo and strokes show, at the working size, and a sketch of the tree's left side where there is one.

    Nothing is traced without a branch stroke.
    """

    sight: WorkingCopy
    foliage: Foliage
    traced: Traced | None
    side: Drawing | None = None

    @property
    def warnings(self) -> tuple[StrokeWarning, ...]:
        """What was mended, and what makes the reading doubtful."""
        unclear = () if self.foliage.clear else (UNCLEAR,)
        return (*self.sight.warnings, *unclear, *(() if self.side is None else self.side.warnings))


@dataclass(frozen=True, eq=False)
class _Lifted:
    """What was traced, turned into the world.

    Attributes
    ----------
    tree
        (n joints) metres.
    visible
        The same in the picture, px.
    owner
        (n,) traced joint at whose edge each lies.
    score
        How true it is to what was drawn of its other side.
    """

    tree: Skeleton
    visible: Skeleton
    owner: Indices
    score: dict[str, float]


def see(
    photo: Picture,
    strokes: Strokes,
    known: Foliage | None = None,
    report: Report = silent,
    side: Sketch | None = None,
) -> Seen:
    """Find the foliage, unless it is ``known``, and trace the branches of a photo (h, w, 3), sRGB.

    Raises
    ------
    StrokesError
        The strokes, or the sketch of the left side, do not describe a tree.
    """
    beside = None if side is None else draw_side(side, "side")
    report("foliage", 0.0)
    sight = look(photo, strokes)
    report("foliage", 0.05)
    foliage = known or segment_foliage(sight.photo, sight.strokes.crown.points, report=report)
    if not strokes.branches:
        return Seen(sight, foliage, None, beside)
    report("trace", 0.0)
    height_px = sight.height_px(foliage.mask)
    surroundings = Surroundings(foliage.leaf, foliage.ground, foliage.region)
    traced = trace_branches(sight.photo, sight.strokes, surroundings, height_px)
    return Seen(sight, foliage, traced, beside)


def grow_tree(seen: Seen, settings: ModelSettings, rng: np.random.Generator, report: Report = silent) -> GrownTree:
    """Lift what was traced into the world and let it fill the crown.

    Raises
    ------
    ValueError
        Nothing was traced.
    """
    sight, foliage, traced = seen.sight, seen.foliage, seen.traced
    if traced is None:
        raise ValueError("nothing grows without a branch stroke")
    report("lift", 0.0)
    shown = _shown_kind(sight, foliage, settings)
    kind = borne_kind(shown, settings)
    wood = drawn(traced.skeleton, foliage.mask.shape)
    shows_leaves = shown != "bare" or kind == "bare"
    crown = closed(foliage.mask | (wood & foliage.region), CLOSED_SHARE[shown] if shows_leaves else LEAFED_SHARE)
    camera = sight.camera(foliage.mask, settings.height)
    envelope = envelope_of_mask(crown, camera)
    bulged = envelope.widened(BULGE)
    if seen.side is not None:
        side = side_of(seen.side, crown_height, sight.height_px(foliage.mask), camera.metres_per_pixel)
        envelope, bulged = deepened(envelope, side), deepened(bulged, side)
        lifted = _turned(traced, side, sight.height_px(foliage.mask), camera)
    else:
        lifted = _spread(traced, bulged, JOINT_SHARE * sight.height_px(foliage.mask), rng)
    report("grow", 0.0)
    library = choose_library(settings.library, kind, lifted.tree)
    grown = _filled(lifted.tree, crown, bulged, library, growth_for(kind, settings.iterations), rng, report)
    leafy = foliage.mask if shows_leaves else frayed(crown, rng)
    grown = grown if kind == "bare" else trimmed(grown, leafy | wood, camera)
    front = _front(foliage, traced, lifted, leafy, shows_leaves)
    stem = np.flatnonzero(traced.stroke == 0)
    radii = np.where(traced.measured[stem], traced.skeleton.radii[stem], 0.0)
    return GrownTree(
        kind=kind,
        grown=grown,
        envelope=bulged,
        camera=sight.unreduced(camera),
        portrait=Portrait(sight.photo, shows_leaves, foliage.pure, front, traced.skeleton.points[stem], radii),
        stature=_stature(sight, foliage, camera, traced, stem, envelope),
        likeness=leafy | wood,
        score={"attractors_reached": grown.attractors_reached, **lifted.score},
        reading=_reading(seen, settings),
        warnings=seen.warnings,
    )


def _reading(seen: Seen, settings: ModelSettings) -> Reading:
    """Tell what was read in the photo, and what makes that doubtful."""
    told = settings.foliage != "auto" or settings.season in LEAFY
    sureness = 1.0 if told else seen.foliage.sureness
    doubts = [warning.code for warning in seen.warnings if warning.code in DOUBTFUL]
    return Reading(READ, sureness, tuple(doubts + ["kind_unsure"] * (sureness < UNSURE)))


def _stature(
    sight: WorkingCopy, foliage: Foliage, camera: Camera, traced: Traced, stem: Indices, crown: Envelope
) -> Stature:
    """Tell the tree's height by the scale that the strokes or the settings set, and whether its trunk is seen."""
    known, error, metres = sight.strokes.scale, 0.0, camera.metres_per_pixel
    if known is not None:
        ends_px = ENDS_PX * max(sight.photo.shape) / WORKING_SIDE
        error = min(0.9, ends_px / float(np.hypot(*(known.points[1] - known.points[0]))))
    heights = (traced.skeleton.points[stem[0], 1] - traced.skeleton.points[stem, 1]) * metres
    seen = bool(traced.measured[stem[np.abs(heights - BREAST_HEIGHT).argmin()]])
    scale = Scale(metres * sight.scale, known is not None, error)
    return Stature(sight.height_px(foliage.mask) * metres, scale, seen, crown)


def _spread(traced: Traced, envelope: Envelope, step: float, rng: np.random.Generator) -> _Lifted:
    """Guess the depth of what was traced."""
    visible, owner = densified(traced.skeleton, step)
    return _Lifted(lift(visible, traced.stroke[owner], envelope, rng), visible, owner, {})


def _turned(traced: Traced, side: Side, height_px: float, camera: Camera) -> _Lifted:
    """Take the depth of what was traced from the left side."""
    visible, owner = densified(traced.skeleton, JOINT_SHARE * height_px)
    stroke, weights = traced.stroke[owner], accumulate_to_root(visible, edge_lengths(visible))
    same = stroke == stroke[np.maximum(visible.parents, 0)]
    front = branched(visible, heaviest_children(visible, np.where(same, weights + weights.max(), weights)))
    deep = with_depth(front, side, height_px, camera)
    tree = deep.tree.skeleton
    seen = Skeleton(camera.pixels_from_world(tree.points), tree.radii / camera.metres_per_pixel, tree.parents)
    return _Lifted(tree, seen, owner[deep.front], deep.score)


def _filled(
    lifted: Skeleton,
    crown: Mask,
    envelope: Envelope,
    library: tuple[Subtree, ...],
    params: GrowthParams,
    rng: np.random.Generator,
    report: Report,
) -> Grown:
    """Let a lifted tree fill its crown; one that is not as deep as wide is filled as if it were."""
    if envelope.depth is None:
        return grow(lifted, crown, envelope, library, params, rng, report)
    rounded = Skeleton(envelope.rounded(lifted.points), lifted.radii, lifted.parents)
    grown = grow(rounded, crown, replace(envelope, depth=None), library, params, rng, report)
    tree = grown.skeleton
    return replace(grown, skeleton=Skeleton(envelope.unrounded(tree.points), tree.radii, tree.parents))


def _front(foliage: Foliage, traced: Traced, lifted: _Lifted, leafy: Mask, shows_leaves: bool) -> NDArray[np.float32]:
    """World Z (h, w), metres, behind which leaves may lie: infinite in the foliage, that of the wood where it is seen.

    What is a leaf by its colour hangs before the wood.
    """
    what = lifted.visible, traced.measured[lifted.owner], lifted.tree.points[:, 2], foliage.mask.shape
    wood, middle = drawn_depth(*what, 1.0), drawn_depth(*what, BARE_BREADTH)
    front = np.where(np.isnan(wood) | ~foliage.region, -np.inf, wood)
    leaves = foliage.pure & ~traced.wood & shows_leaves
    front[leafy & (np.isnan(middle) | leaves)] = np.inf
    return front.astype(np.float32)


def _shown_kind(sight: WorkingCopy, foliage: Foliage, settings: ModelSettings) -> FoliageKind:
    """Take the kind that was asked for, or judge by the picture; a season may ask for leaves that it does not show."""
    if settings.foliage == "auto" or settings.season in LEAFY:
        return foliage_kind(foliage.look, foliage.mask, sight.strokes.branches[0].points)
    return _KINDS[settings.foliage]


def borne_kind(shown: FoliageKind, settings: ModelSettings) -> FoliageKind:
    """Tell what the twigs bear: what was asked for, else what season, species and photo say, in this order."""
    species = SPECIES.get(settings.species, AUTO)
    if settings.season == "bare" or settings.foliage == "bare":
        return "bare"
    if settings.foliage != "auto":
        return _KINDS[settings.foliage]
    if shown == "bare" and settings.season not in LEAFY and not species.evergreen:
        return "bare"
    if species == AUTO:
        return "leaves" if shown == "bare" else shown
    return "leaves" if species.needles is None else "needles"
