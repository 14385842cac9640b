"""The picture at the top of the README: a photo with two strokes, and the tree that they become from three sides."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from PIL import Image
from tests.e2e.visitor import ROOT, Path2D, strokes_of

import treestroke
from treestroke import Model
from treestroke.codec.preview import draw_preview
from treestroke.core.geometry.mesh import Surface
from treestroke.core.types import Floats, Picture

PHOTO = ROOT / "examples" / "sugar_maple_autumn.jpg"
QUALITY = 86
_HEIGHT, _GAP = 560, 8
"""Height of the picture, and the gap between its parts, px."""
_SIDES_DEG = (90.0, 200.0)
"""From where the tree is seen in the two small parts, from the photo's side to its right."""
OBLIQUE_DEG = 40.0
"""How far `draw_preview` turns the tree in its second view."""
_CROWN, _TRUNK, _CASING = (201, 242, 122), (255, 226, 174), (24, 20, 10)
"""Colours of the strokes as on the page, sRGB."""


def draw_hero(path: Path) -> None:
    """Grow the tree; draw the photo, the tree as the photo frames it, and two smaller views above each other."""
    model = treestroke.model(PHOTO, PHOTO.with_suffix(".strokes.json"))
    front, _ = views_of(model, 0.0)
    sides = [views_of(model, np.radians(side - OBLIQUE_DEG))[1] for side in _SIDES_DEG]
    half = (_HEIGHT - _GAP) // 2
    width = round(half * 1.2)
    small = [fitted(side, half, width) for side in sides]
    wide = round(_HEIGHT * front.shape[1] / front.shape[0])
    column = np.vstack([small[0], paper(_GAP, width), small[1]])
    between = paper(_HEIGHT, _GAP)
    parts = [fitted(stroked_photo(), _HEIGHT, wide), between, fitted(front, _HEIGHT, wide), between, column]
    Image.fromarray(np.hstack(parts)).save(path, quality=QUALITY, optimize=True)


def views_of(model: Model, angle_rad: float) -> tuple[Picture, Picture]:
    """Draw the tree turned about its root: at the photo's framing, and obliquely (h, w, 3), sRGB."""
    tree = model.tree
    leaf = None if tree.leaf is None else turned(tree.leaf, angle_rad)
    both = draw_preview(turned(tree.bark, angle_rad), leaf, tree.camera)
    gap = np.flatnonzero((both == 255).all(axis=(0, 2)))
    return both[:, : gap[0]], both[:, gap[-1] + 1 :]


def turned(surface: Surface, angle_rad: float) -> Surface:
    """Turn a surface about the vertical axis through the root."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    turn = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]], np.float32)
    mesh = surface.mesh
    return replace(surface, mesh=replace(mesh, positions=mesh.positions @ turn.T, normals=mesh.normals @ turn.T))


def stroked_photo(scale: float = 2.0) -> Picture:
    """Draw the two strokes over the enlarged photo (h, w, 3), sRGB."""
    with Image.open(PHOTO) as photo:
        size = (round(scale * photo.width), round(scale * photo.height))
        large = np.array(photo.convert("RGB").resize(size, Image.Resampling.BICUBIC))
    crown, trunk = strokes_of(PHOTO)["crown"]["points"], strokes_of(PHOTO)["branches"][0]["points"]
    draw_stroke(large, rounded([*crown, crown[0]]) * scale, _CROWN)
    draw_stroke(large, rounded(trunk) * scale, _TRUNK)
    return large


def rounded(line: Path2D, rounds: int = 4) -> Floats:
    """Cut a line's corners again and again, as Chaikin (1974) does; its ends stay (n, 2)."""
    points = np.array(line, float)
    for _ in range(rounds):
        early, late = (0.75 * points[:-1] + 0.25 * points[1:]), (0.25 * points[:-1] + 0.75 * points[1:])
        points = np.concatenate([points[:1], np.stack([early, late], axis=1).reshape(-1, 2), points[-1:]])
    return points


def draw_stroke(picture: Picture, line_px: Floats, colour: tuple[int, int, int]) -> None:
    """Draw a stroke with a dark casing, as the page does."""
    corners = np.round(line_px * 16).astype(np.int32)
    for width, ink in ((13, _CASING), (8, colour)):
        cv2.polylines(picture, [corners], False, ink, width, cv2.LINE_AA, shift=4)


def fitted(picture: Picture, height: int, width: int) -> Picture:
    """Reduce a picture so that it covers a part of the given size, px, and cut off what is over on both sides."""
    scale = max(height / picture.shape[0], width / picture.shape[1])
    size = (round(picture.shape[1] * scale), round(picture.shape[0] * scale))
    reduced = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    left, top = (size[0] - width) // 2, (size[1] - height) // 2
    return reduced[top : top + height, left : left + width].astype(np.uint8)


def paper(height: int, width: int) -> Picture:
    """Fill a gap (height, width, 3), sRGB."""
    return np.full((height, width, 3), (250, 247, 240), np.uint8)
