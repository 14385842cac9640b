"""The twigs of a spray, on a square whose positions are 0 to 1, x right, y down."""

import numpy as np

from treestroke.core.types import Floats

ROOM = 0.36
"""How far shoots reach from the square's middle, so that the leaves at their tips have room."""


def draw_twig(rng: np.random.Generator) -> Floats:
    """Draw the twig (9, 2): from the bottom's middle upward with a bend."""
    t = np.linspace(0, 1, 9)
    bend, lean = rng.uniform(-0.06, 0.06), rng.uniform(-0.1, 0.1)
    return np.stack([0.5 + bend * np.sin(np.pi * t) + lean * t, 0.97 - 0.7 * t], axis=1)


def draw_shoots(rng: np.random.Generator, count: int, longest: float, room: float = ROOM) -> Floats:
    """Draw a twig and the bent shoots (count + 1, 9, 2) that leave it to both sides, no two sprays alike."""
    twig, t = draw_twig(rng), np.linspace(0, 1, 9)
    share = (np.arange(count) + rng.uniform(0.1, 0.9, count)) / count
    turn = np.where((np.arange(count) + rng.integers(2)) % 2, 1.0, -1.0)
    length = longest * rng.uniform(0.55, 1.0, count) * (1.0 - 0.45 * share)
    angle = turn * rng.uniform(0.6, 1.25, count) * (1.1 - 0.4 * share)
    bent = angle[:, None] + turn[:, None] * rng.uniform(-0.5, 0.25, (count, 1)) * t
    foot, way = along(twig, share), length[:, None, None] * t[:, None] * heading(bent)
    left = np.minimum(1.0, room / np.abs(foot[:, None] - 0.5 + way).max(axis=(1, 2)))
    return np.concatenate([twig[None], foot[:, None] + left[:, None, None] * way])


def heading(angle: Floats) -> Floats:
    """Turn angles from straight up, clockwise, into unit vectors (..., 2)."""
    return np.stack([np.sin(angle), -np.cos(angle)], axis=-1)


def angle_of(way: Floats) -> Floats:
    """Angle (...) of directions (..., 2) from straight up, clockwise."""
    return np.asarray(np.arctan2(way[..., 0], -way[..., 1]))


def along(lines: Floats, share: Floats) -> Floats:
    """Points (..., 2) at shares (...) of the length of lines (..., 9, 2), each of its own or all of one line."""
    place = np.clip(share, 0, 1) * 8
    piece = np.minimum(place, 7).astype(np.int64)
    lines = np.broadcast_to(lines, (*share.shape, 9, 2))
    start, end = (np.take_along_axis(lines, (piece + k)[..., None, None], axis=-2)[..., 0, :] for k in (0, 1))
    return np.asarray(start + (place - piece)[..., None] * (end - start))
