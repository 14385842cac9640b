"""The front of a sibling: a picture that is to its outline as the example's picture is to the example's."""

from dataclasses import dataclass
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.imaging.analogy import analogy
from treestroke.core.types import Floats, Mask, Opacity, Picture

CELLS = 80
"""Cells along the longer side of the example's crown in which pictures are put together."""
BORDER = 10
"""Empty cells around a crown."""
SPREAD = (0.01, 0.04, 0.2)
"""Sides of the windows, as shares of the picture's longer side, from which a place takes colours; small ones first."""
CLOSED = 0.06
"""Gaps of a crown narrower than this share of its size lie within its outline."""
WIDER, ASIDE, SMOOTH = 0.1, 0.08, 0.16
"""Standard deviations of the logarithm of half a crown's width, from row to row, and of its middle over that half; and
the share of its height over which rows vary together."""

_Value = TypeVar("_Value", np.uint8, np.float32)


@dataclass(frozen=True, eq=False)
class FrontPicture:
    """A tree's front, each part (h, w).

    Attributes
    ----------
    camera
        The front's camera.
    picture
        (h, w, 3) sRGB.
    foliage
        Where the crown's leaves (on a bare tree, its wood) are.
    opacity
        The share of each pixel that they cover.
    leaf_coloured
        Pixels that by their own colour are leaves.
    """

    camera: OrthographicCamera
    picture: Picture
    foliage: Mask
    opacity: Opacity
    leaf_coloured: Mask


def varied_outline(front: FrontPicture, rng: np.random.Generator) -> Floats:
    """Return an outline (n, 2), metres from the root, x right and y up, that a sibling's crown may have.

    It is the front's, perhaps mirrored, its rows wider or narrower and further to one side by smooth random numbers.
    """
    whole = closed_crown(front.foliage)
    rows = np.flatnonzero(whole.any(axis=1))
    left = np.interp(np.arange(rows[0], rows[-1] + 1), rows, whole.argmax(axis=1)[rows])
    right = np.interp(np.arange(rows[0], rows[-1] + 1), rows, whole.shape[1] - whole[:, ::-1].argmax(axis=1)[rows])
    y = np.arange(rows[0], rows[-1] + 1) + 0.5
    low, high = (front.camera.world_from_pixels(np.stack([x, y], axis=1)) for x in (left, right))
    middle, half = (high[:, 0] + low[:, 0]) / 2, (high[:, 0] - low[:, 0]) / 2
    noise = [_smooth_noise(len(half), rng) for _ in range(3)]
    middle = float(rng.choice((-1.0, 1.0))) * middle + ASIDE * half * noise[2]
    sides = (middle - half * np.exp(WIDER * noise[0]), middle + half * np.exp(WIDER * noise[1]))
    lines = [np.stack([side, low[:, 1]], axis=1) for side in sides]
    return np.concatenate([lines[0][::-1], lines[1]])


def _smooth_noise(count: int, rng: np.random.Generator) -> Floats:
    """Return random numbers (count,) of standard deviation 1, of which neighbours are alike."""
    knots = max(4, round(1 / SMOOTH))
    values = rng.standard_normal(knots)
    return np.asarray(cv2.resize(values[None], (count, 1), interpolation=cv2.INTER_CUBIC)[0])


def closed_crown(foliage: Mask) -> Mask:
    """Close the gaps of a crown (h, w)."""
    size = max(3, int(2 * CLOSED * np.sqrt(foliage.sum())) | 1)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    padded = np.pad(foliage.astype(np.uint8), size)
    return np.asarray(cv2.morphologyEx(padded, cv2.MORPH_CLOSE, kernel)[size:-size, size:-size] > 0)


def spread_over(picture: Picture, cover: Mask) -> Picture:
    """Give the rest of a picture (h, w, 3) the colours of what is covered (h, w) beside it.

    Where patches of it meet, no background shows.
    """
    if not cover.any():
        return picture
    spread, weight = np.zeros(picture.shape, dtype=np.float32), np.zeros(cover.shape, dtype=np.float32)
    covered = picture.astype(np.float32) * cover[..., None]
    for share in SPREAD:
        side = 2 * max(1, round(share * max(cover.shape))) + 1
        left = np.maximum(1e-3 - weight, 0) / 1e-3
        spread += left[..., None] * cv2.blur(covered, (side, side))
        weight += left * cv2.blur(cover.astype(np.float32), (side, side))
    mean = covered.sum(axis=(0, 1)) / cover.sum()
    spread = (spread + 1e-6 * mean) / (weight + 1e-6)[..., None]
    return np.where(cover[..., None], picture, np.rint(spread).astype(np.uint8))


def new_front(old: FrontPicture, outline: Mask, camera: OrthographicCamera, rng: np.random.Generator) -> FrontPicture:
    """Make the front (h, w) of a crown with an outline (h, w) of patches of another one's front.

    Both pictures have the same scale. Leaves, their colours, light and gaps come from about the same height of the old
    crown, and from as far within its outline.

    Source: image analogies, Hertzmann et al. 2001.
    """
    was, now = _box(old.foliage), _box(outline)
    cell = max(was[2] - was[0], was[3] - was[1]) / CELLS
    shown = _cells(old.foliage, was, cell)
    depths = _depths(_cells(closed_crown(old.foliage), was, cell))
    patches = analogy(shown, depths, _depths(_cells(outline, now, cell)), rng)
    rows, columns = np.mgrid[: camera.height, : camera.width].astype(np.float32) + np.float32(0.5)
    row, down = np.divmod((rows - now[0]) / cell + BORDER, 1)
    column, aside = np.divmod((columns - now[1]) / cell + BORDER, 1)
    size = patches.row.shape
    within = (row >= 0) & (column >= 0) & (row < size[0]) & (column < size[1])
    here = np.where(within, row, 0).astype(np.int64), np.where(within, column, 0).astype(np.int64)
    within &= patches.row[here] >= 0
    aside = np.where(patches.mirrored[here], 1 - aside, aside)
    y = (was[0] + cell * (patches.row[here] - BORDER + down) - 0.5).astype(np.float32)
    x = (was[1] + cell * (patches.column[here] - BORDER + aside) - 0.5).astype(np.float32)
    blank = np.rint(old.picture[old.foliage].mean(axis=0)).astype(np.uint8)
    copied = _Copied(x, y, within, blank)
    return FrontPicture(
        camera,
        copied.of(old.picture, cv2.INTER_LINEAR),
        copied.of(old.foliage.astype(np.uint8), cv2.INTER_NEAREST) > 0,
        copied.of(old.opacity, cv2.INTER_LINEAR),
        copied.of(old.leaf_coloured.astype(np.uint8), cv2.INTER_NEAREST) > 0,
    )


@dataclass(frozen=True, eq=False)
class _Copied:
    """Where each pixel (h, w) comes from, px, if from anywhere, and the colour (3,) of the others."""

    x: NDArray[np.float32]
    y: NDArray[np.float32]
    within: Mask
    blank: Picture

    def of(self, picture: NDArray[_Value], how: int) -> NDArray[_Value]:
        """Copy a picture (h, w) or (h, w, 3), interpolated by OpenCV's method ``how``."""
        copied = cv2.remap(picture, self.x, self.y, how, borderMode=cv2.BORDER_REPLICATE)
        copied[~self.within] = self.blank if picture.ndim == 3 else 0
        return np.asarray(copied, dtype=picture.dtype)


def _box(mask: Mask) -> tuple[int, int, int, int]:
    """Return the first row and column that a mask has, and those after its last."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return int(rows[0]), int(columns[0]), int(rows[-1]) + 1, int(columns[-1]) + 1


def _cells(mask: Mask, box: tuple[int, int, int, int], cell: float) -> Mask:
    """Reduce the box of a mask to cells of a side, px, with a border."""
    part = mask[box[0] : box[2], box[1] : box[3]].astype(np.uint8) * np.uint8(255)
    size = [max(1, round(side / cell)) for side in part.shape[::-1]]
    return np.pad(cv2.resize(part, size, interpolation=cv2.INTER_AREA) > 127, BORDER)


def _depths(mask: Mask) -> Floats:
    """Measure how far cells (h, w) lie within a mask: negative outside."""
    within, outside = (
        cv2.distanceTransform(np.pad(of.astype(np.uint8), 1, mode="edge"), cv2.DIST_L2, 5)[1:-1, 1:-1]
        for of in (mask, ~mask)
    )
    return np.asarray(within - outside, dtype=np.float64)
