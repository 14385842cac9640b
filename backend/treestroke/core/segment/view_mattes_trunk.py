"""Where the trunk that was drawn in one shot stands in space, and what the other shots so show of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.types import Floats, Mask

Odds = NDArray[np.float32]

LAYERS = 48
"""Heights at which the trunk is placed."""
LEAN = 0.12
"""How far a trunk may stand before or behind the root's plane, as a share of its height, beside its width: its
foot is drawn before its middle."""
OFFSETS = 61
"""Places that are tried within that, at each height."""
STIFF = 1.5
"""Cost of moving by one place from one height to the next, log odds."""
INSIDE, FLANKS = (-0.8, -0.4, 0.0, 0.4, 0.8), (-3.0, -2.2, -1.6, 1.6, 2.2, 3.0)
"""Where across the trunk evidence is read, in its half widths: on it, and beside it."""
FULL = 0.9
"""Share of the half width that surely is trunk."""
FLARED = 1.3
"""How much wider than its edges were found a trunk may be."""
MOST = 4.0
"""Greatest evidence of a pixel, log odds."""


@dataclass(frozen=True, eq=False)
class StandingTrunk:
    """A trunk: its axis (n, 3), metres, from the foot up, and its half widths (n,), metres."""

    axis: Floats
    half_widths: Floats


def standing_trunk(
    trunk: Mask, camera: PerspectiveCamera, others: Sequence[PerspectiveCamera], evidence: Sequence[Odds]
) -> StandingTrunk | None:
    """Place a trunk, seen as a mask (h, w) by a camera, in space by what other shots show.

    Its left and right edge are the mask's; how far before or behind the root each part stands is where the evidence
    (h, w), log odds of tree, of the other shots is greatest on it against both sides, with a stiff axis: dynamic
    programming from the foot up. None where the mask is empty.
    """
    rows = np.flatnonzero(trunk.any(axis=1))
    if len(rows) < 2:
        return None
    left, right = trunk.argmax(axis=1)[rows], trunk.shape[1] - trunk[:, ::-1].argmax(axis=1)[rows]
    row = np.linspace(rows[-1], rows[0], LAYERS)
    sigma = 0.03 * len(rows)
    left, right = (gaussian_filter1d(side.astype(float), sigma, mode="nearest") for side in (left, right))
    middle, half = np.interp(row, rows, (left + right) / 2), np.interp(row, rows, (right - left) / 2)
    half = np.minimum.accumulate(half)
    rays = camera.world_from_pixels(np.column_stack([middle, row + 0.5]), 1.0) - camera.centre
    facing = camera.centre * (1, 0, 1) / np.hypot(camera.centre[0], camera.centre[2])
    distance = -(camera.centre @ facing)
    height = camera.centre[1] + rays[-1, 1] * distance / (rays[-1] @ facing)
    reach = LEAN * height + 2 * float(half[0] * camera.pixel_size(np.zeros((1, 3)))[0])
    steps = np.linspace(-reach, reach, OFFSETS)
    along = (distance + steps[None, :]) / (rays @ facing)[:, None]
    places = camera.centre + rays[:, None] * along[..., None]
    widths = half[:, None] * camera.pixel_size(places.reshape(-1, 3)).reshape(along.shape)
    score = np.zeros(along.shape)
    for other, odds in zip(others, evidence, strict=True):
        score += _standing_out(places, widths, other, odds)
    chosen = _stiff_path(score)
    pick = np.arange(LAYERS), chosen
    return StandingTrunk(gaussian_filter1d(places[pick], 2.0, axis=0, mode="nearest"), widths[pick])


def _standing_out(places: Floats, widths: Floats, camera: PerspectiveCamera, odds: Odds) -> Floats:
    """How much more evidence (layers, offsets) a shot has on a trunk at some places than beside it."""
    flat = places.reshape(-1, 3)
    centre = camera.pixels_from_world(flat)
    half = np.maximum(widths.ravel() / camera.pixel_size(flat), 1.0)
    limited = np.clip(odds, -MOST, MOST)

    def mean(across: tuple[float, ...]) -> Floats:
        x = np.floor(centre[:, :1] + half[:, None] * np.array(across)).astype(np.int64)
        y = np.floor(centre[:, 1:]).astype(np.int64)
        inside = (x >= 0) & (x < camera.width) & (y >= 0) & (y < camera.height)
        values = limited[np.clip(y, 0, camera.height - 1), np.clip(x, 0, camera.width - 1)]
        return np.asarray(np.where(inside, values, 0.0).mean(axis=1))

    return (mean(INSIDE) - mean(FLANKS)).reshape(widths.shape)


def _stiff_path(score: Floats) -> NDArray[np.int64]:
    """Choose a column in each row (n, m) so that the scores add up to most, less `STIFF` for each column moved."""
    columns = np.arange(score.shape[1])
    moving = STIFF * np.abs(columns[:, None] - columns[None])
    total = score[0]
    before = np.zeros(score.shape, dtype=np.int64)
    for layer in range(1, len(score)):
        reached = total[None] - moving
        before[layer] = reached.argmax(axis=1)
        total = score[layer] + reached.max(axis=1)
    path = [int(total.argmax())]
    for layer in range(len(score) - 1, 0, -1):
        path.append(int(before[layer, path[-1]]))
    return np.array(path[::-1])


def around_trunk(trunk: StandingTrunk, points: Floats, clearance: float) -> Mask:
    """Tell which points (n, 3), metres, are no further from the axis than the trunk is wide and a clearance, metres."""
    up = trunk.axis[:, 1]
    x, z, half = (np.interp(points[:, 1], up, line) for line in (trunk.axis[:, 0], trunk.axis[:, 2], trunk.half_widths))
    return np.asarray(np.hypot(points[:, 0] - x, points[:, 2] - z) <= FLARED * half + clearance)


def trunk_seen(trunk: StandingTrunk, camera: PerspectiveCamera) -> Mask:
    """Draw what a camera sees of a trunk (h, w), `FULL` of its width."""
    middle = camera.pixels_from_world(trunk.axis)
    half = FULL * trunk.half_widths / camera.pixel_size(trunk.axis)
    left, right = middle - np.column_stack([half, 0 * half]), middle + np.column_stack([half, 0 * half])
    drawn = np.zeros((camera.height, camera.width), dtype=np.uint8)
    outline = np.concatenate([left, right[::-1]])
    cv2.fillPoly(drawn, [np.rint(outline * 16 - 8).astype(np.int32)], 1, shift=4)
    return drawn.astype(bool)
