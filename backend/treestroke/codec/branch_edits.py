"""Edits of a capture's visible branches: JSON to values and back."""

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from treestroke.codec.json_text import check_ascii, read_json
from treestroke.core.errors import StrokesError
from treestroke.core.skeleton.branch_edits import Add, BranchEdit, Join, Move, Remove, SetRadius
from treestroke.core.types import Floats

if TYPE_CHECKING:
    from treestroke.wire_edits import Edit


def parse_edits(text: str | bytes, name: str) -> tuple[BranchEdit, ...]:
    """Return the edits that JSON text describes; ``name`` appears in messages.

    Raises
    ------
    StrokesError
        It is not JSON, or not as `wire_edits.Edits` describes it.
    """
    data = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
    try:
        check_ascii(data, StrokesError)
        return edits_from(read_json(data, StrokesError, "the edits are", "save them again"))
    except StrokesError as error:
        raise error.within(name) from error


def edits_from(value: object) -> tuple[BranchEdit, ...]:
    """Return the edits that plain mappings, lists and numbers describe.

    Raises
    ------
    StrokesError
        As `parse_edits`.
    """
    from treestroke.codec.refusals import checked
    from treestroke.wire_edits import Edits

    return edits_of(checked(Edits, value, StrokesError).edits)


def edits_of(described: "Sequence[Edit]") -> tuple[BranchEdit, ...]:
    """Return the values of edits that were checked by their description."""
    return tuple(_edit_of(edit) for edit in described)


def encode_edits(edits: Sequence[BranchEdit]) -> str:
    """Return edits as JSON that `parse_edits` reads back."""
    return json.dumps({"edits": [_plain(edit) for edit in edits]})


def _edit_of(described: "Edit") -> BranchEdit:
    from treestroke.wire_edits import AddEdit, JoinEdit, MoveEdit, RadiusEdit, RemoveEdit

    match described:
        case RemoveEdit():
            return Remove(_place(described.at))
        case AddEdit():
            return Add(_place(described.start), np.array(described.points, dtype=np.float64), described.radius)
        case MoveEdit():
            return Move(_place(described.at), _place(described.to))
        case RadiusEdit():
            return SetRadius(_place(described.at), described.radius)
        case JoinEdit():
            return Join(_place(described.at), _place(described.to))


def _plain(edit: BranchEdit) -> dict[str, Any]:
    match edit:
        case Remove(at):
            return {"do": "remove", "at": at.tolist()}
        case Add(start, points, radius):
            thick = {} if radius is None else {"radius": radius}
            return {"do": "add", "from": start.tolist(), "points": points.tolist(), **thick}
        case Move(at, to):
            return {"do": "move", "at": at.tolist(), "to": to.tolist()}
        case SetRadius(at, radius):
            return {"do": "radius", "at": at.tolist(), "radius": radius}
        case Join(at, to):
            return {"do": "join", "at": at.tolist(), "to": to.tolist()}


def _place(point: list[float]) -> Floats:
    return np.array(point, dtype=np.float64)
