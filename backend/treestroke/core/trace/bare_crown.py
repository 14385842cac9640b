"""The limbs and twigs of a bare crown: nearly all its wood is seen against the background, so all is traced."""

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import arc_lengths, resample
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.trace.appearance import MAX_ODDS, WoodOdds
from treestroke.core.trace.centre_lines import thin
from treestroke.core.trace.crown_picture import Window
from treestroke.core.trace.fine_twigs import fine_twigs
from treestroke.core.trace.found_limbs import chains, kept_pixels
from treestroke.core.trace.limb_paths import LONGEST_GAP, ON_WOOD, join_strokes, shortest_paths
from treestroke.core.trace.ribbons import Ribbons
from treestroke.core.trace.skeleton_builder import SkeletonBuilder
from treestroke.core.trace.snapping import blur
from treestroke.core.trace.thickness import non_increasing
from treestroke.core.types import Floats, Mask, Opacity

SIDE_PX, MOST_ENLARGED = 1000, 3.0
"""Long side, px, to which a crown is brought before its twigs are thinned to lines, and greatest enlargement: twigs of
one pixel stay apart."""
SEEN = 0.3
"""Share of a pixel from which on wood there is traced."""
TOUCHED = 0.1
"""Share of a pixel from which on a twig may go on there unseen."""
SPECK = 0.006
"""Length of the smallest piece of wood that is traced, as a share of the tree's height."""
THIN_PX, AROUND_PX = 3.0, 4
"""Half width below which the width of wood follows from its area around the line, and half the side of the square in
which that is measured, px."""
ASIDE_PX = 9
"""Side of the square in which the middle of a limb lies around its stroke's line, px."""
STEP_PX, STEADY = 3.0, 1.0
"""Distance between joints along a twig, px, and standard deviation over which its pixels' steps are smoothed, relative
to its half width, but no less than a pixel: nothing bends more sharply than it is thick."""
MIDDLING_PX, MOST_RATIO = 4.0, 4.0
"""Half width of wood along which a step costs `ON_WOOD`, px. Twice as thick it costs half, down to a share of one in
this many, and thin wood in the same way more: where limbs cross, each goes on along its own wood.
"""
SLENDER = 0.3
"""Greatest half width of wood, relative to the length that goes on from there: what many twigs cover together is no
limb."""
FINEST = 2.5e-4
"""Radius of the finest twig, as a share of the tree's height: a fourth of a pixel in a tree 1,000 px high."""
TOLERANCE_PX = 0.25
"""Greatest distance by which simplification moves the line of a twig, px."""
MOST_JOINTS = 6000
"""Greatest number of joints before simplification: where there are more, the shortest twigs are left out."""
_BESIDE = np.array([[0, 1, 0], [1, 0, 1], [0, 1, 0]], dtype=np.float32)
_ASLANT = np.array([[1, 0, 1], [0, 0, 0], [1, 0, 1]], dtype=np.float32)


def find_twigs(builder: SkeletonBuilder, wood: Opacity, crown: Mask, height_px: float) -> None:
    """Add all wood that is seen in a bare crown to a skeleton, px, that holds the strokes' lines.

    ``wood`` (h, w) is the share of each pixel that wood covers. Twigs fall outward and are nowhere thicker than their
    parent.
    """
    share, window = _window(wood, crown, round(LONGEST_GAP * height_px))
    small_px = height_px * window.scale
    _slim(builder, wood, crown)
    ribbons = _ribbons(share, SPECK * small_px)
    if not len(ribbons.pixels):
        return
    drawn = builder.skeleton()
    strokes = Skeleton(window.inside(drawn.points), drawn.radii * window.scale, drawn.parents)
    network = join_strokes(ribbons, strokes, share.shape)
    thickness = np.clip(network.ribbons.half_widths / MIDDLING_PX, 1 / MOST_RATIO, MOST_RATIO)
    paths = shortest_paths(network, share > TOUCHED, small_px, ON_WOOD / thickness)
    points = network.ribbons.points
    kept, beyond = kept_pixels(paths, network.ribbons.half_widths)
    half_widths = np.minimum(network.ribbons.half_widths, SLENDER * beyond + 1.0)
    joint_at = np.full(len(points), -1)
    for chain in _longest(list(chains(paths, kept, beyond))):
        first = int(joint_at[chain[0]])
        joint = first if first >= 0 else int(np.linalg.norm(strokes.points - points[chain[0]], axis=1).argmin())
        line, wide = np.vstack([window.inside(builder.points[joint]), points[chain[1:]]]), half_widths[chain[1:]]
        even = resample(blur(resample(line, 1.0), STEADY * max(1.0, float(np.median(wide)))), STEP_PX)
        along = arc_lengths(line)
        widths = np.interp(np.linspace(0.0, along[-1], len(even)), along[1:], wide)
        radii = np.clip(non_increasing(widths) / window.scale, FINEST * height_px, builder.radii[joint])
        before = len(builder.points)
        builder.add_chain(joint, window.outside(even), radii, stroke=-1)
        joint_at[chain[1:]] = before + np.linalg.norm(points[chain[1:], None] - even[1:], axis=2).argmin(axis=1)
    _add_fine(builder, share, window, FINEST * height_px)


def _add_fine(builder: SkeletonBuilder, share: Opacity, window: Window, finest_px: float) -> None:
    """Add the twigs that stand too densely to be told apart, by the share (h, w) of wood in the window."""
    points, radii = builder.arrays()
    tree = fine_twigs(share, Skeleton(window.inside(points), radii * window.scale, np.array(builder.parents)))
    outside, thick = window.outside(tree.points), np.maximum(tree.radii / window.scale, finest_px)
    for middle in range(len(points), len(tree), 2):
        bearer, twig = int(tree.parents[middle]), slice(middle, middle + 2)
        radii_px = np.minimum(np.append(0.0, thick[twig]), builder.radii[bearer])
        builder.add_chain(bearer, np.vstack([builder.points[bearer], outside[twig]]), radii_px, stroke=-1)


def _longest(twigs: list[list[int]]) -> list[list[int]]:
    """Return the longest twigs, lists of pixels, of `MOST_JOINTS` joints together; none is longer than its parent."""
    lengths = np.array([len(twig) for twig in twigs])
    falling = np.sort(lengths)[::-1]
    room = int((np.cumsum(falling / STEP_PX) <= MOST_JOINTS).sum())
    return twigs if room == len(twigs) else [twig for twig in twigs if len(twig) > falling[room]]


def odds_of_share(odds: WoodOdds, wood: Opacity, crown: Mask) -> WoodOdds:
    """Replace log odds of wood in a bare crown (h, w) by those of the share (h, w) of each pixel that it covers."""
    in_crown = (2 * MAX_ODDS * (wood[crown] - 0.5)).astype(np.float32)
    by_strokes, by_crown = odds.by_strokes.copy(), odds.by_crown.copy()
    by_strokes[crown] = by_crown[crown] = in_crown
    return WoodOdds(by_strokes, by_crown)


def _window(wood: Opacity, crown: Mask, below_px: int) -> tuple[Opacity, Window]:
    """Return the wood in a crown (h, w) and below it at the size at which it is traced, and where it lies."""
    x, y, width, height = cv2.boundingRect(crown.astype(np.uint8))
    height = min(height + below_px, crown.shape[0] - y)
    scale = min(MOST_ENLARGED, SIDE_PX / max(width, height))
    window = Window((x, y), (width, height), scale)
    how = cv2.INTER_AREA if scale < 1 else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(window.cut(wood), window.size, interpolation=how)), window


def _slim(builder: SkeletonBuilder, share: Opacity, crown: Mask) -> None:
    """Make the strokes' lines no thicker than the wood around them: twigs beside a limb widen what is measured.

    ``share`` (h, w) is that of each pixel that wood covers in the crown (h, w); outside it nothing is known.
    """
    inward = cv2.distanceTransform(((share > SEEN) | ~crown).astype(np.uint8), cv2.DIST_L2, 5)
    wide = sample_nearest(cv2.dilate(inward, np.ones((ASIDE_PX, ASIDE_PX))), np.array(builder.points), np.inf)
    radii, stroke = np.array(builder.radii), np.array(builder.stroke)
    radii = np.where(wide > 0, np.minimum(radii, wide), radii)
    for index in np.unique(stroke):
        radii[stroke == index] = non_increasing(radii[stroke == index])
    builder.set_radii(radii)


def _ribbons(share: Opacity, speck_px: float) -> Ribbons:
    """Return the centre lines of wood that covers a share (h, w) of each pixel, without specks."""
    wood = share > SEEN
    count, labels = cv2.connectedComponents(wood.astype(np.uint8), connectivity=8)
    lines = thin(wood)
    long = np.bincount(labels[lines], minlength=count) > speck_px
    lines &= long[labels]
    inward = cv2.distanceTransform(wood.astype(np.uint8), cv2.DIST_L2, 5)
    return Ribbons(np.argwhere(lines), _half_widths(lines, share, inward))


def _half_widths(lines: Mask, share: Opacity, inward: NDArray[np.generic]) -> Floats:
    """Return the half widths (n,), px, of wood at the pixels of its centre lines (h, w), in reading order.

    Thick wood's is the distance to its border (h, w), thin wood's half its area over its length around each pixel.
    """
    ones = lines.astype(np.float32)
    beside, aslant = (cv2.filter2D(ones, -1, kernel) for kernel in (_BESIDE, _ASLANT))
    length = ones * (0.5 * beside + np.sqrt(0.5) * np.clip(2 - beside, 0, aslant))
    side = (2 * AROUND_PX + 1, 2 * AROUND_PX + 1)
    area, along = (cv2.boxFilter(part, cv2.CV_32F, side, normalize=False)[lines] for part in (share, length))
    thick = np.maximum(inward[lines].astype(np.float64) - 0.5, 0.5)
    thin_px = np.minimum(area / np.maximum(along, 1.0) / 2, THIN_PX)
    return np.asarray(np.where(thick < THIN_PX, thin_px, thick), dtype=np.float64)
