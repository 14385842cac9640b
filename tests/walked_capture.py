"""A capture of the small tree of `tests.core.segment.walked_tree`, photographed from all around and solved."""

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from tests.core.segment.walked_tree import strokes_on, walk
from tests.rows import add_solve

from treestroke.codec.capture_strokes import encode_capture_strokes
from treestroke.codec.image import encode_png
from treestroke.codec.structure import encode_structure
from treestroke.core.capture import PointCloud, Shot, SolvedPhoto, Structure, UnusedPhoto
from treestroke.core.strokes import CameraDistance, CaptureStrokes
from treestroke.service import captures
from treestroke.service.capture_photos import fingerprint
from treestroke.service.engine_version import engine_version
from treestroke.service.photos import Resources
from treestroke.store.blobs import Blobs, open_blobs
from treestroke.store.database import Database
from treestroke.store.scope import LOCAL

COUNT = 8
UNUSED = "copy.png"
SETTINGS = {"height": 4.5, "iterations": 4, "foliage": "bare"}


@cache
def shots() -> tuple[Shot, ...]:
    return walk(COUNT)[0]


def names() -> list[str]:
    """Give the names that the photos are sent by, in the order of the walk."""
    return [f"{index}.png" for index in range(COUNT)]


def structure() -> Structure:
    """Give the true cameras, of all photos but a copy of the first."""
    solved = tuple(SolvedPhoto(name, shot.camera, 0.0) for name, shot in zip(names(), shots(), strict=True))
    rng = np.random.default_rng(2)
    points = rng.normal(size=(40, 3)) * (0.8, 0.6, 0.8) + (0.0, 3.1, 0.0)
    cloud = PointCloud(points, np.full((40, 3), 80, np.uint8), np.ones((40, COUNT), np.bool_))
    return Structure(solved, cloud, (UnusedPhoto(UNUSED, "same_photo", f"{UNUSED} is 0.png once more"),))


def views(**others: Any) -> dict[str, Any]:
    """Draw over the first photo, and tell how far apart two cameras stood."""
    drawn = CaptureStrokes({names()[0]: strokes_on(shots()[0])}, CameraDistance((names()[0], names()[4]), 20.0))
    return {**json.loads(encode_capture_strokes(drawn)), **others}


def make_capture(resources: Resources, extra: bool = True) -> str:
    """Store the photos; give the capture's id."""
    id = captures.make_capture(resources.database, b"").id
    for name, shot in zip(names(), shots(), strict=True):
        captures.add_photo(resources, id, name, encode_png(shot.picture))
    if extra:
        captures.add_photo(resources, id, UNUSED, encode_png(shots()[0].picture))
    return id


def solve(resources: Resources, id: str) -> str:
    """Write that a capture is solved, and by what; give the structure's blob."""
    return write_structure(resources.database, resources.blobs, id, structure())


def write_structure(database: Database, blobs: Blobs, id: str, found: Structure) -> str:
    """Write what was found of a capture's photos; give its blob."""
    blob = blobs.put(encode_structure(found))
    photos = captures.find_capture(database, id).photos
    known = {"status": "succeeded", "fingerprint": fingerprint(photos), "engine": engine_version()}
    add_solve(database, id, structure=blob, **known)
    return blob


def write_structure_in(data: Path, id: str, found: Structure) -> str:
    """Write what was found of a capture's photos to the data folder of a service; give its blob."""
    database = Database(data).of(LOCAL)
    return write_structure(database, open_blobs(database, data).of(LOCAL), id, found)


def request(capture: str, **others: Any) -> dict[str, Any]:
    """Ask for a model of a capture."""
    return {"capture": capture, "views": views(), "settings": SETTINGS, **others}
