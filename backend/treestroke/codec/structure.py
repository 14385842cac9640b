"""A capture's structure (cameras and points) as JSON, without loss: what is read back has the same bits."""

import base64
import binascii
import json
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from treestroke.codec.cameras import plain_photo_camera
from treestroke.codec.json_text import read_json
from treestroke.codec.refusals import checked
from treestroke.core.capture import PointCloud, SolvedPhoto, Structure, UnusedPhoto
from treestroke.core.errors import TreestrokeError
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.wire_strokes import Wire

VERSION = 1
_MEND = "solve the capture again"
_COORDINATES, _COLOURS = np.dtype("<f8"), np.dtype("u1")


class StructureError(TreestrokeError):
    """A structure cannot be read."""

    usual_code = "structure_unreadable"
    whole = "structure"


_Finite = Annotated[float, Field(allow_inf_nan=False)]
_Row = tuple[_Finite, _Finite, _Finite, _Finite]


class _Photo(Wire):
    """A photo whose camera was found, as `plain_photo_camera` gives it, and the distortion of its lens."""

    photo: str
    camera_from_world: tuple[_Row, _Row, _Row]
    focal_px: _Finite
    principal_px: tuple[_Finite, _Finite]
    size_px: tuple[int, int]
    radial: _Finite


class _Unused(Wire):
    """A photo whose camera was not found."""

    name: str
    code: str
    detail: str


class _Cloud(Wire):
    """Points: how many, and base64 of their arrays, row by row; ``seen`` has eight flags a byte."""

    count: Annotated[int, Field(ge=0)]
    points: str
    colours: str
    seen: str


class _File(Wire):
    """The whole file."""

    version: Literal[1]
    photos: list[_Photo]
    unused: list[_Unused]
    cloud: _Cloud


def encode_structure(structure: Structure) -> bytes:
    """Return a structure as JSON text, the same bytes for the same structure."""
    cloud = structure.cloud
    value = {
        "version": VERSION,
        "photos": [
            {**plain_photo_camera(photo.name, photo.camera), "radial": float(photo.radial)}
            for photo in structure.photos
        ],
        "unused": [{"name": one.name, "code": one.code, "detail": one.detail} for one in structure.unused],
        "cloud": {
            "count": len(cloud),
            "points": _text(cloud.points.astype(_COORDINATES)),
            "colours": _text(cloud.colours),
            "seen": _text(np.packbits(cloud.seen)),
        },
    }
    return json.dumps(value, separators=(",", ":"), allow_nan=False).encode()


def decode_structure(text: bytes) -> Structure:
    """Return the structure that JSON text holds.

    Raises
    ------
    StructureError
        It is not one, or is one of another version.
    """
    value = read_json(text, StructureError, "the structure is", _MEND)
    if isinstance(value, dict) and value.get("version") != VERSION:
        fault = f"the structure is of version {value.get('version')!r}, not {VERSION}; {_MEND}"
        raise StructureError(fault, code="structure_version")
    file = checked(_File, value, StructureError)
    try:
        photos = tuple(_photo(photo) for photo in file.photos)
        cloud = _cloud(file.cloud, len(photos))
    except ValueError as error:
        raise StructureError(f"the structure is damaged ({error}); {_MEND}") from error
    return Structure(photos, cloud, tuple(UnusedPhoto(one.name, one.code, one.detail) for one in file.unused))


def plain_cloud(cloud: PointCloud, most: int) -> dict[str, Any]:
    """Return at most ``most`` points of a cloud, evenly chosen, as plain lists: places and sRGB colours."""
    chosen = np.arange(len(cloud)) if len(cloud) <= most else np.linspace(0, len(cloud) - 1, most).astype(int)
    return {"points": cloud.points[chosen].tolist(), "colours": cloud.colours[chosen].tolist()}


def _photo(photo: _Photo) -> SolvedPhoto:
    pose = np.array(photo.camera_from_world, dtype=np.float64)
    camera = PerspectiveCamera(*photo.size_px, pose, photo.focal_px, photo.principal_px)
    return SolvedPhoto(photo.photo, camera, photo.radial)


def _cloud(cloud: _Cloud, shots: int) -> PointCloud:
    points = _array(cloud.points, _COORDINATES, cloud.count * 3).astype(np.float64).reshape(-1, 3)
    if not np.isfinite(points).all():
        raise ValueError("a point is not finite")
    colours = _array(cloud.colours, _COLOURS, cloud.count * 3).reshape(-1, 3)
    flags = cloud.count * shots
    seen = np.unpackbits(_array(cloud.seen, _COLOURS, -(-flags // 8)), count=flags)
    return PointCloud(points, colours, seen.astype(bool).reshape(cloud.count, shots))


def _text(values: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode("ascii")


def _array(text: str, kind: np.dtype[Any], count: int) -> NDArray[Any]:
    """Return the values (count,) that base64 text holds."""
    try:
        values = np.frombuffer(base64.b64decode(text, validate=True), kind)
    except binascii.Error as error:
        raise ValueError("an array is not base64") from error
    if len(values) != count:
        raise ValueError(f"an array has {len(values)} values, not {count}")
    return values.copy()
