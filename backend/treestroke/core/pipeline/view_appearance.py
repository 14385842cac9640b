"""What several photos of one tree show of it: a view for each, for its leaves and its bark."""

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.appearance import Appearance, StemPixels, View
from treestroke.core.capture import Shot, TreeMatte
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.imaging.levelling import levelled
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.pipeline.crowns import LEAFED_SHARE, closed
from treestroke.core.side_by_side import side_by_side
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children
from treestroke.core.types import Floats, Indices, Mask

WOODEN = 0.5
"""How likely a pixel must be wood to be taken for it."""
SURELY_LEAF = 0.25
"""How likely a pixel may be wood that by its own colour is a leaf."""
MARGIN = 0.1
"""Width of what is kept around the tree, as a share of its greater extent in the picture."""
ALIKE_SHOWN = 0.8
"""How much of the stem a view shows, over what the best one shows, that is good enough for its bark."""
TWIG = 0.012
"""Width of wood, as a share of the tree's height, up to which leaves hide it on a bare tree that is given leaves."""
FULL = 0.9
"""Least opacity of a pixel that shows leaves alone."""


def view_appearance(
    shots: Sequence[Shot], mattes: Sequence[TreeMatte], skeleton: Skeleton, shows_leaves: bool = True
) -> Appearance:
    """Return what the shots show of a tree: a view for each that shows it, in light that goes with that of the others.

    Parameters
    ----------
    shots, mattes
        The photos, and where each shows the tree.
    skeleton
        Its wood, metres, in the shots' frame: what the depth of the wood is that they show.
    shows_leaves
        Whether they show it in leaf. If not, leaves may hang between its twigs, in colours that they do not tell.

    Raises
    ------
    ValueError
        No shot shows the tree.
    """
    if not any(matte.tree.any() for matte in mattes):
        raise ValueError("no shot shows the tree")
    stem = _stem(skeleton)
    pairs = [_cropped(*pair) for pair in zip(shots, mattes, strict=True) if pair[1].tree.any()]
    toward = np.stack([-shot.camera.ahead for shot, _ in pairs])
    trees = [matte.tree & ~matte.hidden for _, matte in pairs]
    pictures = levelled([shot.picture for shot, _ in pairs], trees, np.arctan2(toward[:, 0], toward[:, 2]))
    lit = [
        (Shot(shot.name, picture, shot.camera), matte) for (shot, matte), picture in zip(pairs, pictures, strict=True)
    ]
    views = side_by_side(lambda pair: _view(*pair, skeleton, stem, shows_leaves), lit)
    return Appearance(_bark_in_usual_light(tuple(views)), shows_leaves)


def _bark_in_usual_light(views: tuple[View, ...]) -> tuple[View, ...]:
    """Leave the stem's pixels to one view: of those that show most of it, that which is least in sun or shade."""
    shown = np.array([view.stem.radii_px.sum() for view in views])
    rivals = np.flatnonzero(shown >= ALIKE_SHOWN * shown.max())
    light = [_stem_light(views[rival]) for rival in rivals.tolist()]
    chosen = int(rivals[np.argsort(light, kind="stable")[len(rivals) // 2]])
    return tuple(
        view if number == chosen else replace(view, stem=StemPixels(view.stem.points_px, 0.0 * view.stem.radii_px))
        for number, view in enumerate(views)
    )


def _stem_light(view: View) -> float:
    """Mean light of the stem's axis where it is seen, steps of sRGB."""
    seen = view.stem.points_px[view.stem.radii_px > 0]
    return float(sample_nearest(view.picture, seen, 0).mean()) if len(seen) else 0.0


def _cropped(shot: Shot, matte: TreeMatte) -> tuple[Shot, TreeMatte]:
    """Cut the part that shows the tree out of a shot and its matte: the rest is not needed, and takes time."""
    left, top, width, height = cv2.boundingRect((matte.tree | matte.hidden).astype(np.uint8))
    margin = round(MARGIN * max(width, height))
    left, top, right, bottom = (
        max(0, left - margin),
        max(0, top - margin),
        min(shot.camera.width, left + width + margin),
        min(shot.camera.height, top + height + margin),
    )
    part, camera = np.s_[top:bottom, left:right], shot.camera.cropped((left, top), (right - left, bottom - top))
    cut = TreeMatte(matte.opacity[part], matte.wood[part], matte.hidden[part])
    return Shot(shot.name, np.ascontiguousarray(shot.picture[part]), camera), cut


def _view(shot: Shot, matte: TreeMatte, skeleton: Skeleton, stem: Indices, shows_leaves: bool) -> View:
    """Return what one shot shows."""
    wood = matte.tree & (matte.wood >= WOODEN) & ~matte.hidden
    crown = matte.tree
    if not shows_leaves:
        wood, crown = _thick(wood), closed(matte.tree, LEAFED_SHARE)
    foliage = crown & ~wood & ~matte.hidden
    depths = _wood_depths(skeleton, shot.camera, wood)
    leaves_from = np.where(foliage, -np.inf, np.where(matte.hidden, 0.0, depths)).astype(np.float32)
    leaf = foliage & (matte.wood < SURELY_LEAF) & (matte.opacity >= FULL)
    opacity = np.where(foliage, matte.opacity if shows_leaves else 1.0, 0.0).astype(np.float32)
    pixels = _stem_pixels(skeleton, stem, shot.camera, wood)
    return View(shot.camera, shot.picture, leaves_from, opacity, leaf & shows_leaves, foliage | wood, pixels)


def _thick(wood: Mask) -> Mask:
    """Return the wood (h, w) that is no twig: limbs that leaves leave free."""
    side = max(3, round(TWIG * wood.shape[0]))
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))
    return np.asarray(cv2.morphologyEx(wood.astype(np.uint8), cv2.MORPH_OPEN, kernel) > 0)


def _wood_depths(skeleton: Skeleton, camera: PerspectiveCamera, wood: Mask) -> NDArray[np.float32]:
    """Depth (h, w), metres, of the wood (h, w) that a shot shows; infinite elsewhere.

    It is that of the skeleton's edge nearest in the picture, and of those that cover each other of the one in front.
    """
    depths = np.full(wood.shape, np.inf, np.float32)
    joints = np.flatnonzero(skeleton.parents >= 0)
    if not wood.any() or len(joints) == 0:
        return depths
    ends_px, depth = camera.pixels_from_world(skeleton.points), camera.depth(skeleton.points)
    shown = depth > 0
    joints = joints[shown[joints] & shown[skeleton.parents[joints]]]
    joints = joints[np.argsort(-depth[joints], kind="stable")]
    widths = np.maximum(1, 2 * skeleton.radii / np.maximum(camera.pixel_size(skeleton.points), 1e-9)).astype(int)
    sixteenths = np.clip(np.round((ends_px - 0.5) * 16), -(2**24), 2**24).astype(int)
    edges = sixteenths[skeleton.parents[joints]], sixteenths[joints], depth[joints], widths[joints]
    for start, end, near, width in zip(*(column.tolist() for column in edges), strict=True):
        cv2.line(depths, start, end, near, width, cv2.LINE_8, 4)
    drawn = np.isfinite(depths)
    if not drawn.any():
        return depths
    return np.where(wood, depths.ravel()[_nearest(drawn)], np.inf).astype(np.float32)


def _nearest(marked: Mask) -> Indices:
    """Flat index (h, w) of the marked pixel nearest to each pixel."""
    _, labels = cv2.distanceTransformWithLabels(
        (~marked).astype(np.uint8), cv2.DIST_L2, 3, labelType=cv2.DIST_LABEL_PIXEL
    )
    place = np.zeros(int(labels.max()) + 1, dtype=np.int64)
    place[labels[marked]] = np.flatnonzero(marked)
    return np.asarray(place[labels])


def _stem(skeleton: Skeleton) -> Indices:
    """Joints (m,) of the first stem, from its root along the thickest children."""
    child, joints = heaviest_children(skeleton, skeleton.radii), [0]
    while child[joints[-1]] >= 0:
        joints.append(int(child[joints[-1]]))
    return np.array(joints)


def _stem_pixels(skeleton: Skeleton, stem: Indices, camera: PerspectiveCamera, wood: Mask) -> StemPixels:
    """Return where a shot shows the stem (m,) as wood (h, w)."""
    points = skeleton.points[stem]
    points_px: Floats = camera.pixels_from_world(points)
    radii_px = skeleton.radii[stem] / np.maximum(camera.pixel_size(points), 1e-9)
    return StemPixels(points_px, np.where(sample_nearest(wood, points_px, False), radii_px, 0.0))
