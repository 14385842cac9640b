"""Work of the processes that pack projects, so that the web process has its time for requests."""

import hashlib
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from treestroke.codec.project import write_project


def pack(path: Path, parts: Mapping[str, Path], settings: dict[str, Any]) -> tuple[int, str]:
    """Write a project of these files to ``path``, piece by piece; return its size and its SHA-256.

    Raises
    ------
    OSError
        The disk is full, or a part cannot be read.
    """
    with ExitStack() as opened:
        out = opened.enter_context(path.open("w+b"))
        write_project(out, {name: opened.enter_context(part.open("rb")) for name, part in parts.items()}, settings)
        size = out.tell()
        out.seek(0)
        return size, hashlib.file_digest(out, "sha256").hexdigest()
