"""JSON text to plain values, strictly."""

import json
from collections import Counter
from typing import Any

from treestroke.core.errors import TreestrokeError, shown

MOST_DIGITS = 400
"""More than any float has before its point: a longer whole number is infinite."""


def read_json(text: str | bytes, kind: type[TreestrokeError], said: str, mend: str) -> Any:
    """Read JSON (bytes: UTF-8, a byte order mark is forgiven).

    NaN and numbers beyond a float's range are read as not finite, so that whoever checks the values can say where
    they stand. ``said`` begins the message of a refusal, "..: the strokes are"; ``mend`` ends it.

    Raises
    ------
    TreestrokeError
        Of the given kind, code ``malformed_json``: no JSON, nested too deep, or an object has a key twice.
    """
    try:
        decoded = text.decode("utf-8-sig") if isinstance(text, bytes) else text
        return json.loads(decoded, parse_int=_whole, object_pairs_hook=_object)
    except (ValueError, RecursionError) as error:
        raise kind(f"{said} no valid JSON ({error}); {mend}", code="malformed_json") from error


def _whole(digits: str) -> int | float:
    return int(digits) if len(digits) < MOST_DIGITS else float(digits)


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    table = dict(pairs)
    if len(table) < len(pairs):
        twice = Counter(key for key, _ in pairs).most_common(1)[0][0]
        raise ValueError(f"the key {shown(twice)} is there twice")
    return table
