"""Limbs that a photo shows and no stroke follows: found along ribbons of wood and joined to the strokes' lines."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.polyline import arc_lengths, resample
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.trace.limb_paths import LONGEST_GAP, Paths, join_strokes, shortest_paths
from treestroke.core.trace.ribbons import find_ribbons
from treestroke.core.trace.skeleton_builder import SkeletonBuilder
from treestroke.core.trace.snapping import blur
from treestroke.core.trace.thickness import non_increasing
from treestroke.core.types import Floats, Mask

SEEN_SHARE = 0.4
"""Least length of wood that must be seen beyond a gap, relative to the gap: no limb goes on to a mere speck."""
BUMP, BUMP_PX = 1.2, 2.0
"""A side branch no longer than this many half widths of the wood that it leaves, plus px, is a bump of the bark."""
FINEST_SIDE = 800
"""Long side, px, to which a larger crown is reduced: a stroke is answered at once."""
STEP_PX, STEADY_PX = 4.0, 3.0
"""Distance between joints along a limb, and standard deviation over which its pixels' steps are smoothed, px."""


@dataclass(frozen=True, eq=False)
class CrownPicture:
    """What a photo shows of limbs in a crown.

    Attributes
    ----------
    odds, smooth
        (h, w) log odds of wood, as they are and averaged over the grain of bark.
    crown
        (h, w) where limbs are looked for.
    foliage
        (h, w) where leaves may hide a limb.
    """

    odds: NDArray[np.float32]
    smooth: NDArray[np.float32]
    crown: Mask
    foliage: Mask

    def cut(self, below_px: int) -> tuple["CrownPicture", "Window"]:
        """Return the part around the crown and ``below_px`` below it, reduced to `FINEST_SIDE`, and where it lies."""
        x, y, width, height = cv2.boundingRect(self.crown.astype(np.uint8))
        height = min(height + below_px, self.crown.shape[0] - y)
        scale = min(1.0, FINEST_SIDE / max(width, height))
        size = max(1, round(width * scale)), max(1, round(height * scale))

        def reduced(part: NDArray[np.float32]) -> NDArray[np.float32]:
            cut = part[y : y + height, x : x + width]
            return np.asarray(cv2.resize(cut, size, interpolation=cv2.INTER_AREA) if scale < 1 else cut)

        crown, foliage = (reduced(part.astype(np.float32)) > 0.5 for part in (self.crown, self.foliage))
        part = CrownPicture(reduced(self.odds), reduced(self.smooth), crown, foliage)
        return part, Window(np.array([x, y], dtype=np.float64), scale)


@dataclass(frozen=True, eq=False)
class Window:
    """A part of a picture: the place (2,) of its upper left corner, px, and by how much it is reduced, 1 or less."""

    corner: Floats
    scale: float

    def inside(self, points: Floats) -> Floats:
        """Return points (n, 2) of the picture, px, in the window's px."""
        return np.asarray((points - self.corner) * self.scale)

    def outside(self, points: Floats) -> Floats:
        """Return points (n, 2) of the window, px, in the picture's px."""
        return np.asarray(points / self.scale + self.corner)


def find_limbs(builder: SkeletonBuilder, picture: CrownPicture, height_px: float, thinnest_px: float) -> None:
    """Add the limbs that are seen in a crown to a skeleton, px, that holds the strokes' lines.

    They are ``thinnest_px`` thick at least (a radius), fall outward and are nowhere thicker than their parent.
    """
    around, window = picture.cut(round(LONGEST_GAP * height_px))
    small_px = height_px * window.scale
    ribbons = find_ribbons(around.odds, around.smooth, around.crown, small_px)
    if not len(ribbons.pixels):
        return
    drawn = builder.skeleton()
    strokes = Skeleton(window.inside(drawn.points), drawn.radii * window.scale, drawn.parents)
    network = join_strokes(ribbons, strokes, around.crown.shape)
    paths = shortest_paths(network, around.foliage, small_px)
    points = window.outside(network.ribbons.points)
    half_widths = network.ribbons.half_widths / window.scale
    joint_at = np.full(len(points), -1)
    for chain in chains(paths, *kept_pixels(paths, network.ribbons.half_widths)):
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
        while offspring := sorted(arms[chain[-1]], key=lambda arm: (-beyond[arm], arm)):
            starts += [(chain[-1], arm) for arm in offspring[1:]]
            chain.append(offspring[0])
        yield chain
