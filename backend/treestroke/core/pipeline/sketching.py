"""The first half of the sketches' recipe: from a front and a left side to a grown tree, by depth retrieval."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from treestroke.core.appearance import Appearance, StemPixels, View
from treestroke.core.errors import StrokesError
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette
from treestroke.core.geometry.outline_volume import turned_outline
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.self_similar import SelfSimilarParams, grow_small
from treestroke.core.imaging.opacity import over_white
from treestroke.core.imaging.outline import fill_outline
from treestroke.core.lift.spread import FrontCrown, FrontTree
from treestroke.core.pipeline.crowns import drawn, frayed, seen_from_front
from treestroke.core.pipeline.grown_tree import GrownTree, Reading
from treestroke.core.pipeline.lifting import lift_front, method_for
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sides import (
    Side,
    crown_height,
    draw_side,
    side_of,
    stroke_height,
    with_depth,
)
from treestroke.core.pipeline.taken import Taken, taken_for
from treestroke.core.pipeline.working_copy import WORKING_SIDE
from treestroke.core.progress import Report, silent
from treestroke.core.segment.foliage import segment_foliage
from treestroke.core.segment.kind import UNJUDGED, kind_odds, likeliest
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Sketch, StrokeWarning
from treestroke.core.survey.measures import BREAST_HEIGHT, Scale, Stature
from treestroke.core.trace.drawing import Drawing
from treestroke.core.types import Mask, Picture

WORKING_HEIGHT = 1000.0
"""Height, px, to which a tree is scaled."""
SMALL_BRANCHES = 8
"""Small branches for each round of growth that the settings allow."""
LEAFED_SHARE = 0.035
"""Leaves of a sketched crown lie within this share of the tree's height from its branches."""
ROOT_SWELLING = 1.5
"""Least radius of a drawn stem at its root over that above its flare: few draw a flare."""
AS_DRAWN = Reading("the strokes as they were drawn", ())
ONE_SIDE = StrokeWarning(
    "side_assumed",
    "side",
    "there is no sketch of the left side: limbs were spread in depth, in a crown as deep as it is wide",
)


@dataclass(frozen=True, eq=False)
class SketchEvidence:
    """What the sketches show, each on its own canvas, and the front's photo (h, w, 3) where it was drawn over one."""

    front: Drawing
    side: Drawing | None
    photo: Picture | None

    @property
    def warnings(self) -> tuple[StrokeWarning, ...]:
        """What was mended or assumed."""
        return self.front.warnings + ((ONE_SIDE,) if self.side is None else self.side.warnings)


@dataclass(frozen=True, eq=False)
class _Frame:
    """The front at the working size.

    Attributes
    ----------
    evidence
        What the sketches show, on their own canvases.
    scale
        Its size over that of its canvas.
    tree
        Its skeleton, px.
    crown
        Its crown.
    side
        The left side at the same scale.
    """

    evidence: SketchEvidence
    scale: float
    tree: Branched
    crown: Silhouette[OrthographicCamera]
    side: Side | None

    @property
    def height_px(self) -> float:
        """Height of the front's strokes, px."""
        return stroke_height(self.evidence.front) * self.scale

    @property
    def camera(self) -> OrthographicCamera:
        """The front's, at this size."""
        return self.crown.camera


@dataclass(frozen=True, eq=False)
class _LiftedSketch:
    """The drawn branches in 3D (metres), the crown's volume, and how well the branches match the sketches."""

    tree: Branched
    volume: CrownVolume
    score: dict[str, float]


def read_sketches(
    front: Sketch, side: Sketch | None = None, photo: Picture | None = None, report: Report = silent
) -> SketchEvidence:
    """Find the 2D skeletons of a front sketch and, where there is one, of a left-side sketch.

    ``photo`` (h, w, 3 or 4), sRGB, is what the front was drawn over: the tree takes its colours.

    Raises
    ------
    StrokesError
        A sketch does not describe a tree, or the front does not fit its photo.
    """
    report("trace", 0.0)
    if photo is not None:
        front = _over(front, photo)
    drawing = draw_side(front, "front")
    report("trace", 0.5)
    under = None if photo is None else over_white(photo)
    return SketchEvidence(drawing, None if side is None else draw_side(side, "side"), under)


def grow_sketches(
    evidence: SketchEvidence, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> GrownTree:
    """Join the sketches to a 3D tree and let small branches fill its crown.

    Other seeds give other small branches; with one sketch alone, also another depth.
    """
    report("lift", 0.0)
    frame = _framed(evidence, settings.height)
    lifted = _lifted(frame, settings, rng)
    report("grow", 0.0)
    params = SelfSimilarParams(most=SMALL_BRANCHES * settings.iterations)
    grown = replace(grow_small(lifted.tree, lifted.volume, params, rng, report), root_swelling=ROOT_SWELLING)
    return _grown_tree(frame, settings, lifted, grown, rng)


def _over(front: Sketch, photo: Picture) -> Sketch:
    """Return the sketch with its photo's size as canvas.

    Raises
    ------
    StrokesError
        The sketch is larger than its photo, or a picture of another size.
    """
    size = photo.shape[1], photo.shape[0]
    fits = front.canvas[0] <= size[0] and front.canvas[1] <= size[1]
    if not fits or (front.ink is not None and front.canvas != size):
        fault = f"its canvas is {front.canvas[0]} x {front.canvas[1]} px, its photo {size[0]} x {size[1]}"
        raise StrokesError.at(("front",), f"{fault}; draw over the photo at its own size", "canvas_mismatch")
    return replace(front, canvas=size)


def _framed(evidence: SketchEvidence, height_m: float) -> _Frame:
    """Scale the front to the working size; ``height_m`` is the height of the crown's top, metres."""
    front, (width, height) = evidence.front, evidence.front.size
    scale = min(WORKING_HEIGHT / crown_height(front), WORKING_SIDE / max(width, height))
    scale = scale if evidence.photo is None else min(scale, 1.0)
    skeleton = front.tree.skeleton
    tree = Branched(Skeleton(skeleton.points * scale, skeleton.radii * scale, skeleton.parents), front.tree.branch)
    root_x, root_y = (skeleton.points[0] * scale).tolist()
    size = max(1, round(width * scale)), max(1, round(height * scale))
    camera = OrthographicCamera(*size, height_m / (crown_height(front) * scale), (root_x, root_y))
    crown = Silhouette(fill_outline(front.crown * scale, size[1], size[0]), camera)
    if evidence.side is None:
        return _Frame(evidence, scale, tree, crown, None)
    side = side_of(evidence.side, stroke_height, stroke_height(front) * scale, camera)
    return _Frame(evidence, scale, tree, crown, side)


def _lifted(frame: _Frame, settings: ModelSettings, rng: np.random.Generator) -> _LiftedSketch:
    """Turn the drawn branches into the world: by the left side, or by spreading them in depth."""
    outline = turned_outline(frame.crown)
    if frame.side is None:
        front = FrontTree(frame.tree.skeleton, frame.tree.branch, np.zeros(len(frame.tree), dtype=bool))
        tree = lift_front(front, FrontCrown(outline, frame.camera), method_for(settings.lift, few=False), rng)
        return _LiftedSketch(Branched(tree, frame.tree.branch), outline, {})
    retrieved = with_depth(frame.tree, frame.side, frame.height_px, frame.camera)
    return _LiftedSketch(retrieved.tree, outline.with_side(frame.side.crown), retrieved.score)


def _grown_tree(
    frame: _Frame, settings: ModelSettings, lifted: _LiftedSketch, grown: Grown, rng: np.random.Generator
) -> GrownTree:
    """Return the grown tree that the second half of the recipe finishes."""
    main, camera = lifted.tree, frame.camera
    radii = grown.skeleton.radii[: len(main)]
    wood = seen_from_front(Skeleton(main.skeleton.points, radii, main.skeleton.parents), camera)
    stem = main.branch == 0
    leafy = _leafy(frame, grown, rng)
    taken, view, shows_leaves = _view(frame, settings, leafy, StemPixels(wood.points[stem], wood.radii[stem]))
    tree = (leafy & (taken.foliage != "bare")) | drawn(wood, leafy.shape)
    whole = camera.enlarged(frame.scale, frame.evidence.front.size)
    return GrownTree(
        taken=taken,
        grown=grown,
        volume=lifted.volume,
        appearance=Appearance((replace(view, tree=tree),), shows_leaves),
        camera=whole,
        expected=(Silhouette(tree, whole),),
        stature=_stature(frame, lifted.volume),
        score=lifted.score,
        reading=AS_DRAWN,
        warnings=frame.evidence.warnings,
    )


def _leafy(frame: _Frame, grown: Grown, rng: np.random.Generator) -> Mask:
    """Mark where the tree is to have leaves (h, w): near its branches, in a crown whose outline is frayed."""
    wood = drawn(seen_from_front(grown.skeleton, frame.camera), frame.crown.mask.shape)
    away = cv2.distanceTransform((~wood).astype(np.uint8), cv2.DIST_L2, 5)
    return np.asarray(frayed(frame.crown.mask, rng, np.inf) & (away <= LEAFED_SHARE * WORKING_HEIGHT))


def _view(frame: _Frame, settings: ModelSettings, leafy: Mask, stem: StemPixels) -> tuple[Taken, View, bool]:
    """Take colours from the photo that the front was drawn over; on white they are the species' own.

    Returns what the tree is taken for, the view of the foliage alone, and whether it shows leaves.
    """
    leaves_from, opacity = np.where(leafy, -np.inf, np.inf).astype(np.float32), leafy.astype(np.float32)
    photo = frame.evidence.photo
    if photo is None:
        blank = np.full((*leafy.shape, 3), 255, dtype=np.uint8)
        unseen_stem = replace(stem, radii_px=np.zeros(len(stem.radii_px)))
        taken = taken_for(UNJUDGED, "round", settings)
        return taken, View(frame.camera, blank, leaves_from, opacity, leafy, leafy, unseen_stem), False
    if frame.scale != 1.0:
        photo = np.asarray(cv2.resize(photo, leafy.shape[::-1], interpolation=cv2.INTER_AREA), dtype=np.uint8)
    crown_px = frame.evidence.front.crown * frame.scale
    foliage = segment_foliage(photo, crown_px)
    odds = kind_odds(foliage.cues, crown_px, stem.points_px)
    view = View(frame.camera, photo, leaves_from, opacity, foliage.pure, leafy, stem)
    return taken_for(odds, "round", settings), view, likeliest(odds) != "bare"


def _stature(frame: _Frame, volume: CrownVolume) -> Stature:
    """Return the tree's height, set by the person, and whether the trunk was drawn with a width."""
    camera, skeleton, trunk = frame.camera, frame.tree.skeleton, frame.tree.branch == 0
    heights = camera.heights_from_rows(skeleton.points[trunk, 1])
    drawn_at = skeleton.radii[trunk][np.abs(heights - BREAST_HEIGHT).argmin()] > 0
    height = float(camera.metres_from_pixels(crown_height(frame.evidence.front) * frame.scale))
    return Stature(height, Scale(float(camera.metres_from_pixels(frame.scale)), False, 0.0), bool(drawn_at), volume)
