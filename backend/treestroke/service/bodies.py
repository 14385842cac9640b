"""Bodies of requests: JSON from outside, read with care."""

from collections.abc import Mapping, Sequence
from typing import Any

from treestroke.codec.json_text import read_json
from treestroke.codec.strokes import check_extent
from treestroke.core.errors import StrokesError, TreestrokeError, shown
from treestroke.core.stroke_rules import Place

MAX_REV = 2**53 - 1


def read_value(text: bytes, what: str) -> Any:
    """Read JSON that holds no more than the longest strokes need: anything else would take minutes and gigabytes.

    Raises
    ------
    StrokesError
        It is no JSON, or holds more.
    """
    try:
        check_extent(text)
    except StrokesError as error:
        raise error.within(what) from error
    return read_json(text, StrokesError, f"{what}: it is", "send valid JSON")


def read_object(body: bytes) -> dict[str, Any]:
    """Read a body that is a JSON object.

    Raises
    ------
    StrokesError
        It is none.
    """
    value = read_value(body, "body")
    if not isinstance(value, dict):
        raise StrokesError.at((), "the body must be a JSON object; send one", "wrong_type")
    return value


def check_keys(request: Mapping[str, object], needed: Sequence[str], others: Sequence[str], within: Place = ()) -> None:
    """Refuse keys that nobody knows, and the lack of one that is needed; ``within`` leads to the object.

    Raises
    ------
    TreestrokeError
        There is, or lacks, such a key.
    """
    known = (*needed, *others)
    for key in request:
        if key not in known:
            what = f"the key {shown(key)} is unknown; allowed are {', '.join(known)}"
            raise TreestrokeError.at(within, what, "unknown_key", key=key)
    for key in needed:
        if key not in request:
            raise TreestrokeError.at((*within, key), "it is missing; send it", "missing_key")


def take_rev_and_grow(request: dict[str, Any]) -> tuple[int | None, bool]:
    """Take what every request for a trace may hold out of it.

    Raises
    ------
    StrokesError
        One of them is of another type.
    """
    rev, grow = request.pop("rev", None), request.pop("grow", False)
    if rev is not None and not (type(rev) is int and abs(rev) <= MAX_REV):
        raise StrokesError.at(("rev",), f"it must be a whole number, at most {MAX_REV}", "wrong_type")
    if not isinstance(grow, bool):
        raise StrokesError.at(("grow",), "it must be true or false", "wrong_type")
    return rev, grow


def inside(place: Place, error: TreestrokeError) -> TreestrokeError:
    """Lead an error's pointer from the whole request; ``place`` is the way to the part that was read alone."""
    return type(error)(str(error), code=error.code, pointer="".join(f"/{one}" for one in place) + error.pointer)
