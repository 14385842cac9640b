"""Pieces of limbs in a dense crown: long lines that stand out from the texture of leaves, by shade and by colour.

Where leaves, shade and wood share their colours, no pixel tells a limb; only that many lie along a line does. A line
filter (as for blood vessels: Chaudhuri et al. 1989) is turned to all directions. How much a line must stand out each
crown tells by itself: texture makes as many light lines as dark ones, limbs make dark ones alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.side_by_side import side_by_side
from treestroke.core.trace.centre_lines import thin
from treestroke.core.trace.ribbons import Ribbons
from treestroke.core.types import Floats, Indices, Mask

Bytes = NDArray[np.uint8]

SIDE = 480
"""Long side, px, to which a larger crown is reduced: limbs that a dense crown shows are wider than 1 px of it."""
CONTRAST = 64
"""Difference in brightness between a line and both its sides from which on it is clear."""
DIRECTIONS = 12
LENGTH = 0.06
"""Length of the filter, as a share of the tree's height: longer than what gaps between leaves make, and limbs bend."""
ACROSS_PX = 3
"""Length along a line over which a single place of it is compared with both sides, px."""
HALF_WIDTHS = (0.5, 1.5, 3.0)
"""Half widths of the limbs that are looked for, px of a crown so reduced."""
FAINT, CLEAR = 2.5, 4.7
"""How rarely texture makes such a line, as powers of ten in both layers together: at every place of a piece of limb,
and in its mean. Judged on 6 photos with limbs that were marked by eye and 8 in which hardly any are seen: at 4.5,
branches are drawn through leaves of one colour; at 5, most limbs are lost."""
SHORTEST = 0.08
"""Least extent of a piece, as a share of the tree's height."""
_ZERO = 2 * CONTRAST - 1
"""Byte that stands for a line as bright as its sides; 255 stands for a clear line."""


@dataclass(frozen=True, eq=False)
class Lines:
    """The dark line through each pixel of a reduced picture that stands out most.

    Attributes
    ----------
    rarity
        (h, w) how rarely texture makes such a line, as a power of ten; 0 outside the crown.
    direction, width
        (h, w) its direction, and which of the half widths it has.
    inside
        (h, w) the crown.
    """

    rarity: NDArray[np.float32]
    direction: Bytes
    width: Bytes
    inside: Mask


def reduction(shape: tuple[int, ...]) -> float:
    """Return by how much a crown (h, w) is reduced before lines are looked for, 1 or less."""
    return min(1.0, SIDE / max(shape))


def find_lines(picture: Bytes, inside: Mask, height_px: float) -> Lines:
    """Find dark lines in a picture (h, w), reduced, of a tree ``height_px`` high; ``inside`` (h, w) is its crown."""
    dark, light = np.zeros_like(picture), np.zeros_like(picture)
    direction, which = np.zeros_like(picture), np.zeros_like(picture)
    length_px = max(3, int(LENGTH * height_px))
    found = side_by_side(lambda number: _lines_at(picture, number, length_px), range(DIRECTIONS // 2))
    for number, (darker, lighter, thickness, is_upright) in enumerate(found):
        better = cv2.compare(darker, dark, cv2.CMP_GT)
        cv2.copyTo(number + np.uint8(DIRECTIONS // 2) * is_upright, better, direction)
        cv2.copyTo(thickness, better, which)
        np.maximum(dark, darker, out=dark)
        np.maximum(light, lighter, out=light)
    return Lines(_rarity(dark, light, inside), direction, which, inside)


def pieces(layers: tuple[Lines, Lines], likely: Mask, shape: tuple[int, int], height_px: float) -> Ribbons:
    """Return the pieces of limbs that two layers show together, in a picture (h, w) of the size before reduction.

    ``likely`` (reduced) is where limbs may be; the tree is ``height_px`` high before reduction.
    """
    first, second = layers
    scale = reduction(shape)
    by_first = first.rarity > second.rarity
    direction = np.where(by_first, first.direction, second.direction)
    width = np.where(by_first, first.width, second.width)
    chosen = _long_and_clear(first.rarity + second.rarity, direction, likely, height_px * scale)
    lines = thin(cv2.resize(chosen.astype(np.uint8), shape[::-1], interpolation=cv2.INTER_NEAREST) > 0)
    pixels = np.argwhere(lines)
    row, column = np.minimum((pixels * scale).astype(np.int64), np.array(width.shape) - 1).T
    return Ribbons(pixels, np.array(HALF_WIDTHS)[width[row, column]] / scale)


def _lines_at(picture: Bytes, number: int, length_px: int) -> tuple[Bytes, ...]:
    """Return what `_level_and_upright` returns of a picture (h, w) that is turned to a direction, turned back."""
    height, width = picture.shape
    turn, size = _turned((height, width), np.pi * number / DIRECTIONS)
    turned = cv2.warpAffine(picture, turn, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    found = _level_and_upright(np.asarray(turned, dtype=np.uint8), length_px)
    both = _turned_back(found[:2], turn, (width, height), cv2.INTER_LINEAR)
    of_dark = _turned_back(found[2:], turn, (width, height), cv2.INTER_NEAREST)
    return tuple(np.asarray(plane, dtype=np.uint8) for plane in (*cv2.split(both), *cv2.split(of_dark)))


def _turned(shape: tuple[int, int], angle: float) -> tuple[Floats, tuple[int, int]]:
    """Return the map (2, 3) that turns a picture (h, w) so that lines at an angle lie level, and the size it gets."""
    height, width = shape
    cosine, sine = np.cos(angle), np.sin(angle)
    size = int(width * abs(cosine) + height * abs(sine)) + 2, int(width * abs(sine) + height * abs(cosine)) + 2
    turn = np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0]])
    turn[:, 2] = (np.array(size) - 1) / 2 - turn[:, :2] @ np.array([(width - 1) / 2, (height - 1) / 2])
    return turn, size


def _turned_back(planes: Sequence[Bytes], turn: Floats, size: tuple[int, int], how: int) -> Bytes:
    """Turn two pictures back, as one of two channels, to a size (width, height)."""
    return np.asarray(cv2.warpAffine(cv2.merge(planes), turn, size, flags=how | cv2.WARP_INVERSE_MAP), dtype=np.uint8)


def _level_and_upright(picture: Bytes, length_px: int) -> tuple[Bytes, Bytes, Bytes, Bytes]:
    """Return what `_level_lines` returns, of level or upright lines, and which dark ones are upright (h, w)."""
    level = _level_lines(picture, length_px)
    upright = _level_lines(np.asarray(cv2.transpose(picture), dtype=np.uint8), length_px)
    dark, light, which = (np.asarray(cv2.transpose(plane), dtype=np.uint8) for plane in upright)
    is_upright = np.asarray(cv2.compare(dark, level[0], cv2.CMP_GT), dtype=np.uint8)
    cv2.copyTo(which, is_upright, level[2])
    return np.maximum(level[0], dark), np.maximum(level[1], light), level[2], is_upright & np.uint8(1)


def _level_lines(picture: Bytes, length_px: int) -> tuple[Bytes, Bytes, Bytes]:
    """Return how clearly dark and light level lines stand out (h, w), and which half width the dark ones have.

    A line counts where it differs from both its sides, and where it differs much no more than where it is clear.
    """
    dark, light, which = (np.zeros_like(picture) for _ in range(3))
    for number, half_width in enumerate(HALF_WIDTHS):
        breadth, margin = int(2 * half_width) | 1, (int(half_width) + 2) | 1
        line, beside = (_mean(picture, (ACROSS_PX, across)) for across in (breadth, margin))
        away = breadth // 2 + margin // 2 + 1
        padded = np.asarray(cv2.copyMakeBorder(beside, away, away, 0, 0, cv2.BORDER_REPLICATE), dtype=np.uint8)
        above, below = padded[: -2 * away], padded[2 * away :]
        darker = _mean(_difference(np.minimum(above, below), line), (length_px, 1))
        lighter = _mean(_difference(line, np.maximum(above, below)), (length_px, 1))
        cv2.copyTo(np.full_like(which, number), cv2.compare(darker, dark, cv2.CMP_GT), which)
        np.maximum(dark, darker, out=dark)
        np.maximum(light, lighter, out=light)
    return dark, light, which


def _difference(first: Bytes, second: Bytes) -> Bytes:
    """Return how much brighter one picture (h, w) is than another, within the contrast, about `_ZERO`."""
    # A byte ends where the contrast does: what differs more is cut off.
    return np.asarray(cv2.addWeighted(first, 2.0, second, -2.0, _ZERO), dtype=np.uint8)


def _mean(picture: Bytes, size: tuple[int, int]) -> Bytes:
    """Return the mean of a picture (h, w) over the rectangle of a size (width, height) around each place."""
    return np.asarray(cv2.blur(picture, size), dtype=np.uint8)


def _rarity(dark: Bytes, light: Bytes, inside: Mask) -> NDArray[np.float32]:
    """Return how rarely (h, w) texture inside a crown makes such dark lines; it makes as many light ones."""
    count = np.bincount(light[inside], minlength=256)
    stronger = count[::-1].cumsum()[::-1]
    powers = -np.log10((stronger + 1.0) / max(count.sum(), 1)).astype(np.float32)
    return np.where(inside, powers[dark], np.float32(0.0))


def _long_and_clear(rarity: NDArray[np.float32], direction: Bytes, likely: Mask, height_px: float) -> Mask:
    """Return the middles (h, w) of the long, clear lines of which most is likely a limb.

    Along a piece the direction changes but slowly.
    """
    middle = np.nonzero((rarity > FAINT) & _highest_across(rarity, direction))
    towards, chosen = direction[middle], np.zeros(rarity.shape, dtype=bool)
    for number in range(DIRECTIONS):
        at = tuple(axis[(towards + DIRECTIONS + 1 - number) % DIRECTIONS <= 2] for axis in middle)
        piece = np.zeros(rarity.shape, dtype=np.uint8)
        piece[at] = 1
        grown = cv2.dilate(piece, np.ones((3, 3), np.uint8))
        # Their statistics, asked of OpenCV, would take ten times as long: few pixels belong to lines.
        count, labels = cv2.connectedComponents(grown, connectivity=8)
        label = labels[at].astype(np.int64)
        extent = _extents(at, label, count)
        total, pixels = np.bincount(label, rarity[at], count), np.bincount(label, minlength=count)
        clear = (total > CLEAR * pixels) & (2 * np.bincount(label, likely[at], count) > pixels)
        chosen[at] |= (clear & (extent > SHORTEST * height_px))[label]
    return chosen


def _extents(at: tuple[Indices, ...], label: Indices, count: int) -> Floats:
    """Return how far, px, each piece extends, by the label (n,) of its pixels (row and column): its box's diagonal.

    The box is that of the piece grown by a pixel, less that pixel at both ends.
    """
    box = np.zeros((2, count))
    for side, places in zip(box, at, strict=True):
        first, last = np.full(count, np.iinfo(np.int64).max), np.full(count, -1)
        np.minimum.at(first, label, places)
        np.maximum.at(last, label, places)
        side[:] = np.maximum(last - first + 3, 0)
    return np.asarray(np.hypot(*box) - 2)


def _highest_across(rarity: NDArray[np.float32], direction: Bytes) -> Mask:
    """Return the pixels (h, w) at which values are highest across the direction of the line there."""
    height, width = rarity.shape
    padded = cv2.copyMakeBorder(rarity, 2, 2, 2, 2, cv2.BORDER_CONSTANT, value=-1.0)
    highest = np.zeros(rarity.shape, dtype=bool)
    for number in range(DIRECTIONS):
        angle = np.pi * number / DIRECTIONS
        here = direction == number
        for px in (-2, -1, 1, 2):
            right, down = round(-np.sin(angle) * px), round(np.cos(angle) * px)
            here &= rarity >= padded[2 + down : 2 + down + height, 2 + right : 2 + right + width]
        highest |= here
    return highest
