"""JSON text to plain values, strictly."""

import json
from collections import Counter
from typing import Any

from treestroke.core.errors import TreestrokeError, shown
from treestroke.limits import MAX_POINTS, MAX_STROKES

MOST_DIGITS = 308
"""No float's range ends below this many digits: a longer whole number is read as a float, which may be infinite."""
_MOST_SIGNS = {b"[": 1.1 * MAX_STROKES * MAX_POINTS, b"{": 1000 * MAX_STROKES, b",": 2.2 * MAX_STROKES * MAX_POINTS}
"""What the longest strokes need, and some more for unknown keys, which are refused by name later."""
_MOST_WIDE_BYTES = 1_000_000
"""Longest text with characters outside ASCII, each of which may make all of it four times as large in memory."""


def read_json(text: bytes, kind: type[TreestrokeError], said: str, mend: str) -> Any:
    """Return the value of JSON text in UTF-8; a byte order mark is accepted.

    NaN and numbers beyond a float's range are read as not finite, so that whoever checks the values can say where
    they stand. ``said`` begins the message of a refusal ("the strokes are"); ``mend`` ends it.

    Raises
    ------
    TreestrokeError
        Of the given kind. Code ``malformed_json``: it is not JSON, nested too deep, or an object has a key twice;
        ``too_many_points``: it holds more than the longest strokes, and reading it would take minutes and gigabytes.
    """
    if any(text.count(sign) > most for sign, most in _MOST_SIGNS.items()):
        most = f"more than {MAX_STROKES} strokes of {MAX_POINTS} points"
        raise kind(f"{said} too long: it holds {most}; thin them out", code="too_many_points")
    try:
        return json.loads(text.decode("utf-8-sig"), parse_int=_whole, object_pairs_hook=_object)
    except (ValueError, RecursionError) as error:
        raise kind(f"{said} not valid JSON ({error}); {mend}", code="malformed_json") from error


def check_ascii(text: bytes, kind: type[TreestrokeError]) -> None:
    """Refuse long text with characters outside ASCII, which strokes do not need.

    Raises
    ------
    TreestrokeError
        Of the given kind: there are such characters.
    """
    if len(text) > _MOST_WIDE_BYTES and not text.isascii():
        raise kind("strokes need ASCII characters only; leave out all others", code="malformed_json")


def _whole(digits: str) -> int | float:
    return int(digits) if len(digits) <= MOST_DIGITS else float(digits)


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        twice = Counter(key for key, _ in pairs).most_common(1)[0][0]
        raise ValueError(f"the key {shown(twice)} is there twice")
    return table
