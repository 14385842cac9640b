"""System D: a 3D tree from sketches of its front and its left side (depth retrieval), from top to bottom."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from treestroke.core.errors import StrokesError
from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.envelope import Envelope, envelope_of_mask
from treestroke.core.geometry.views import CrownViews, View
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.self_similar import SelfSimilarParams, grow_small
from treestroke.core.imaging.outline import fill_outline
from treestroke.core.lift.spread import lift
from treestroke.core.pipeline.crowns import drawn, frayed
from treestroke.core.pipeline.dressing import NO_PICTURES, OwnPictures
from treestroke.core.pipeline.finishing import OnGrown, TreeModel, finish, unseen
from treestroke.core.pipeline.growing import borne_kind
from treestroke.core.pipeline.grown_tree import GrownTree, Portrait, Reading, Stature
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sides import (
    Side,
    crown_height,
    deepened,
    draw_side,
    side_of,
    stroke_height,
    with_depth,
)
from treestroke.core.pipeline.working_copy import WORKING_SIDE
from treestroke.core.progress import Report, silent
from treestroke.core.segment.foliage import segment_foliage
from treestroke.core.segment.kind import foliage_kind
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Sketch, StrokeWarning
from treestroke.core.survey.measures import BREAST_HEIGHT, Scale
from treestroke.core.trace.drawing import Drawing
from treestroke.core.types import Floats, FoliageKind, Mask, Picture

WORKING_HEIGHT = 1000.0
"""Height, px, that a tree is brought to."""
SMALL_BRANCHES = 8
"""Small branches for each round of growth that the settings allow."""
LEAFED_SHARE = 0.035
"""Of the tree's height: as far from its branches a sketched crown is leafy."""
AS_DRAWN = Reading("the strokes as they were drawn", 1.0, ())
ONE_SIDE = StrokeWarning(
    "side_assumed",
    "side",
    "there is no sketch of the left side: limbs were spread in depth, in a crown as deep as it is wide",
)


@dataclass(frozen=True, eq=False)
class SeenSketches:
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
    """The front at the working size: ``scale`` times its canvas, its camera there, its skeleton px, its crown."""

    scale: float
    camera: Camera
    tree: Branched
    crown: Mask


def see_sketches(
    front: Sketch, side: Sketch | None = None, photo: Picture | None = None, report: Report = silent
) -> SeenSketches:
    """Find the 2D skeletons of a front sketch and, where there is one, of a left-side sketch.

    ``photo`` (h, w, 3), sRGB, is what the front was drawn over: the tree takes its colours.

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
    return SeenSketches(drawing, None if side is None else draw_side(side, "side"), photo)


def grow_sketches(
    seen: SeenSketches, settings: ModelSettings, rng: np.random.Generator, report: Report = silent
) -> GrownTree:
    """Join the sketches to a 3D tree and let small branches fill its crown.

    Other seeds give other small branches; with one sketch alone, also another depth.
    """
    report("lift", 0.0)
    frame = _framed(seen, settings.height)
    side = None
    if seen.side is not None:
        side = side_of(seen.side, stroke_height, _height_px(seen, frame), frame.camera.metres_per_pixel)
    envelope = envelope_of_mask(frame.crown, frame.camera)
    envelope = envelope if side is None else deepened(envelope, side)
    main, score = _main_branches(seen, frame, side, envelope, rng)
    report("grow", 0.0)
    views = CrownViews(View(frame.crown, frame.camera), None if side is None else side.crown)
    params = SelfSimilarParams(most=SMALL_BRANCHES * settings.iterations)
    grown = grow_small(main, views, envelope, params, rng, report)
    return _grown_tree(seen, settings, frame, envelope, main, grown, score, rng)


def model_sketches(
    seen: SeenSketches,
    settings: ModelSettings,
    rng: np.random.Generator,
    report: Report = silent,
    on_grown: OnGrown = unseen,
    pictures: OwnPictures = NO_PICTURES,
) -> TreeModel:
    """Turn sketches into a tree, as `treestroke.core.pipeline.photo.model_photo` does a photo."""
    tree = grow_sketches(seen, settings, rng, report)
    on_grown(tree.live)
    return finish(tree, settings, rng, report, pictures)


def _over(front: Sketch, photo: Picture) -> Sketch:
    """Let a sketch lie on its photo.

    Raises
    ------
    StrokesError
        It is larger, or a picture of another size.
    """
    size = photo.shape[1], photo.shape[0]
    fits = front.canvas[0] <= size[0] and front.canvas[1] <= size[1]
    if not fits or (front.ink is not None and front.canvas != size):
        what = f"its canvas is {front.canvas[0]} x {front.canvas[1]} px, its photo {size[0]} x {size[1]}"
        raise StrokesError.at(("front",), f"{what}; draw over the photo at its own size", "canvas_mismatch")
    return replace(front, canvas=size)


def _framed(seen: SeenSketches, height_m: float) -> _Frame:
    """Bring the front to the working size and set its scale: the height is that of the crown's top."""
    front, (width, height) = seen.front, seen.front.size
    scale = min(WORKING_HEIGHT / crown_height(front), WORKING_SIDE / max(width, height))
    scale = scale if seen.photo is None else min(scale, 1.0)
    skeleton = front.tree.skeleton
    tree = Branched(Skeleton(skeleton.points * scale, skeleton.radii * scale, skeleton.parents), front.tree.branch)
    root_x, root_y = (skeleton.points[0] * scale).tolist()
    size = max(1, round(width * scale)), max(1, round(height * scale))
    camera = Camera(*size, height_m / (crown_height(front) * scale), (root_x, root_y))
    return _Frame(scale, camera, tree, fill_outline(front.crown * scale, size[1], size[0]))


def _height_px(seen: SeenSketches, frame: _Frame) -> float:
    return stroke_height(seen.front) * frame.scale


def _main_branches(
    seen: SeenSketches, frame: _Frame, side: Side | None, envelope: Envelope, rng: np.random.Generator
) -> tuple[Branched, dict[str, float]]:
    """Give the drawn branches depth: from the side, or by spreading them; tell how true they are to the sketches."""
    if side is None:
        return Branched(lift(frame.tree.skeleton, frame.tree.branch, envelope, rng), frame.tree.branch), {}
    deep = with_depth(frame.tree, side, _height_px(seen, frame), frame.camera)
    return deep.tree, deep.score


def _grown_tree(
    seen: SeenSketches,
    settings: ModelSettings,
    frame: _Frame,
    envelope: Envelope,
    main: Branched,
    grown: Grown,
    score: dict[str, float],
    rng: np.random.Generator,
) -> GrownTree:
    """Gather what the tree is dressed and measured by."""
    camera, radii = frame.camera, grown.skeleton.radii[: len(main)]
    wood = _in_picture(Skeleton(main.skeleton.points, radii, main.skeleton.parents), camera)
    stem = main.branch == 0
    leafy = _leafy(frame, grown, rng)
    kind, portrait = _portrait(seen, settings, frame, leafy, wood.points[stem], wood.radii[stem])
    root_x, root_y = camera.root_px
    return GrownTree(
        kind=kind,
        grown=grown,
        envelope=envelope,
        camera=Camera(
            *seen.front.size,
            camera.metres_per_pixel * frame.scale,
            (root_x / frame.scale, root_y / frame.scale),
        ),
        portrait=portrait,
        stature=_stature(seen, frame, envelope),
        likeness=(leafy & (kind != "bare")) | drawn(wood, leafy.shape),
        score=score,
        reading=AS_DRAWN,
        warnings=seen.warnings,
    )


def _leafy(frame: _Frame, grown: Grown, rng: np.random.Generator) -> Mask:
    """Tell where the tree is to have leaves: near its branches, in a crown whose outline is frayed."""
    wood = drawn(_in_picture(grown.skeleton, frame.camera), frame.crown.shape)
    away = cv2.distanceTransform((~wood).astype(np.uint8), cv2.DIST_L2, 5)
    return np.asarray(frayed(frame.crown, rng, np.inf) & (away <= LEAFED_SHARE * WORKING_HEIGHT))


def _portrait(
    seen: SeenSketches, settings: ModelSettings, frame: _Frame, leafy: Mask, stem: Floats, stem_radii: Floats
) -> tuple[FoliageKind, Portrait]:
    """Take colours from the photo that the front was drawn over; on white they are the species' own."""
    front = np.where(leafy, np.inf, -np.inf).astype(np.float32)
    if seen.photo is None:
        season = "summer" if settings.season == "photo" else settings.season
        kind = borne_kind("bare", replace(settings, season=season))
        blank = np.full((*leafy.shape, 3), 255, dtype=np.uint8)
        return kind, Portrait(blank, False, leafy, front, stem, np.zeros(len(stem)))
    photo = seen.photo
    if frame.scale != 1.0:
        photo = np.asarray(cv2.resize(photo, leafy.shape[::-1], interpolation=cv2.INTER_AREA), dtype=np.uint8)
    foliage = segment_foliage(photo, seen.front.crown * frame.scale)
    shown = foliage_kind(foliage.look, foliage.mask, stem)
    kind = borne_kind(shown, settings)
    return kind, Portrait(photo, shown != "bare", foliage.pure, front, stem, stem_radii)


def _stature(seen: SeenSketches, frame: _Frame, envelope: Envelope) -> Stature:
    """Tell the tree's height, which was given, and whether a brush told how thick the trunk is."""
    metres, trunk = frame.camera.metres_per_pixel, frame.tree.branch == 0
    heights = (frame.camera.root_px[1] - frame.tree.skeleton.points[trunk, 1]) * metres
    drawn_at = frame.tree.skeleton.radii[trunk][np.abs(heights - BREAST_HEIGHT).argmin()] > 0
    height = crown_height(seen.front) * frame.scale * metres
    return Stature(height, Scale(metres * frame.scale, False, 0.0), bool(drawn_at), envelope)


def _in_picture(tree: Skeleton, camera: Camera) -> Skeleton:
    """See a 3D tree, metres, from the front: px."""
    return Skeleton(camera.pixels_from_world(tree.points), tree.radii / camera.metres_per_pixel, tree.parents)
