"""Directions."""

import numpy as np

from treestroke.core.types import Floats

UP = np.array([0.0, 1.0, 0.0])
"""The world's vertical."""


def unit(vectors: Floats, otherwise: Floats | float = 0.0) -> Floats:
    """Scale vectors (..., d) to length 1; those without length become ``otherwise``."""
    length = np.sqrt((vectors**2).sum(axis=-1, keepdims=True))
    return np.where(length > 1e-12, vectors / np.maximum(length, 1e-12), otherwise)
