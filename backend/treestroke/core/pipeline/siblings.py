"""The first half of a sibling's recipe: from a grown tree of any source to another one of the same kind."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from treestroke.core.appearance import Appearance, StemPixels, View
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette
from treestroke.core.geometry.outline_volume import turned_outline
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.library import choose_library
from treestroke.core.grow.palm import grow_palm
from treestroke.core.grow.params import growth_for
from treestroke.core.grow.reaching import reaching
from treestroke.core.grow.replacement import CrownToFill, Replacement, grow
from treestroke.core.grow.trimming import trimmed
from treestroke.core.imaging.outline import fill_outline
from treestroke.core.lift.clumps import in_clumps
from treestroke.core.lift.imagined import imagined_crown
from treestroke.core.pipeline.clear_views import clear_views
from treestroke.core.pipeline.crowns import drawn, frayed, seen_from_front
from treestroke.core.pipeline.growing import BULGE
from treestroke.core.pipeline.grown_tree import Filmed, GrownTree, LearntMotion, Reading
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.progress import Report, silent
from treestroke.core.siblings.branching_model import BranchingModel, learn_branching
from treestroke.core.siblings.limb_growth import grow_limbs
from treestroke.core.siblings.new_front import FrontPicture, new_front, spread_over, varied_outline
from treestroke.core.siblings.outlines import Envelope, fitted
from treestroke.core.survey.measures import Scale, Stature
from treestroke.core.types import Floats, Mask

HEIGHT_PX = 1000.0
"""Height, px, of siblings in their fronts."""
TALLER = 0.06
"""Standard deviation of the logarithm of a sibling's height over the example's."""
SHARE_GROWN, FULLER_GROWN = 0.15, 0.4
"""Share of the rounds of growth that siblings take, since their limbs are there before; in an outline unlike that of
the example, which limbs as learnt do not fill, and of a bare tree, all of whose twigs are seen."""
OPAQUE = 0.8
"""Opacity above which a pixel shows a leaf in its own colour."""
AT_EDGE = 0.06
"""Room around a sibling in its front, as a share of its height."""
CLIPPED_GAP = 2.6
"""How rare gaps are in a crown that was cut to an outline, in standard deviations as for `frayed`."""
READ = Reading("the outline that it was to fill", ())


@dataclass(frozen=True, eq=False)
class Example:
    """A grown tree, and what is learnt of it.

    Attributes
    ----------
    tree
        The tree.
    branching
        How it branches.
    front
        Its front, `HEIGHT_PX` high.
    moves
        How it moves, if it was filmed.
    """

    tree: GrownTree
    branching: BranchingModel
    front: FrontPicture
    moves: LearntMotion | None


def learn(tree: GrownTree, light: str) -> Example:
    """Learn from a grown tree what its siblings are to be like; ``light`` is one of the setting's values."""
    clear = replace(tree, appearance=clear_views(tree.appearance, light))
    return Example(clear, learn_branching(tree.grown.skeleton), _front(clear), _moves(tree))


def grow_sibling(
    example: Example,
    settings: ModelSettings,
    rng: np.random.Generator,
    report: Report = silent,
    envelope: Envelope | None = None,
) -> GrownTree:
    """Grow another tree of the example's kind, in a crown like the example's or in an ``envelope``.

    It has limbs, crown and front of its own; colours, bark and the kind of its foliage are the example's. In an
    envelope it is as high as the example, else a little higher or lower. If the example was filmed, it moves alike.
    """
    report("grow", 0.0)
    room = _room(example, rng, envelope)
    grown, volume = _filled(example, room, settings, rng, report)
    tree, camera = example.tree, room.front.camera
    wood = drawn(seen_from_front(grown.skeleton, camera), room.leafy.shape)
    leafy = room.leafy & (tree.kind != "bare")
    view = _view(example, room, leafy, leafy | wood)
    known = tree.stature.scale
    scale = Scale(float(camera.metres_from_pixels(1.0)), known.known, known.error)
    return GrownTree(
        taken=tree.taken,
        grown=grown,
        volume=volume,
        appearance=Appearance((view,), tree.appearance.shows_leaves),
        camera=camera,
        expected=(Silhouette(leafy | wood, camera),),
        stature=Stature(room.height, scale, False, volume),
        score={"attractors_reached": grown.attractors_reached},
        reading=READ,
        warnings=(),
        moves=example.moves,
    )


def _moves(tree: GrownTree) -> LearntMotion | None:
    """Learn how a tree moves that was filmed."""
    if not isinstance(tree.moves, Filmed):
        return None
    from treestroke.core.pipeline.tree_motion import learnt_motion  # of no use for trees that were not filmed

    return learnt_motion(tree.grown.skeleton, tree.moves, tree.camera)


@dataclass(frozen=True, eq=False)
class _Room:
    """What a sibling is to fill.

    Attributes
    ----------
    front
        Its front, before it is there.
    outline
        (h, w) what its crown is to fill.
    leafy
        (h, w) where it is to have leaves.
    clipped
        Whether it is cut to a shape.
    """

    front: FrontPicture
    outline: Mask
    leafy: Mask
    clipped: bool

    @property
    def height(self) -> float:
        """Height of the highest leaf, metres."""
        top = np.flatnonzero(self.leafy.any(axis=1))[:1].astype(np.float64)
        return float(self.front.camera.heights_from_rows(top)[0])


def _front(tree: GrownTree) -> FrontPicture:
    """Return a tree's front at the size in which siblings' fronts are made."""
    view = tree.appearance.views[0]
    scale = tree.stature.height / HEIGHT_PX
    factor = float(view.camera.pixel_size(np.zeros((1, 3)))[0]) / scale
    size = (max(1, round(view.camera.width * factor)), max(1, round(view.camera.height * factor)))
    root = (view.camera.pixels_from_world(np.zeros((1, 3)))[0] * factor).tolist()
    camera = OrthographicCamera(*size, scale, (root[0], root[1]))
    foliage = view.foliage | view.tree if tree.kind == "bare" else view.foliage
    masks = [foliage.astype(np.uint8), view.leaf_coloured.astype(np.uint8)]
    shown, coloured = (cv2.resize(mask, size, interpolation=cv2.INTER_NEAREST) > 0 for mask in masks)
    picture = cv2.resize(view.picture, size, interpolation=cv2.INTER_AREA)
    opacity = np.asarray(cv2.resize(view.opacity, size, interpolation=cv2.INTER_AREA), np.float32)
    own = (coloured if (coloured & shown).any() else shown) & (opacity > OPAQUE)
    return FrontPicture(camera, spread_over(np.asarray(picture, np.uint8), own & shown), shown, opacity, coloured)


def _room(example: Example, rng: np.random.Generator, envelope: Envelope | None) -> _Room:
    """Choose a sibling's outline, and make its front of the example's."""
    old = example.front
    if envelope is None:
        points = varied_outline(old, rng) * np.exp(np.clip(rng.normal(0, TALLER), -2 * TALLER, 2 * TALLER))
    else:
        lowest = np.flatnonzero(old.foliage.any(axis=1))[-1]
        foot = float(old.camera.heights_from_rows(np.array([lowest + 1.0]))[0])
        points = fitted(envelope, example.tree.stature.height, foot)
    camera = _camera(points, float(old.camera.metres_from_pixels(1.0)))
    outline = fill_outline(camera.pixels_from_world(np.insert(points, 2, 0.0, axis=1)), camera.height, camera.width)
    front = new_front(old, outline, camera, rng)
    if envelope is not None:
        return _Room(front, outline, frayed(outline, rng, CLIPPED_GAP), True)
    return _Room(front, outline, front.foliage, False)


def _camera(outline: Floats, metres_per_pixel: float) -> OrthographicCamera:
    """Return a camera for a tree with this outline (n, 2), metres."""
    high = float(outline[:, 1].max())
    edge = AT_EDGE * high
    left, right = max(-float(outline[:, 0].min()), 0.0) + edge, max(float(outline[:, 0].max()), 0.0) + edge
    below = max(-float(outline[:, 1].min()), 0.0) + edge
    size = (round((left + right) / metres_per_pixel), round((high + edge + below) / metres_per_pixel))
    return OrthographicCamera(*size, metres_per_pixel, (left / metres_per_pixel, (high + edge) / metres_per_pixel))


def _filled(
    example: Example, room: _Room, settings: ModelSettings, rng: np.random.Generator, report: Report
) -> tuple[Grown, CrownVolume]:
    """Grow the sibling in its crown: limbs as learnt, then small branches as on any tree."""
    tree, camera = example.tree, room.front.camera
    front = Silhouette(room.outline if room.clipped else _solid(room), camera)
    outline = turned_outline(front)
    if tree.kind == "palm":
        stems = grow_limbs(replace(example.branching, orders=()), outline, room.height, rng)
        return grow_palm(stems, CrownToFill(outline, front), settings.iterations, rng), outline
    imagined = imagined_crown(outline if room.clipped else outline.widened(BULGE), front, rng)
    volume: CrownVolume = outline if room.clipped else imagined.hull()
    limbs = grow_limbs(example.branching, volume, room.height, rng)
    if not room.clipped:
        volume = in_clumps(imagined, camera.picture_space_from_world(limbs.points), rng)
    share = FULLER_GROWN if room.clipped or tree.kind == "bare" else SHARE_GROWN
    library = choose_library(settings.library, tree.kind, limbs, tree.taken.form)
    method = Replacement(library, growth_for(tree.kind, round(share * settings.iterations), tree.taken.form))
    grown = grow(limbs, CrownToFill(volume, front), method, rng, report)
    if tree.kind != "bare":
        leafy = Silhouette(room.leafy, camera)
        grown = reaching(trimmed(grown, leafy, volume), leafy, volume)
    return grown, volume


def _solid(room: _Room) -> Mask:
    """Return the front's foliage (h, w) with its holes closed, within its outline."""
    size = max(3, int(0.04 * np.sqrt(room.leafy.sum())) | 1)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    return np.asarray(cv2.morphologyEx(room.leafy.astype(np.uint8), cv2.MORPH_CLOSE, kernel) > 0)


def _view(example: Example, room: _Room, leafy: Mask, tree: Mask) -> View:
    """Return the view that shows the sibling; the example's stem stands beside it, for bark is read there."""
    front = room.front
    stem = _stem_panel(example.tree, front.camera.height)
    width = stem.camera.width
    camera = replace(front.camera, width=front.camera.width + width)
    panel = ((0, 0), (0, width))
    opacity = np.where(leafy & front.foliage, front.opacity, leafy.astype(np.float32)).astype(np.float32)
    return View(
        camera,
        np.hstack([front.picture, stem.picture]),
        np.pad(np.where(leafy, -np.inf, np.inf).astype(np.float32), panel, constant_values=np.inf),
        np.pad(opacity, panel),
        np.pad(front.leaf_coloured & leafy, panel),
        np.hstack([tree & (example.tree.kind != "bare"), stem.tree]),
        replace(stem.stem, points_px=stem.stem.points_px + np.array([front.camera.width, 0.0])),
    )


def _stem_panel(tree: GrownTree, height: int) -> View:
    """Return the part of the view that shows the example's stem best, scaled so that it is ``height`` px high."""
    view = tree.appearance.bark_view
    points, radii = view.stem.points_px, view.stem.radii_px
    reach = np.maximum(2 * radii, 2.0)[:, None]
    low = np.maximum(np.floor((points - reach).min(axis=0)), 0).astype(np.int64)
    size = np.array([view.camera.width, view.camera.height])
    high = np.minimum(np.ceil((points + reach).max(axis=0)), size).astype(np.int64)
    low, high = np.minimum(low, size - 1), np.maximum(high, np.minimum(low, size - 1) + 1)
    part = slice(low[1], high[1]), slice(low[0], high[0])
    factor = min(1.0, height / float(high[1] - low[1]))
    width, shown = max(1, round(factor * float(high[0] - low[0]))), max(1, round(factor * float(high[1] - low[1])))
    picture = np.full((height, width, 3), 255, dtype=np.uint8)
    picture[:shown] = cv2.resize(view.picture[part], (width, shown), interpolation=cv2.INTER_AREA)
    wood = np.zeros((height, width), dtype=np.bool_)
    seen = (view.tree & ~view.foliage)[part].astype(np.uint8)
    wood[:shown] = cv2.resize(seen, (width, shown), interpolation=cv2.INTER_NEAREST) > 0
    blank = np.zeros((height, width), dtype=np.float32)
    camera = OrthographicCamera(width, height, 1.0, (0.0, 0.0))
    stem = StemPixels((points - low) * factor, radii * factor)
    return View(camera, picture, np.full_like(blank, np.inf), blank, blank > 0, wood, stem)
