import cv2
import numpy as np
import pytest

from treestroke.core.types import Picture
from treestroke.engines.features import find_features


def speckled() -> Picture:
    """A picture with detail of all sizes."""
    rng = np.random.default_rng(3)
    sizes = [(240 // step, 320 // step) for step in (1, 2, 4, 8, 16)]
    layers = [cv2.resize(rng.normal(0, 14, size), (320, 240), interpolation=cv2.INTER_CUBIC) for size in sizes]
    return np.repeat(np.clip(128 + sum(layers), 0, 255).astype(np.uint8)[..., None], 3, axis=2)


@pytest.mark.parametrize("blur_px", [2.0, 4.0])
def test_a_blurred_photo_is_less_sharp_even_with_noise_of_jpeg(blur_px: float) -> None:
    blurred = cv2.GaussianBlur(speckled(), (0, 0), blur_px)
    noisy = np.clip(blurred + np.random.default_rng(4).normal(0, 1.0, blurred.shape), 0, 255).astype(np.uint8)
    assert find_features(noisy).sharpness < 0.45 * find_features(speckled()).sharpness
