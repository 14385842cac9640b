"""Where shots show something far behind the tree: it matches the neighbouring shots at a depth beyond the tree's."""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import PerspectiveCamera
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
    ahead = camera.camera_from_world[2, :3] * (1, 0, 1)
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
    result = []
    for index, (grey, camera, region) in enumerate(zip(greys, cameras, regions, strict=True)):
        best = np.zeros(grey.shape, dtype=np.float32)
        box = _box(region)
        away = np.linalg.norm(centres - centres[index], axis=1)
        for other in np.argsort(away, kind="stable")[1 : NEIGHBOURS + 1] if region.any() else ():
            best[box] = np.maximum(best[box], _best_match(grey, greys[other], (camera, cameras[other]), box, reach))
        result.append(best * region)
    return result


def _best_match(
    grey: Map, other: Map, cameras: tuple[PerspectiveCamera, PerspectiveCamera], box: tuple[slice, slice], reach: float
) -> Map:
    """Best correlation (h, w) of a box of one shot with another over all planes beyond the tree and the ground."""
    patch: Map = np.ascontiguousarray(grey[box])
    size = patch.shape[1], patch.shape[0]
    mean, spread = _moments(patch)
    best = np.zeros(patch.shape, dtype=np.float32)
    shift = np.array([[1.0, 0, box[1].start], [0, 1, box[0].start], [0, 0, 1]])
    for homography in _homographies(*cameras, reach):
        warped = cv2.warpPerspective(
            other, homography @ shift, size, flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderValue=-1.0
        )
        mean_there, spread_there = _moments(np.asarray(warped, np.float32))
        product = cv2.blur(cv2.multiply(patch, warped), (WINDOW, WINDOW))
        match = (product - mean * mean_there) / (spread * spread_there)
        np.maximum(best, match, out=best)
    return best


def _moments(picture: Map) -> tuple[Map, Map]:
    """Mean and standard deviation of the windows about each pixel, the latter `FLAT` at least."""
    mean = np.asarray(cv2.blur(picture, (WINDOW, WINDOW)), np.float32)
    square = cv2.blur(cv2.multiply(picture, picture), (WINDOW, WINDOW))
    return mean, np.sqrt(np.maximum(square - mean * mean, FLAT**2))


def _homographies(one: PerspectiveCamera, other: PerspectiveCamera, reach: float) -> Iterator[Floats]:
    """Yield the maps (3, 3) from pixels of one shot to those of another by planes beyond the tree, and the ground."""
    rotation = other.camera_from_world[:, :3] @ one.camera_from_world[:, :3].T
    shift = other.camera_from_world[:, 3] - rotation @ one.camera_from_world[:, 3]
    inner, outer = _matrix(one), _matrix(other)
    nearest = 1 / (float(one.depth(np.zeros((1, 3)))[0]) + reach)
    steps = int(np.ceil(one.focal_px * np.linalg.norm(shift) * nearest / STEP_PX))
    back = np.linalg.inv(inner)
    ahead = np.array([0.0, 0.0, 1.0])
    for inverse in np.linspace(0.0, nearest, steps + 1):
        yield outer @ (rotation + np.outer(shift, ahead) * inverse) @ back
    up = one.camera_from_world[:, :3] @ np.array([0.0, 1.0, 0.0])
    for height in (-0.02, 0.0, 0.02):
        above = float(one.centre[1]) - height * reach
        yield outer @ (rotation - np.outer(shift, up) / above) @ back


def _matrix(camera: PerspectiveCamera) -> Floats:
    x, y = camera.principal_px
    return np.array([[camera.focal_px, 0, x], [0, camera.focal_px, y], [0, 0, 1.0]])


def _box(region: Mask) -> tuple[slice, slice]:
    """Rows and columns of a mask (h, w) with a window's margin."""
    rows, columns = np.flatnonzero(region.any(axis=1)), np.flatnonzero(region.any(axis=0))
    if not len(rows):
        return slice(0, 0), slice(0, 0)
    top, left = max(0, rows[0] - WINDOW), max(0, columns[0] - WINDOW)
    return slice(int(top), int(rows[-1] + 1 + WINDOW)), slice(int(left), int(columns[-1] + 1 + WINDOW))
