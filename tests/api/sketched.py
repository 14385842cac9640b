"""A small tree sketched from its front and from its left side, on its own canvases: it takes about a second."""

import base64
import io
from typing import Any

import cv2
import numpy as np
from PIL import Image, PngImagePlugin
from tests.api.drawn import HEIGHT, QUICK, WIDTH

FRONT: dict[str, Any] = {
    "canvas": [WIDTH, HEIGHT],
    "branches": [
        {"points": [[100.0, 230.0], [99.0, 160.0], [103.0, 90.0], [100.0, 30.0]]},
        {"points": [[99.0, 160.0], [60.0, 120.0], [40.0, 80.0]]},
        {"points": [[102.0, 110.0], [140.0, 90.0], [160.0, 60.0]]},
    ],
}
SIDE: dict[str, Any] = {
    "canvas": [180, HEIGHT],
    "branches": [
        {"points": [[90.0, 230.0], [92.0, 150.0], [88.0, 90.0], [90.0, 30.0]]},
        {"points": [[92.0, 160.0], [130.0, 115.0], [140.0, 80.0]]},
        {"points": [[89.0, 110.0], [60.0, 85.0], [45.0, 60.0]]},
    ],
}


def png(sketch: dict[str, Any], note: str = "") -> bytes:
    """Draw a sketch with a brush, dark on white; ``note`` is told by the file."""
    picture = np.full((*sketch["canvas"][::-1], 3), 255, np.uint8)
    for branch in sketch["branches"]:
        cv2.polylines(picture, [np.array(branch["points"]).round().astype(np.int32)], False, (20, 20, 20), 3)
    info, out = PngImagePlugin.PngInfo(), io.BytesIO()
    if note:
        info.add_text("Comment", note)
    Image.fromarray(picture).save(out, "PNG", pnginfo=info)
    return out.getvalue()


def pictured(sketch: dict[str, Any], note: str = "") -> dict[str, Any]:
    """Give the same as JSON holds a picture."""
    return {"picture": base64.b64encode(png(sketch, note)).decode()}


def request(**others: Any) -> dict[str, Any]:
    """Ask for a model of both that is made at once."""
    return {"sketches": {"front": FRONT, "side": SIDE}, "settings": QUICK, **others}


def berry() -> bytes:
    """Draw a fruit, cut out."""
    picture, out = np.zeros((32, 32, 4), np.uint8), io.BytesIO()
    cv2.circle(picture, (16, 16), 10, (200, 30, 30, 255), -1)
    Image.fromarray(picture).save(out, "PNG")
    return out.getvalue()
