"""Drawn pictures: a disc of leaves on a sky, wood as dark bars on a light ground."""

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np

SKY = (120, 165, 225)
WOOD, GROUND = (45, 35, 30), (190, 195, 200)


def noisy(flat: np.ndarray, deviation: float = 8.0, seed: int = 0) -> np.ndarray:
    """Add a photo's noise to flat colours (h, w, 3)."""
    noise = np.random.default_rng(seed).normal(0, deviation, flat.shape)
    return np.clip(flat + noise, 0, 255).astype(np.uint8)


def disc(size: int, radius: float, centre: tuple[float, float] | None = None) -> np.ndarray:
    """Fill a disc (size, size); centre (x, y), px, the picture's middle by default."""
    x0, y0 = centre or (size / 2, size / 2)
    y, x = np.mgrid[:size, :size] + 0.5
    return np.hypot(x - x0, y - y0) < radius


def leaves_on_sky(mask: np.ndarray, leaf: tuple[int, int, int], seed: int = 0) -> np.ndarray:
    """Colour a mask (h, w) as leaves, brightness and all changing from pixel to pixel, the rest as sky."""
    light = np.random.default_rng(seed + 1).uniform(0.7, 1.15, mask.shape)[..., None]
    return noisy(np.where(mask[..., None], np.array(leaf) * light, np.array(SKY, float)), 6.0, seed)


def ring(radius: float, centre: tuple[float, float], points: int = 40) -> np.ndarray:
    """Walk a circle (points, 2), px."""
    turn = np.arange(points) * (2 * np.pi / points)
    return np.array(centre) + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)


def wood_mask(lines: Sequence[tuple[Any, float]], height: int, width: int) -> np.ndarray:
    """Draw lines of wood, each (points, thickness px), four times finer than the pixels (h, w)."""
    fine = np.zeros((4 * height, 4 * width), np.uint8)
    for points, thickness in lines:
        corners = np.round(np.array(points, float) * 4).astype(np.int32)
        cv2.polylines(fine, [corners], False, 255, max(1, round(4 * thickness)))
    return cv2.resize(fine, (width, height), interpolation=cv2.INTER_AREA) > 127


def wood_photo(wood: np.ndarray, seed: int = 0) -> np.ndarray:
    """Colour wood (h, w) dark and the rest light."""
    return noisy(np.where(wood[..., None], WOOD, GROUND), 6.0, seed)


def overlap(first: np.ndarray, second: np.ndarray) -> float:
    """Intersection over union of two masks."""
    return float((first & second).sum() / (first | second).sum())
