"""Depths of a shot's pixels, by sweeping a plane through the hull and comparing neighbouring shots on it."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.capture import Shot, TreeMatte
from treestroke.core.carve.tomography import DensityField
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.plane_maps import parallax_px, plane_map
from treestroke.core.imaging.correlation import Windows, correlation, windows_of
from treestroke.core.types import Floats, Indices, Mask

Singles = NDArray[np.float32]

REDUCTION = 2
"""Pixels of a shot, each way, that are compared as one."""
WINDOW = 7
"""Side of the windows that are compared, reduced px."""
BEHIND = 1.5
"""Brightness put behind the tree, in standard deviations over its mean: limbs are compared by their outline too."""
STEP_PX = 1.5
"""Distance of planes, as the shift of a pixel in the neighbours, reduced px."""
FLAT = 4.0
"""Standard deviation of brightness, of 255, below which a window has nothing to match."""
PRIOR = 0.08
"""Weight of the logarithm of how likely the measured density lets a line end on a plane, beside the correlation."""
UNLIKELY = 1e-4
"""Least such chance within the hull."""


@dataclass(frozen=True, eq=False)
class SweptShot:
    """A shot made ready: brightness of the tree before an even ground, reduced, of its part that shows the tree.

    Attributes
    ----------
    camera
        Camera of that part at the reduced size.
    corner_px
        (left, top) of that part in the shot.
    brightness
        (h, w) grey of the tree, 0 to 255, over even ground.
    tree
        (h, w) pixels that show the tree.
    """

    camera: PerspectiveCamera
    corner_px: tuple[int, int]
    brightness: Singles
    tree: Mask


@dataclass(frozen=True, eq=False)
class DepthMap:
    """Depths of the pixels of a reduced shot.

    Attributes
    ----------
    camera, corner_px
        The reduced shot's camera, and (left, top) of its part in the shot.
    depth_m
        (h, w) depth, metres; 0 where none was found.
    score
        (h, w) mean correlation of the pixel's window with the neighbours that match best, -1 to 1.
    """

    camera: PerspectiveCamera
    corner_px: tuple[int, int]
    depth_m: Singles
    score: Singles


def swept_shot(shot: Shot, matte: TreeMatte) -> SweptShot | None:
    """Cut a shot to its tree and reduce it; None if the matte shows nothing."""
    rows, columns = (np.flatnonzero(matte.tree.any(axis=axis)) for axis in (1, 0))
    if len(rows) == 0:
        return None
    margin = WINDOW * REDUCTION
    top, left = (max(int(line[0]) - margin, 0) // REDUCTION * REDUCTION for line in (rows, columns))
    high, wide = (
        (min(int(line[-1]) + margin, length) - start) // REDUCTION
        for line, start, length in ((rows, top, matte.tree.shape[0]), (columns, left, matte.tree.shape[1]))
    )
    part = np.s_[top : top + high * REDUCTION, left : left + wide * REDUCTION]
    grey, opacity = (
        cv2.resize(values, (wide, high), interpolation=cv2.INTER_AREA)
        for values in (
            cv2.cvtColor(shot.picture[part], cv2.COLOR_RGB2GRAY).astype(np.float32),
            np.ascontiguousarray(matte.opacity[part]),
        )
    )
    tree = opacity >= 0.5
    ground = min(float(grey[tree].mean() + BEHIND * grey[tree].std()), 255.0) if tree.any() else 0.0
    camera = shot.camera.cropped((left, top), (wide * REDUCTION, high * REDUCTION)).resized(wide, high)
    return SweptShot(camera, (left, top), np.asarray(opacity * grey + (1 - opacity) * ground, dtype=np.float32), tree)


def depth_map(shot: SweptShot, neighbours: Sequence[SweptShot], field: DensityField) -> DepthMap:
    """Find the depth at which a shot's pixels look most alike in its neighbours, within the hull of the tree.

    Planes square to the line of sight are swept from near to far. On each, windows are compared by their correlation,
    and the mean is taken over the two neighbours that match best; to it comes how likely the measured densities let a
    line of sight end there. Between planes the depth is that of a parabola through the best and those beside it.

    Notes
    -----
    Collins 1996 (sweeping a plane); Gallup, Frahm, Mordohai and Pollefeys 2007 (planes by the shift that they make).
    """
    planes = _planes(shot, neighbours, field)
    row, column = np.nonzero(shot.tree)
    middles_px = np.asarray(np.stack([column, row], axis=1) + 0.5, dtype=np.float64)
    ahead = shot.camera.world_from_pixels(middles_px, 1.0) - shot.camera.centre
    stretch = np.linalg.norm(ahead, axis=1).astype(np.float32)
    scores, total = np.full((2, len(planes), len(row)), -np.inf, dtype=np.float32)
    clear = np.ones(len(row), dtype=np.float32)
    steps = np.gradient(planes).astype(np.float32)
    for plane, depth in enumerate(planes.tolist()):
        density = field.along(shot.camera.centre, ahead, depth)
        held = density >= 0
        if not held.any():
            continue
        open_share = np.exp(-np.maximum(density, 0) * steps[plane] * stretch)
        chance, clear = clear * (1 - open_share), clear * open_share
        score = _scores(shot, neighbours, depth, (row[held], column[held]))
        scores[plane, held] = score
        total[plane, held] = score + PRIOR * np.log(np.maximum(chance[held], UNLIKELY))
    return _best(shot, planes, scores, total)


def _scores(shot: SweptShot, neighbours: Sequence[SweptShot], depth: float, pixels: tuple[Indices, Indices]) -> Singles:
    """Score pixels, their rows and columns (n,), on a plane at a depth, metres: (n,)."""
    row, column = pixels
    half = WINDOW // 2
    top, left = max(int(row.min()) - half, 0), max(int(column.min()) - half, 0)
    part = shot.brightness[top : int(row.max()) + half + 1, left : int(column.max()) + half + 1]
    camera = shot.camera.cropped((left, top), (part.shape[1], part.shape[0]))
    mine = windows_of(part, WINDOW, FLAT)
    alike = [_alike(mine, camera, other, depth) for other in neighbours]
    return np.asarray(_best_two(alike)[row - top, column - left])


def _best_two(alike: Sequence[Singles]) -> Singles:
    """Average the greatest two, or the only one, of scores (h, w): other neighbours may see a pixel hidden."""
    first, *others = alike
    if not others:
        return first
    second = np.full_like(first, -1.0)
    for score in others:
        second = np.maximum(second, np.minimum(first, score))
        first = np.maximum(first, score)
    return np.asarray((first + second) / 2)


def _planes(shot: SweptShot, neighbours: Sequence[SweptShot], field: DensityField) -> Floats:
    """Depths (planes,), metres, from the hull's front to its back, evenly by the shift that they make."""
    depth = shot.camera.depth(field.corners)
    near, far = max(float(depth.min()), 0.1 * float(depth.max())), float(depth.max())
    shift = np.median([parallax_px(shot.camera, other.camera, near) for other in neighbours])
    count = int(np.ceil(shift * (1 - near / far) / STEP_PX)) + 2
    return np.asarray(1 / np.linspace(1 / near, 1 / far, count))


def _alike(mine: Windows, camera: PerspectiveCamera, other: SweptShot, depth: float) -> Singles:
    """Correlate windows (h, w) of a part of a shot with those that a plane at a depth, metres, shows of another."""
    flags, size = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, mine.picture.shape[::-1]
    turn = plane_map(camera, other.camera, camera.ahead, depth)
    seen = cv2.warpPerspective(other.brightness, turn, size, flags=flags, borderMode=cv2.BORDER_REPLICATE)
    return correlation(mine, windows_of(np.asarray(seen, np.float32), WINDOW, FLAT))


def _best(shot: SweptShot, planes: Floats, scores: Singles, total: Singles) -> DepthMap:
    """Choose each pixel's plane by the ``total`` (planes, n), and a place between planes by the ``scores``."""
    best = total.argmax(axis=0)
    pixels = np.arange(len(best))
    inner = np.clip(best, 1, len(planes) - 2)
    before, at, after = (scores[inner + step, pixels] for step in (-1, 0, 1))
    with np.errstate(invalid="ignore", divide="ignore"):
        bend = before - 2 * at + after
        move = np.where((bend < 0) & np.isfinite(bend), 0.5 * (before - after) / bend, 0.0)
    place = np.where(inner == best, best + np.clip(move, -0.5, 0.5), best)
    inverse = np.interp(place, np.arange(len(planes)), 1 / planes)
    found = np.isfinite(total[best, pixels])
    depth, score = np.zeros((2, *shot.tree.shape), dtype=np.float32)
    depth[shot.tree] = np.where(found, 1 / inverse, 0.0)
    score[shot.tree] = np.where(found, scores[best, pixels], -1.0)
    return DepthMap(shot.camera, shot.corner_px, depth, score)
