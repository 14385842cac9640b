"""A grown skeleton as files: JSON, SWC, CSV, as ``docs/formats.md`` describes them."""

import json

import numpy as np
from numpy.typing import NDArray

from treestroke.codec.skeleton import plain_camera
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.skeleton.measure import generations, path_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import heaviest_children
from treestroke.core.types import Indices

SCHEMA, VERSION = "treestroke.skeleton", 1
_DIGITS = 5
"""Decimals of a metre."""
_FRAME = "right-handed, +Y up, +Z toward the viewer, origin at the first root"
_ROOT, _WOOD = 1, 3
"""SWC structure identifiers: soma, which readers take for the root, and (basal) dendrite for all other wood."""
_CSV_HEAD = "joint,parent,x_m,y_m,z_m,radius_m,order,born,path_m"
_SWC_HEAD = """# treestroke.skeleton 1
# columns: id type x y z radius parent; id from 1, parent -1 at a root
# unit: metre; frame: {frame}
# type: 1 root, 3 wood
"""


def encode_skeleton_json(skeleton: Skeleton, born: NDArray[np.int64] | None, camera: OrthographicCamera) -> bytes:
    """Encode a skeleton (metres) as JSON: schema, version, unit, frame, the photo's camera, a list for each column.

    ``born`` (n,) is the round of growth in which each joint appeared; without it the column is absent.
    """
    value = {
        "schema": SCHEMA,
        "version": VERSION,
        "unit": "metre",
        "frame": _FRAME,
        "photo": plain_camera(camera),
        "points": skeleton.points.round(_DIGITS).tolist(),
        "radii": skeleton.radii.round(_DIGITS).tolist(),
        "parents": skeleton.parents.tolist(),
        "orders": branch_orders(skeleton).tolist(),
        **({} if born is None else {"born": born.tolist()}),
    }
    return json.dumps(value, separators=(",", ":"), allow_nan=False).encode()


def encode_swc(skeleton: Skeleton) -> bytes:
    """Encode a skeleton (metres) as SWC: one joint a line, numbered from 1, parents first; radii are metres too."""
    number = np.arange(1, len(skeleton) + 1)
    kind = np.where(skeleton.parents < 0, _ROOT, _WOOD)
    parent = np.where(skeleton.parents < 0, -1, skeleton.parents + 1)
    columns = (number, kind, *skeleton.points.T, skeleton.radii, parent)
    return (_SWC_HEAD.format(frame=_FRAME) + _lines(f"%d %d {_reals(4, ' ')} %d", columns)).encode()


def encode_csv(skeleton: Skeleton, born: NDArray[np.int64] | None) -> bytes:
    """Encode a skeleton (metres) as CSV with a header: one joint a row; ``born`` (n,) is left empty if unknown."""
    columns = (np.arange(len(skeleton)), skeleton.parents, *skeleton.points.T, skeleton.radii)
    ends = (branch_orders(skeleton), *(() if born is None else (born,)), path_lengths(skeleton))
    row = f"%d,%d,{_reals(4, ',')},%d,{'' if born is None else '%d'},{_reals(1, ',')}"
    return (_CSV_HEAD + "\n" + _lines(row, (*columns, *ends))).encode()


def branch_orders(skeleton: Skeleton) -> Indices:
    """Return each joint's branch order (n,): 0 on a stem, one more on each limb that is not the thickest child."""
    return generations(skeleton, heaviest_children(skeleton, skeleton.radii))


def _reals(count: int, between: str) -> str:
    """Return the format of ``count`` numbers."""
    return between.join([f"%.{_DIGITS}f"] * count)


def _lines(row: str, columns: tuple[NDArray[np.generic], ...]) -> str:
    """Format one line for each row of the columns (k arrays of n)."""
    return "".join(row % values + "\n" for values in zip(*(column.tolist() for column in columns), strict=True))
