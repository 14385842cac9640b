"""The photo's first half of the recipe, which the live tree and the model share: to a grown tree."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.envelope import Envelope, envelope_of_mask
from treestroke.core.geometry.polyline import Floats, Indices
from treestroke.core.grow.library import choose_library
from treestroke.core.grow.params import growth_for
from treestroke.core.grow.replacement import grow
from treestroke.core.leaf.seasons import LEAFY
from treestroke.core.leaf.species import AUTO, KINDS
from treestroke.core.lift.spread import lift
from treestroke.core.pipeline.grown_tree import GrownTree, Portrait, Stature
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sight import WORKING_SIDE, Mask, Photo, Sight, look
from treestroke.core.progress import Report, silent
from treestroke.core.segment.foliage import Foliage, segment_foliage
from treestroke.core.segment.kind import Kind, foliage_kind
from treestroke.core.skeleton.edit import densified
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Strokes
from treestroke.core.survey.measures import BREAST_HEIGHT, ENDS_PX, Scale
from treestroke.core.trace.tracing import Traced, trace_branches

JOINT_SHARE = 0.015
"""Of the tree's height: joints this near let growth cut a straight trunk where it likes."""
BULGE = 1.08
"""Radius of the crown's sections over half their width in the photo. A crown is no turned solid: away from the outline
that the photo shows some limbs reach further (4 trees known in 3D; 1.15 is too deep again for a slim one)."""
CLOSED_SHARE = {"leaves": 0.015, "needles": 0.035, "bare": 0.05}
"""Of the crown's size: holes and bays of the foliage this wide are no gaps in the crown for a branch."""
LEAFED_SHARE = 0.14
"""The same for a bare tree that is to have leaves: between its twigs."""
CLUMP, FRAY = 0.045, 0.05
"""Size of its clumps of leaves, and depth of the bays between them, as shares of the crown's size."""
GAP = 1.9
"""Deviations of clumps' density below their mean at which sky is seen through."""
BARE_BREADTH = 0.5
"""Of a visible branch's width: no leaf hangs before it there. More would show sky where the grown wood is thinner."""
_KINDS: dict[str, Kind] = {"leaves": "leaves", "needles": "needles", "bare": "bare"}


@dataclass(frozen=True, eq=False)
class Seen:
    """What photo and strokes show, at the working size; nothing is traced without a branch stroke."""

    sight: Sight
    foliage: Foliage
    traced: Traced | None


def see(photo: Photo, strokes: Strokes, known: Foliage | None = None, report: Report = silent) -> Seen:
    """Find the foliage, unless it is ``known``, and trace the branches of a photo (h, w, 3), sRGB.

    Raises
    ------
    StrokesError
        The strokes do not describe a tree.
    """
    report("foliage", 0.0)
    sight = look(photo, strokes)
    report("foliage", 0.05)
    foliage = known or segment_foliage(sight.photo, sight.strokes.crown.points, report=report)
    if not strokes.branches:
        return Seen(sight, foliage, None)
    report("trace", 0.0)
    height_px = sight.height_px(foliage.mask)
    traced = trace_branches(sight.photo, sight.strokes, foliage.leaf, foliage.ground, foliage.region, height_px)
    return Seen(sight, foliage, traced)


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
    kind = _borne_kind(shown, settings)
    wood = drawn(traced.skeleton, foliage.mask.shape)
    shows_leaves = shown != "bare" or kind == "bare"
    crown = closed(foliage.mask | (wood & foliage.region), CLOSED_SHARE[shown] if shows_leaves else LEAFED_SHARE)
    camera = sight.camera(foliage.mask, settings.height)
    envelope = envelope_of_mask(crown, camera)
    bulged = envelope.widened(BULGE)
    visible, owner = densified(traced.skeleton, JOINT_SHARE * sight.height_px(foliage.mask))
    lifted = lift(visible, traced.stroke[owner], bulged, rng)
    report("grow", 0.0)
    library = choose_library(settings.library, kind, lifted)
    grown = grow(lifted, crown, bulged, library, growth_for(kind, settings.iterations), rng, report)
    leafy = foliage.mask if shows_leaves else frayed(crown, rng)
    front = _front(foliage, traced, visible, owner, lifted.points[:, 2], leafy, shows_leaves)
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
        score={"attractors_reached": grown.attractors_reached},
        warnings=sight.warnings,
    )


def _stature(sight: Sight, foliage: Foliage, camera: Camera, traced: Traced, stem: Indices, crown: Envelope) -> Stature:
    """Tell the tree's height by the scale that the strokes or the settings set, and whether its trunk is seen."""
    known, error, metres = sight.strokes.scale, 0.0, camera.metres_per_pixel
    if known is not None:
        ends_px = ENDS_PX * max(sight.photo.shape) / WORKING_SIDE
        error = min(0.9, ends_px / float(np.hypot(*(known.points[1] - known.points[0]))))
    heights = (traced.skeleton.points[stem[0], 1] - traced.skeleton.points[stem, 1]) * metres
    seen = bool(traced.measured[stem[np.abs(heights - BREAST_HEIGHT).argmin()]])
    scale = Scale(metres * sight.scale, known is not None, error)
    return Stature(sight.height_px(foliage.mask) * metres, scale, seen, crown)


def _front(
    foliage: Foliage,
    traced: Traced,
    visible: Skeleton,
    owner: Indices,
    depth_m: Floats,
    leafy: Mask,
    shows_leaves: bool,
) -> NDArray[np.float32]:
    """World Z (h, w), metres, behind which leaves may lie: infinite in the foliage, that of the wood where it is seen.

    What is a leaf by its colour hangs before the wood.
    """
    what = visible, traced.measured[owner], depth_m, foliage.mask.shape
    wood, middle = drawn_depth(*what, 1.0), drawn_depth(*what, BARE_BREADTH)
    front = np.where(np.isnan(wood) | ~foliage.region, -np.inf, wood)
    leaves = foliage.pure & ~traced.wood & shows_leaves
    front[leafy & (np.isnan(middle) | leaves)] = np.inf
    return front.astype(np.float32)


def drawn(tree: Skeleton, shape: tuple[int, ...]) -> Mask:
    """Draw a traced skeleton as wide as its wood."""
    return ~np.isnan(drawn_depth(tree, np.ones(len(tree), dtype=bool), np.zeros(len(tree)), shape, 1.0))


def drawn_depth(
    tree: Skeleton, shown: Mask, depth_m: Floats, shape: tuple[int, ...], breadth: float
) -> NDArray[np.float32]:
    """Draw the depth of a skeleton's edges whose both joints are ``shown`` (n,), ``breadth`` times as wide as the wood.

    NaN where nothing is drawn.
    """
    drawn = np.full(shape, np.nan, np.float32)
    for joint, parent in enumerate(tree.parents.tolist()):
        if parent >= 0 and shown[joint] and shown[parent]:
            ends = [tuple(np.round((tree.points[at] - 0.5) * 16).astype(int).tolist()) for at in (parent, joint)]
            width = max(1, int(breadth * (tree.radii[joint] + tree.radii[parent])))
            cv2.line(drawn, ends[0], ends[1], float(depth_m[joint]), width, cv2.LINE_8, 4)
    return drawn


def _shown_kind(sight: Sight, foliage: Foliage, settings: ModelSettings) -> Kind:
    """Take the kind that was asked for, or judge by the picture; a season may ask for leaves that it does not show."""
    if settings.foliage == "auto" or settings.season in LEAFY:
        return foliage_kind(foliage.look, foliage.mask, sight.strokes.branches[0].points)
    return _KINDS[settings.foliage]


def _borne_kind(shown: Kind, settings: ModelSettings) -> Kind:
    """Tell what the twigs bear: what was asked for, else what season, species and photo say, in this order."""
    species = KINDS[settings.species]
    if settings.season == "bare" or settings.foliage == "bare":
        return "bare"
    if settings.foliage != "auto":
        return _KINDS[settings.foliage]
    if shown == "bare" and settings.season not in LEAFY and not species.evergreen:
        return "bare"
    if species == AUTO:
        return "leaves" if shown == "bare" else shown
    return "leaves" if species.needles is None else "needles"


def closed(mask: Mask, share: float) -> Mask:
    """Close small holes and bays of a foliage mask."""
    size = max(3, int(2 * share * np.sqrt(mask.sum())) | 1)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    edge = cv2.copyMakeBorder(mask.astype(np.uint8), size, size, size, size, cv2.BORDER_CONSTANT, value=0)
    return cv2.morphologyEx(edge, cv2.MORPH_CLOSE, kernel)[size:-size, size:-size].astype(bool)


def frayed(crown: Mask, rng: np.random.Generator) -> Mask:
    """Fray the outline of a crown whose leaves nobody has seen into clumps, and open some gaps."""
    size = float(np.sqrt(crown.sum()))
    height, width = crown.shape
    coarse = (max(2, round(width / (CLUMP * size))), max(2, round(height / (CLUMP * size))))
    clumps = cv2.resize(rng.standard_normal(coarse[::-1]), (width, height), interpolation=cv2.INTER_CUBIC)
    inward = cv2.distanceTransform(np.pad(crown.astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    bays = FRAY * size * np.clip(0.3 - 0.5 * clumps, 0.0, 1.0)
    return np.asarray(crown & (inward > bays) & (clumps > -GAP))
