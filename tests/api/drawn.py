"""A small drawn tree and its strokes: everything about it takes about a second."""

import io
import json
from typing import Any

import cv2
import numpy as np
from PIL import Image
from tests.pictures import disc, leaves_on_sky, ring

WIDTH, HEIGHT = 200, 240
ROOT = [100, 230]
STROKES: dict[str, Any] = {
    "crown": {"points": ring(76, (100, 90), 24).round(1).tolist()},
    "branches": [{"points": [ROOT, [100, 180], [101, 130]], "width": 9.0}],
}
QUICK = {"iterations": 10, "leaf_density": 0.2}
"""Settings of a model that is made at once."""


def pixels(seed: int = 0) -> np.ndarray:
    """Draw the tree (HEIGHT, WIDTH, 3); another seed gives another light on its leaves."""
    mask = disc(HEIGHT, 70, (100, 90))[:, :WIDTH]
    return cv2.line(leaves_on_sky(mask, (70, 120, 40), seed), tuple(ROOT), (100, 120), (60, 45, 35), 9)


def encoded(kind: str = "PNG", seed: int = 0, **options: Any) -> bytes:
    """Save the drawing as a photo."""
    out = io.BytesIO()
    Image.fromarray(pixels(seed)).save(out, kind, **options)
    return out.getvalue()


def picture_of_the_example() -> Image.Image:
    """Draw the tree that the document's example of strokes is drawn over."""
    return Image.fromarray(cv2.resize(pixels(), (800, 960)))


def request(photo: str, **others: Any) -> dict[str, Any]:
    """Ask for a model of it that is made at once."""
    return {"photo": photo, "strokes": STROKES, "settings": QUICK, **others}


def form(photo: bytes, **others: Any) -> dict[str, Any]:
    """Ask for the same by a form that brings the photo: arguments of httpx's ``post``."""
    texts = {"strokes": json.dumps(STROKES), "settings": json.dumps(QUICK), **others}
    return {"files": {"photo": ("tree.png", photo)}, "data": texts}
