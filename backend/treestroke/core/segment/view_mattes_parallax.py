"""Where shots show something far behind the tree: it matches the neighbouring shots at a depth beyond the tree's."""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.plane_maps import parallax_px, plane_map
from treestroke.core.geometry.vectors import UP
from treestroke.core.imaging.correlation import correlation, windows_of
from treestroke.core.side_by_side import side_by_side
from treestroke.core.types import Floats, Mask, Picture

Map = NDArray[np.float32]

NEIGHBOURS = 2
"""Shots, the nearest ones, with which each is compared."""
WINDOW = 7
"""Side, px of the reduced shots, of the windows that are compared."""
STEP_PX = 1.5
"""Greatest step, px, between depths that are tried."""
MATCHES = 0.88
"""Correlation from which on a window matches."""
CROWDED_PX, SOME, MANY = 9, 0.1, 0.35
"""Side of the square, px, in which matching windows are counted, the share of them that says nothing, and the share
that says all: of leaves, too, a few match something far away by chance (5 % of their pixels 0.1 and more)."""
FAR = 5.0
"""Greatest log odds against the tree."""
FLAT = 6.0
"""Standard deviation of a window, steps of 255, below which it is too plain to match."""


def far_odds(
    pictures: Sequence[Picture], cameras: Sequence[PerspectiveCamera], regions: Sequence[Mask], reach: float
) -> list[Map]:
    """Return log odds of tree (h, w), 0 or less, for each shot, by what matches its neighbours behind the tree.

    Parameters are those of `far_matches`.
    """
    result = []
    for match in far_matches(pictures, cameras, regions, reach):
        share = cv2.blur((match > MATCHES).astype(np.float32), (CROWDED_PX, CROWDED_PX))
        result.append((-FAR * np.clip((share - SOME) / (MANY - SOME), 0, 1)).astype(np.float32))
    return result


def horizon(camera: PerspectiveCamera) -> float:
    """Return the row, px, of the horizon in the middle of a camera's picture, as if it stood upright."""
    ahead = camera.ahead * (1, 0, 1)
    return float(camera.pixels_from_world((camera.centre + 1e6 * ahead)[None])[0, 1])


def far_matches(
    pictures: Sequence[Picture], cameras: Sequence[PerspectiveCamera], regions: Sequence[Mask], reach: float
) -> list[Map]:
    """Return for each shot (h, w) how well it matches its neighbours, 0 to 1, beyond the tree or on the ground.

    ``pictures`` are the shots reduced, (h, w, 3), ``cameras`` those of the reduced shots, ``regions`` (h, w) where it
    is asked, ``reach`` how far from the root the tree's crown reaches, metres. The measure is the correlation of
    windows, brightness and contrast apart, the best of all depths and neighbours.
    """
    greys = [cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY).astype(np.float32) for picture in pictures]
    centres = np.array([camera.centre for camera in cameras])

    def match(index: int) -> Map:
        grey, box = greys[index], _box(regions[index])
        best = np.zeros(grey.shape, dtype=np.float32)
        away = np.linalg.norm(centres - centres[index], axis=1)
        for other in np.argsort(away, kind="stable")[1 : NEIGHBOURS + 1] if regions[index].any() else ():
            pair = cameras[index], cameras[other]
            best[box] = np.maximum(best[box], _best_match(grey, greys[other], pair, box, reach))
        return np.asarray(best * regions[index], dtype=np.float32)

    return side_by_side(match, range(len(pictures)))


def _best_match(
    grey: Map, other: Map, cameras: tuple[PerspectiveCamera, PerspectiveCamera], box: tuple[slice, slice], reach: float
) -> Map:
    """Best correlation (h, w) of a box of one shot with another over all planes beyond the tree and the ground."""
    part = cameras[0].cropped((box[1].start, box[0].start), (box[1].stop - box[1].start, box[0].stop - box[0].start))
    mine, flags = windows_of(np.ascontiguousarray(grey[box]), WINDOW, FLAT), cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    best = np.zeros(mine.picture.shape, dtype=np.float32)
    for plane in _planes(part, cameras[1], reach):
        there = cv2.warpPerspective(other, plane, best.shape[::-1], flags=flags, borderValue=-1.0)
        np.maximum(best, correlation(mine, windows_of(np.asarray(there, np.float32), WINDOW, FLAT)), out=best)
    return best


def _planes(one: PerspectiveCamera, other: PerspectiveCamera, reach: float) -> Iterator[Floats]:
    """Yield the maps (3, 3) from pixels of one shot to those of another by planes beyond the tree, and the ground."""
    nearest = float(one.depth(np.zeros((1, 3)))[0]) + reach
    steps = int(np.ceil(parallax_px(one, other, nearest) / STEP_PX))
    for share in np.linspace(0.0, 1.0, steps + 1):
        yield plane_map(one, other, one.ahead, nearest / share if share else np.inf)
    for height in (-0.02, 0.0, 0.02):
        yield plane_map(one, other, UP, height * reach - float(one.centre[1]))


def _box(region: Mask) -> tuple[slice, slice]:
    """Rows and columns of a mask (h, w) with a window's margin."""
    rows, columns = np.flatnonzero(region.any(axis=1)), np.flatnonzero(region.any(axis=0))
    if not len(rows):
        return slice(0, 0), slice(0, 0)
    top, left = max(0, rows[0] - WINDOW), max(0, columns[0] - WINDOW)
    return slice(int(top), int(rows[-1] + 1 + WINDOW)), slice(int(left), int(columns[-1] + 1 + WINDOW))
