"""The picture of trees from all sides: photos of several kinds, and what grows from them."""

from pathlib import Path

import cv2
import numpy as np
from docs.pictures.hero import OBLIQUE_DEG, QUALITY, paper, views_of
from PIL import Image
from tests.e2e.visitor import ROOT

import treestroke
from treestroke.core.types import Picture
from treestroke.service.loading import load_photo

TREES = ("redbud_park", "boxelder_lawn", "cherry_blossom", "ponderosa_slope")
"""Photos of the tests, one a row."""
SIDES_DEG = (90.0, 180.0, 270.0)
"""From where each tree is seen beside its photo's side, toward its right."""
_HEIGHT, _WIDTH, _GAP = 260, 290, 6
"""Size of a part, and the gap between parts, px."""


def draw_sides(path: Path) -> None:
    """Draw a row for each tree: the photo, the tree as the photo frames it, and the tree from its other sides."""
    rows = [np.hstack([part for part in row_of(name) for part in (part, paper(_HEIGHT, _GAP))]) for name in TREES]
    gap = paper(_GAP, rows[0].shape[1])
    Image.fromarray(np.vstack([part for row in rows for part in (row, gap)])).save(path, quality=QUALITY, optimize=True)


def row_of(name: str) -> list[Picture]:
    """Draw the parts of a tree's row."""
    photo = ROOT / "tests" / "data" / f"{name}.jpg"
    model = treestroke.model(photo, photo.with_suffix(".strokes.json"))
    sides = [views_of(model, np.radians(side - OBLIQUE_DEG))[1] for side in SIDES_DEG]
    return [whole(view) for view in (load_photo(photo), views_of(model, 0.0)[0], *sides)]


def whole(picture: Picture) -> Picture:
    """Reduce a picture to fit into a part, and put it in its middle."""
    scale = min(_HEIGHT / picture.shape[0], _WIDTH / picture.shape[1])
    height, width = round(picture.shape[0] * scale), round(picture.shape[1] * scale)
    part, left, top = paper(_HEIGHT, _WIDTH), (_WIDTH - width) // 2, (_HEIGHT - height) // 2
    part[top : top + height, left : left + width] = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA)
    return part
