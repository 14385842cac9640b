"""A round green tree before a blue sky, in a photo of 300 x 400 px."""

import cv2
import numpy as np
import pytest

from treestroke.core.paint.atlas import Atlas, leaf_atlas

SKY, GREEN = (110, 160, 230), (70, 110, 40)


@pytest.fixture(scope="session")
def mask() -> np.ndarray:
    disc = cv2.circle(np.zeros((400, 300), np.uint8), (150, 150), 120, 1, -1)
    return disc > 0


@pytest.fixture(scope="session")
def photo(mask: np.ndarray) -> np.ndarray:
    picture = np.where(mask[..., None], np.uint8(GREEN), np.uint8(SKY))
    noise = np.random.default_rng(1).normal(0, 14, mask.shape)[..., None]
    return np.clip(picture + noise, 0, 255).astype(np.uint8)


@pytest.fixture(scope="session")
def atlas(photo: np.ndarray, mask: np.ndarray) -> Atlas:
    return leaf_atlas(photo, mask, "leaves", np.random.default_rng(0))
