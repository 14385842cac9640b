"""Which engine grows trees here: named so that another one, whose trees may look otherwise, has another name."""

import hashlib
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import cv2
import maxflow
import numpy as np
import PIL

from treestroke import __version__

PACKAGES = ("core", "codec")
MODULES = ("execution", "files", "inputs", "jobs", "model", "report")
"""Of this package: what brings input to a tree and a tree to files."""
_BELOW = ("limits", "wire_strokes")
"""Of the whole package: what input may hold."""
LIBRARIES = {
    "numpy": np.__version__,
    "opencv": cv2.__version__,
    "pillow": PIL.__version__,
    "maxflow": maxflow.__version__,
}
_BUILT = {".pyc", ".pyi", ".so", ".pyd"}
"""Made of the sources, for one machine, or read by type checkers alone."""
_DIGITS = 12


@cache
def engine_version() -> str:
    """Give the engine's name: program, version, and a digest of what makes the tree."""
    return f"treestroke {__version__}+{digest(Path(__file__).parents[1], LIBRARIES)}"


def digest(package: Path, libraries: Mapping[str, str]) -> str:
    """Hash the sources below ``package`` that make a tree, and the versions of ``libraries``; the place is left out."""
    found = hashlib.sha256(repr(sorted(libraries.items())).encode())
    for path in sorted(sources(package)):
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        found.update(f"{path.relative_to(package).as_posix()} {content}\n".encode())
    return found.hexdigest()[:_DIGITS]


def sources(package: Path) -> Iterator[Path]:
    """Give the files that make a tree, in any order."""
    for name in PACKAGES:
        yield from (path for path in (package / name).rglob("*") if path.is_file() and path.suffix not in _BUILT)
    yield from (package / "service" / f"{name}.py" for name in MODULES)
    yield from (package / f"{name}.py" for name in _BELOW)
