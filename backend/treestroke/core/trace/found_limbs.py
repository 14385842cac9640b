"""Limbs that a photo shows and no stroke follows: found along ribbons of wood and joined to the strokes' lines."""

from collections import defaultdict
from collections.abc import Iterator

import cv2
import numpy as np

from treestroke.core.geometry.polyline import arc_lengths, resample
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.trace.appearance import Odds
from treestroke.core.trace.crown_picture import CrownPicture
from treestroke.core.trace.limb_paths import Paths, join_strokes, shortest_paths
from treestroke.core.trace.ribbons import Ribbons, find_ribbons
from treestroke.core.trace.skeleton_builder import SkeletonBuilder
from treestroke.core.trace.snapping import blur
from treestroke.core.trace.thickness import non_increasing
from treestroke.core.types import Floats, Mask

SEEN_SHARE = 0.4
"""Least length of wood that must be seen beyond a gap, relative to the gap: no limb goes on to a mere speck."""
BUMP, BUMP_PX = 1.2, 2.0
"""A side branch no longer than this many half widths of the wood that it leaves, plus px, is a bump of the bark."""
APART_PX = 3.0
"""Distance from a ribbon within which a line is the same limb, px."""
STEP_PX, STEADY_PX = 4.0, 3.0
"""Distance between joints along a limb, and standard deviation over which its pixels' steps are smoothed, px."""


def find_limbs(builder: SkeletonBuilder, picture: CrownPicture, odds: Odds, smooth: Odds, thinnest_px: float) -> Mask:
    """Add the limbs that are seen in a crown to a skeleton, px, that holds the strokes' lines.

    Wood is told by log odds (h, w) over the photo, as they are and averaged over the grain of bark (``smooth``). Limbs
    are ``thinnest_px`` thick at least (a radius), fall outward and are nowhere thicker than their parent. Return where
    (h, w) they are seen.
    """
    window, height_px = picture.window, picture.height_px
    ribbons = _ribbons(picture, window.reduced(odds), window.reduced(smooth))
    if not len(ribbons.pixels):
        return np.zeros(odds.shape, dtype=bool)
    drawn = builder.skeleton()
    strokes = Skeleton(window.inside(drawn.points), drawn.radii * window.scale, drawn.parents)
    network = join_strokes(ribbons, strokes, picture.crown.shape)
    paths = shortest_paths(network, picture.foliage, height_px)
    points = window.outside(network.ribbons.points)
    half_widths = network.ribbons.half_widths / window.scale
    joint_at = np.full(len(points), -1)
    kept, beyond = kept_pixels(paths, network.ribbons.half_widths)
    for chain in chains(paths, kept, beyond):
        first = int(joint_at[chain[0]])
        joint = first if first >= 0 else int(np.linalg.norm(drawn.points - points[chain[0]], axis=1).argmin())
        line = np.vstack([builder.points[joint], points[chain[1:]]])
        even = resample(blur(resample(line, 1.0), STEADY_PX), STEP_PX)
        along = arc_lengths(line)
        widths = np.interp(np.linspace(0.0, along[-1], len(even)), along[1:], half_widths[chain[1:]])
        radii = np.clip(non_increasing(widths), thinnest_px, max(builder.radii[joint], thinnest_px))
        before = len(builder.points)
        builder.add_chain(joint, even, radii, stroke=-1)
        joint_at[chain[1:]] = before + np.linalg.norm(points[chain[1:], None] - even[1:], axis=2).argmin(axis=1)
    return drawn_ribbons(points[kept], half_widths[kept], odds.shape)


def drawn_ribbons(points: Floats, half_widths: Floats, shape: tuple[int, ...]) -> Mask:
    """Draw ribbons, by points (n, 2) of their centre lines and their half widths (n,), px, into a picture (h, w)."""
    wood = np.zeros(shape, dtype=np.uint8)
    for (x, y), half_width in zip(points.tolist(), half_widths.tolist(), strict=True):
        cv2.circle(wood, (int(x), int(y)), max(1, int(half_width)), 1, cv2.FILLED)
    return wood > 0


def _ribbons(picture: CrownPicture, odds: Odds, smooth: Odds) -> Ribbons:
    """Find the ribbons of wood in a crown by log odds (h, w); where colours do not show them, as lines."""
    ribbons, are_shown = find_ribbons(odds, smooth, picture.crown, picture.height_px)
    pieces = None if are_shown else picture.pieces(smooth)
    if pieces is None:
        return ribbons
    drawn = np.ones(picture.crown.shape, dtype=np.uint8)
    drawn[tuple(ribbons.pixels.T)] = 0
    apart = cv2.distanceTransform(drawn, cv2.DIST_L2, 5)[tuple(pieces.pixels.T)] > APART_PX
    return Ribbons(
        np.concatenate([ribbons.pixels, pieces.pixels[apart]]),
        np.concatenate([ribbons.half_widths, pieces.half_widths[apart]]),
    )


def kept_pixels(paths: Paths, half_widths: Floats) -> tuple[Mask, Floats]:
    """Return which pixels (n,) lie on limbs, and the length (n,) of the longest way outward from each, px.

    Limbs end where too little wood is seen beyond a gap; bumps of the bark are none.
    """
    before, gap = paths.before.tolist(), paths.gap.tolist()
    seen, beyond, longest = [0.0] * len(before), [0.0] * len(before), [-1] * len(before)
    kept = np.zeros(len(before), dtype=bool)
    for pixel in paths.order[::-1].tolist():
        parent = before[pixel]
        if parent < 0 or seen[pixel] + 1 < SEEN_SHARE * gap[pixel]:
            continue
        kept[pixel] = True
        seen[parent] += seen[pixel] + 1
        if beyond[pixel] + 1 + gap[pixel] > beyond[parent]:
            beyond[parent], longest[parent] = beyond[pixel] + 1 + gap[pixel], pixel
    for pixel in paths.order.tolist():
        parent = before[pixel]
        if parent >= 0 and kept[pixel]:
            is_stroked = before[parent] < 0
            is_bump = beyond[pixel] + 1 < BUMP * half_widths[parent] + BUMP_PX
            kept[pixel] = (is_stroked or kept[parent]) and not (is_bump and (is_stroked or longest[parent] != pixel))
    return kept, np.array(beyond)


def chains(paths: Paths, kept: Mask, beyond: Floats) -> Iterator[list[int]]:
    """List the pixels of each limb from where it leaves a stroke or an earlier one; forks go on by the longer arm."""
    arms: dict[int, list[int]] = defaultdict(list)
    for pixel in paths.order[kept[paths.order]].tolist():
        arms[int(paths.before[pixel])].append(pixel)
    starts = [(parent, arm) for parent, offspring in arms.items() if not kept[parent] for arm in offspring]
    while starts:
        chain = [*starts.pop()]
        while offspring := arms.get(chain[-1]):
            if len(offspring) > 1:
                offspring = sorted(offspring, key=lambda arm: (-beyond[arm], arm))
                starts += [(chain[-1], arm) for arm in offspring[1:]]
            chain.append(offspring[0])
        yield chain
