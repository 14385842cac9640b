"""Twigs and shoots of a spray, in shares of its square's side: x right, y down."""

import numpy as np

from treestroke.core.types import Floats

SHOOT_REACH = 0.36
"""How far shoots reach from the square's middle, so that the leaves at their tips fit."""


def draw_twig(rng: np.random.Generator) -> Floats:
    """Draw a bent twig (9, 2), shares of the side, from the middle of the bottom edge upward."""
    t = np.linspace(0, 1, 9)
    bend, lean = rng.uniform(-0.06, 0.06), rng.uniform(-0.1, 0.1)
    return np.stack([0.5 + bend * np.sin(np.pi * t) + lean * t, 0.97 - 0.7 * t], axis=1)


def draw_shoots(rng: np.random.Generator, count: int, longest: float, reach: float = SHOOT_REACH) -> Floats:
    """Draw a twig and ``count`` bent shoots that leave it to alternate sides: (count + 1, 9, 2), shares of the side.

    Shoots are at most ``longest`` long and are shortened where they would end further than ``reach`` from the middle.
    """
    twig, t = draw_twig(rng), np.linspace(0, 1, 9)
    share = (np.arange(count) + rng.uniform(0.1, 0.9, count)) / count
    turn = np.where((np.arange(count) + rng.integers(2)) % 2, 1.0, -1.0)
    length = longest * rng.uniform(0.55, 1.0, count) * (1.0 - 0.45 * share)
    angle = turn * rng.uniform(0.6, 1.25, count) * (1.1 - 0.4 * share)
    bent = angle[:, None] + turn[:, None] * rng.uniform(-0.5, 0.25, (count, 1)) * t
    foot, way = along(twig, share), length[:, None, None] * t[:, None] * heading(bent)
    shortening = np.minimum(1.0, reach / np.abs(foot[:, None] - 0.5 + way).max(axis=(1, 2)))
    return np.concatenate([twig[None], foot[:, None] + shortening[:, None, None] * way])


def heading(angle_rad: Floats) -> Floats:
    """Convert angles (...,), rad, clockwise from straight up, to unit vectors (..., 2)."""
    return np.stack([np.sin(angle_rad), -np.cos(angle_rad)], axis=-1)


def angle_of(direction: Floats) -> Floats:
    """Convert directions (..., 2) of any length to angles (...,), rad, clockwise from straight up."""
    return np.asarray(np.arctan2(direction[..., 0], -direction[..., 1]))


def along(lines: Floats, share: Floats) -> Floats:
    """Interpolate points (..., 2) at shares (...,), 0 to 1, of lines (..., 9, 2): one line each, or one for all."""
    place = np.clip(share, 0, 1) * 8
    piece = np.minimum(place, 7).astype(np.int64)
    lines = np.broadcast_to(lines, (*share.shape, 9, 2))
    start, end = (np.take_along_axis(lines, (piece + k)[..., None, None], axis=-2)[..., 0, :] for k in (0, 1))
    return np.asarray(start + (place - piece)[..., None] * (end - start))
