"""Names of uploaded files: what may stand in a line of text, and told apart from those that are taken."""

import unicodedata
from collections.abc import Sequence
from pathlib import PurePosixPath

from treestroke.limits import MAX_NAME


def file_name(name: str) -> str:
    """Return a file's name without folders and without what cannot stand in a line of text."""
    last = unicodedata.normalize("NFC", name.encode("utf-8", "replace").decode()).replace("\\", "/").rpartition("/")[2]
    plain = "".join(c if c.isprintable() else "_" for c in last).strip(" .")
    return _cut(plain, "")


def free_name(name: str, taken: Sequence[str]) -> str:
    """Return a name that no other photo has: the photo's own, or one with a number."""
    free, number = name, 1
    while free in taken:
        number += 1
        free = _cut(name, f" ({number})")
    return free


def _cut(name: str, mark: str) -> str:
    """Return a file's name with a mark before its ending, at most as long as names may be."""
    ending = PurePosixPath(name).suffix[: MAX_NAME // 4]
    stem = name[: len(name) - len(PurePosixPath(name).suffix)]
    return f"{stem[: MAX_NAME - len(mark) - len(ending)]}{mark}{ending}"
