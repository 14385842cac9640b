"""The picture of a tree that was measured from many photos: some of these, and the tree from the same places."""

from pathlib import Path

import numpy as np
from docs.pictures.hero import OBLIQUE_DEG, QUALITY, paper, views_of
from docs.pictures.sides import whole
from PIL import Image
from tests.e2e.visitor import ROOT

import treestroke
from treestroke.core.types import Picture
from treestroke.service.loading import load_photo
from treestroke.service.model import Model

SET = ROOT / "examples" / "young_ash"
SHOWN = ("00.jpg", "04.jpg", "09.jpg", "13.jpg")
"""Photos that are shown, each above the tree as it is seen from there."""
_GAP = 6


def draw_measured(path: Path) -> None:
    """Draw a row of photos, and below it the tree from the places where they were taken."""
    model = treestroke.model_views(sorted(SET.glob("*.jpg")), SET / "strokes.json")
    rows = [[whole(load_photo(SET / name)) for name in SHOWN], [whole(_from(model, name)) for name in SHOWN]]
    lines = [np.hstack([part for picture in row for part in (picture, paper(len(picture), _GAP))]) for row in rows]
    Image.fromarray(np.vstack(lines)).save(path, quality=QUALITY, optimize=True)


def _from(model: Model, name: str) -> Picture:
    """Draw the tree from the side on which a photo was taken."""
    (camera,) = (camera for camera in model.report["cameras"] if camera["photo"] == name)
    pose = np.array(camera["camera_from_world"])
    centre = -pose[:, :3].T @ pose[:, 3]
    return views_of(model, float(np.arctan2(centre[0], centre[2])) - np.radians(OBLIQUE_DEG))[1]
