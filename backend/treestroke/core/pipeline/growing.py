"""The first half of a photo's recipe, for live trees and models: from what the photo shows to a grown tree."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.appearance import Appearance, StemPixels, View
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette
from treestroke.core.geometry.outline_volume import turned_outline
from treestroke.core.grow.bare import grown_as_traced
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.growth_space import REFERENCE_WIDTH
from treestroke.core.grow.library import choose_library
from treestroke.core.grow.palm import grow_palm
from treestroke.core.grow.params import growth_for
from treestroke.core.grow.reaching import reaching
from treestroke.core.grow.replacement import REACHED_PX, CrownToFill, Replacement, grow
from treestroke.core.grow.trimming import trimmed
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.lift.clumps import in_clumps
from treestroke.core.lift.fan import fan_out
from treestroke.core.lift.hidden_limbs import with_hidden_limbs
from treestroke.core.lift.imagined import ImaginedCrown, imagined_crown
from treestroke.core.lift.spread import FrontCrown, FrontTree
from treestroke.core.pipeline.completion import completed, touches_edge
from treestroke.core.pipeline.crowns import (
    CLOSED_SHARE,
    LEAFED_SHARE,
    closed,
    drawn,
    drawn_depth,
    frayed,
    seen_from_front,
)
from treestroke.core.pipeline.evidence import UNCLEAR, PhotoEvidence
from treestroke.core.pipeline.grown_tree import GrownTree, LiveTree, Reading
from treestroke.core.pipeline.lifting import lift_front, method_for
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sides import Side, crown_height, side_of, with_depth
from treestroke.core.pipeline.taken import Taken, shown_kind
from treestroke.core.pipeline.working_copy import WORKING_SIDE
from treestroke.core.progress import Report, silent
from treestroke.core.skeleton.branched import branched
from treestroke.core.skeleton.edit import densified
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children
from treestroke.core.survey.measures import BREAST_HEIGHT, ENDS_PX, Scale, Stature
from treestroke.core.trace.tracing import Traced
from treestroke.core.types import FoliageKind, Indices, Mask

JOINT_SHARE = 0.015
"""Distance between joints, as a share of the tree's height, so that growth can split a straight trunk anywhere."""
BULGE = 1.08
"""Radius of the crown's sections over half their width in the photo: in other directions some limbs reach further
(4 trees known in 3D; 1.15 is too deep for a slim one)."""
BARE_BREADTH = 0.5
"""Share of a visible branch's width in front of which no leaf hangs; more would show sky beside thinner wood."""
READ = "the foliage and branches as they were read in the photo"
DOUBTFUL = ("outside_photo", UNCLEAR.code, "trunk_unclear")
"""Codes of warnings after which the strokes may not describe a tree."""


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
    imagined
        Front and imagined side, where that is how the crown's volume comes about.
    """

    kind: FoliageKind
    shows_leaves: bool
    wood: Mask
    front: Silhouette[OrthographicCamera]
    as_seen: CrownVolume
    volume: CrownVolume
    side: Side | None
    imagined: ImaginedCrown | None

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
    hidden
        Number of its last joints that stand for limbs behind those that the photo shows.
    """

    tree: Skeleton
    visible: Skeleton
    owner: Indices
    score: dict[str, float]
    hidden: int = 0


@dataclass(frozen=True, eq=False)
class _FilledCrown:
    """A grown tree and what it grew from.

    Attributes
    ----------
    evidence, traced
        The evidence, its crown completed, and what of its trace was used.
    taken, crown, lifted, grown
        What the steps in between gave.
    leafy
        (h, w) where the tree is to have leaves.
    """

    evidence: PhotoEvidence
    traced: Traced
    taken: Taken
    crown: _PhotoCrown
    lifted: _LiftedTrace
    leafy: Mask
    grown: Grown

    @property
    def tree(self) -> Mask:
        """(h, w) where the tree is to have leaves or wood."""
        return self.leafy | self.crown.wood

    @property
    def camera(self) -> OrthographicCamera:
        """The camera of the photo at its own size."""
        return self.evidence.working.full_size_camera(self.crown.camera)


def grow_tree(
    evidence: PhotoEvidence, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> GrownTree:
    """Lift the traced branches into the world and let them fill the crown.

    Raises
    ------
    ValueError
        Nothing was traced.
    """
    filled = _filled(evidence, settings, rng, report)
    evidence, crown = filled.evidence, filled.crown
    return GrownTree(
        taken=filled.taken,
        grown=filled.grown,
        volume=crown.volume,
        appearance=_appearance(filled),
        camera=filled.camera,
        expected=(Silhouette(evidence.working.in_photo(filled.tree), filled.camera),),
        stature=_stature(evidence, filled.traced, crown),
        score={"attractors_reached": filled.grown.attractors_reached, **filled.lifted.score},
        reading=_reading(evidence, filled.taken),
        warnings=evidence.warnings,
    )


def grow_live_tree(evidence: PhotoEvidence, settings: ModelSettings, rng: np.random.Generator) -> LiveTree:
    """Return the live tree of `grow_tree`, without what only leaves and bark need.

    Raises
    ------
    ValueError
        Nothing was traced.
    """
    filled = _filled(evidence, settings, rng, silent)
    return LiveTree(filled.grown.skeleton, filled.grown.born, filled.camera)


def _filled(evidence: PhotoEvidence, settings: ModelSettings, rng: np.random.Generator, report: Report) -> _FilledCrown:
    """Return the tree that fills the crown of a photo, and what it grew from; as `grow_tree`."""
    report("lift", 0.0)
    taken, evidence = evidence.taken(settings), _completed(evidence, settings)
    traced = evidence.traced
    if traced is None:
        raise ValueError("nothing grows without a branch stroke")
    if taken.foliage == "palm":
        traced = traced.stroked  # limbs found in a palm's crown are midribs of its fronds
    crown = _crown_of(evidence, traced, taken.foliage, settings, rng)
    lifted = _lifted(evidence, traced, crown, settings, rng)
    if crown.imagined is not None:
        limbs_px = crown.camera.picture_space_from_world(lifted.tree.points)
        crown = replace(crown, volume=in_clumps(crown.imagined, limbs_px, rng))
    report("grow", 0.0)
    room = CrownToFill(crown.volume, crown.front)
    if crown.kind == "bare" and traced.whole:
        grown = grown_as_traced(lifted.tree, lifted.hidden, _reached(crown))
    elif crown.kind == "palm":
        grown = grow_palm(lifted.tree, room, settings.iterations, rng)
    else:
        library = choose_library(settings.library, crown.kind, lifted.tree, taken.form)
        method = Replacement(library, growth_for(crown.kind, settings.iterations, taken.form))
        grown = grow(lifted.tree, room, method, rng, report)
    leafy = evidence.foliage.covered if crown.shows_leaves else frayed(crown.front.mask, rng)
    if crown.kind not in ("bare", "palm"):
        grown = trimmed(grown, Silhouette(leafy | crown.wood, crown.camera), crown.volume)
        grown = reaching(grown, Silhouette(leafy & ~crown.wood, crown.camera), crown.volume)
    return _FilledCrown(evidence, traced, taken, crown, lifted, leafy, grown)


def _reached(crown: _PhotoCrown) -> float:
    """Return the share of the crown that lies as near to its wood as growth's attractors must, in the picture."""
    away = cv2.distanceTransform((~crown.wood).astype(np.uint8), cv2.DIST_L2, 5)
    width = float(np.ptp(np.flatnonzero(crown.front.mask.any(axis=0))) + 1)
    return float((away[crown.front.mask] <= REACHED_PX * width / REFERENCE_WIDTH).mean())


def _completed(evidence: PhotoEvidence, settings: ModelSettings) -> PhotoEvidence:
    """Return the evidence with the crown completed beyond the photo's edges, if the settings want it."""
    traced = evidence.traced
    if traced is None or settings.edge == "cut" or not touches_edge(evidence.foliage.mask):
        return evidence
    shown = shown_kind(evidence.odds, settings)
    crown = closed(evidence.foliage.mask, CLOSED_SHARE[shown])
    whole = completed(evidence.working, evidence.foliage, traced, crown, shown == "needles")
    if whole is None:
        return evidence
    return replace(evidence, working=whole.working, foliage=whole.foliage, traced=whole.traced, completed=whole.sides)


def _crown_of(
    evidence: PhotoEvidence, traced: Traced, kind: FoliageKind, settings: ModelSettings, rng: np.random.Generator
) -> _PhotoCrown:
    """Close the foliage to a crown and make a volume of it; ``kind`` is what its twigs are to bear.

    Foliage stands in clumps where it is not all seen, as that of a palm or the twigs of a bare tree.
    """
    foliage, shown = evidence.foliage, shown_kind(evidence.odds, settings)
    wood = drawn(traced.skeleton, foliage.mask.shape)
    shows_leaves = shown != "bare" or kind == "bare"
    mask = closed(foliage.mask | (wood & foliage.region), CLOSED_SHARE[shown] if shows_leaves else LEAFED_SHARE)
    front = Silhouette(mask, evidence.working.camera(foliage.mask, settings.height))
    outline = turned_outline(front)
    bulged = outline.widened(BULGE)
    if evidence.side is None:
        if kind == "palm" or (kind == "bare" and traced.whole):
            return _PhotoCrown(kind, shows_leaves, wood, front, outline, bulged, None, None)
        imagined = imagined_crown(bulged, front, rng)
        return _PhotoCrown(kind, shows_leaves, wood, front, outline, imagined.hull(), None, imagined)
    side = side_of(evidence.side, crown_height, evidence.height_px, front.camera)
    return _PhotoCrown(
        kind, shows_leaves, wood, front, outline.with_side(side.crown), bulged.with_side(side.crown), side, None
    )


def _lifted(
    evidence: PhotoEvidence, traced: Traced, crown: _PhotoCrown, settings: ModelSettings, rng: np.random.Generator
) -> _LiftedTrace:
    """Lift the traced branches into the world: by the left side, or with a guessed depth."""
    visible, owner = densified(traced.skeleton, JOINT_SHARE * evidence.height_px)
    stroke = traced.stroke[owner]
    front = FrontCrown(crown.volume, crown.camera)
    if crown.side is None and crown.kind == "bare" and traced.whole:
        seen = np.arange(len(visible))
        whole, joints = with_hidden_limbs(visible, stroke) if settings.iterations > 0 else (visible, seen)
        tree = fan_out(whole, stroke[joints], front, rng)
        return _LiftedTrace(tree, whole, owner[joints], {}, len(joints) - len(seen))
    if crown.side is None:
        leafy = crown.front.mask & crown.shows_leaves & (crown.kind != "bare")
        shown = (traced.measured[owner] | (stroke < 0)) & sample_nearest(leafy, visible.points, False)
        tree = lift_front(FrontTree(visible, stroke, shown), front, method_for(settings.lift, few=True), rng)
        return _LiftedTrace(tree, visible, owner, {})
    weights = accumulate_to_root(visible, edge_lengths(visible))
    same = stroke == stroke[np.maximum(visible.parents, 0)]
    drawn_front = branched(visible, heaviest_children(visible, np.where(same, weights + weights.max(), weights)))
    retrieved = with_depth(drawn_front, crown.side, evidence.height_px, crown.camera)
    tree = retrieved.tree.skeleton
    return _LiftedTrace(tree, seen_from_front(tree, crown.camera), owner[retrieved.front], retrieved.score)


def _appearance(filled: _FilledCrown) -> Appearance:
    """Return the tree's appearance in the photo."""
    evidence, traced, crown = filled.evidence, filled.traced, filled.crown
    stem = np.flatnonzero(traced.stroke == 0)
    view = View(
        camera=crown.camera,
        picture=evidence.working.photo,
        leaves_from=_leaves_from(filled),
        opacity=evidence.foliage.alpha if crown.shows_leaves else filled.leafy.astype(np.float32),
        leaf_coloured=evidence.foliage.pure,
        tree=filled.tree,
        stem=StemPixels(
            traced.skeleton.points[stem], np.where(traced.measured[stem], traced.skeleton.radii[stem], 0.0)
        ),
    )
    if crown.imagined is None:
        return Appearance((view,), crown.shows_leaves)
    shown = np.where(view.foliage, view.opacity, view.leaves_from < np.inf) > 0.5
    return Appearance((view,), crown.shows_leaves, (crown.imagined.side_of(shown),))


def _leaves_from(filled: _FilledCrown) -> NDArray[np.float32]:
    """Depth (h, w), metres, from which on leaves may lie, as `View` has it.

    Pixels that are leaves by their colour hang before the wood; none hangs before what is wood by its colour.
    """
    traced, foliage, crown, lifted = filled.traced, filled.evidence.foliage, filled.crown, filled.lifted
    depth, seen = crown.camera.depth(lifted.tree.points), traced.measured[lifted.owner]
    wood, middle = (
        drawn_depth(lifted.visible, seen, depth, foliage.mask.shape, breadth) for breadth in (1.0, BARE_BREADTH)
    )
    leaves_from = np.where(np.isnan(wood) | ~foliage.region, np.inf, wood)
    leaves = foliage.pure & ~traced.wood & crown.shows_leaves
    leaves_from[filled.leafy & (np.isnan(wood) | np.isnan(middle) & ~traced.wood | leaves)] = -np.inf
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
    codes = [warning.code for warning in evidence.warnings]
    doubts = [code for code in codes if code in DOUBTFUL] + ["kind_unsure"] * taken.ask
    return Reading(READ, tuple(doubts), evidence.completed + ("foot",) * ("trunk_completed" in codes))
