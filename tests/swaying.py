"""Small videos of something textured that sways before a background, with known motion."""

import cv2
import numpy as np

FRAMES_PER_SECOND = 24.0
WIDTH, HEIGHT = 200, 160
FOOT = np.array([100.0, 140.0])
CROWN = (slice(20, 110), slice(50, 150))


def crown_mask() -> np.ndarray:
    """Return where the crown is in the first frame, (h, w)."""
    mask = np.zeros((HEIGHT, WIDTH), dtype=bool)
    mask[CROWN] = True
    return mask


def sway_px(places: np.ndarray, frame: np.ndarray, hertz: float = 1.5, most_px: float = 6.0) -> np.ndarray:
    """Return how far places (n, 2) are moved to the right in frames (f,): more the higher they are; (f, n)."""
    height = np.clip((FOOT[1] - places[:, 1]) / FOOT[1], 0.0, 1.0)
    swing = np.sin(2.0 * np.pi * hertz * np.asarray(frame) / FRAMES_PER_SECOND)
    return most_px * swing[:, None] * height


def swaying(count: int = 48, *, hertz: float = 1.5, most_px: float = 6.0, shake_px: float = 0.0) -> np.ndarray:
    """Return grey frames (f, h, w) of a crown that sways; the whole picture moves to and fro by ``shake_px``."""
    rng = np.random.default_rng(3)
    noise = cv2.GaussianBlur(rng.uniform(0, 255, (HEIGHT, WIDTH)).astype(np.float32), (0, 0), 1.5)
    leaves = cv2.normalize(noise, None, 0, 255, cv2.NORM_MINMAX)
    far = cv2.normalize(
        cv2.GaussianBlur(rng.uniform(0, 255, leaves.shape).astype(np.float32), (0, 0), 2.0),
        None,
        90,
        210,
        cv2.NORM_MINMAX,
    )
    x, y = np.meshgrid(np.arange(WIDTH, dtype=np.float32), np.arange(HEIGHT, dtype=np.float32))
    rows = np.stack([np.zeros(HEIGHT), np.arange(HEIGHT)], axis=1)
    moved = sway_px(rows, np.arange(count), hertz, most_px).astype(np.float32)
    mask, out = crown_mask().astype(np.float32), []
    for index in range(count):
        shift = np.float32(shake_px * np.sin(2.0 * np.pi * 0.7 * index / FRAMES_PER_SECOND))
        at = x - moved[index][:, None] - shift
        cover = cv2.remap(mask, at, y, cv2.INTER_LINEAR)
        tree = cv2.remap(leaves, at, y, cv2.INTER_LINEAR)
        behind = cv2.remap(far, x - shift, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT)
        out.append(np.rint(cover * tree + (1.0 - cover) * behind).astype(np.uint8))
    return np.array(out)
