"""The version of the engine, which changes whenever the trees that it grows may change."""

import hashlib
from collections.abc import Iterator, Mapping
from functools import cache
from importlib import metadata
from pathlib import Path

import cv2
import maxflow
import numpy as np
import PIL

from treestroke import __version__

PACKAGES = ("core", "codec", "engines")
MODULES = (
    "clip_loading",
    "execution",
    "files",
    "jobs",
    "loading",
    "model",
    "opened",
    "report",
    "sibling_models",
    "siblings",
    "solving",
)
"""Modules of ``service`` on the way from the inputs to a tree and its files, or to a capture's structure."""
_BELOW = ("limits", "wire_edits", "wire_strokes")
"""Modules of the whole package that say what inputs may hold."""
GENERATOR = f"treestroke {__version__}"
"""The generator that files name; without the engine's digest, so that the same tree has the same bytes."""
LIBRARIES = {
    "numpy": np.__version__,
    "opencv": cv2.__version__,
    "pillow": PIL.__version__,
    "maxflow": maxflow.__version__,
    "pycolmap": metadata.version("pycolmap"),  # slow to import
}
_BUILT = {".pyc", ".pyi", ".so", ".pyd"}
"""Compiled from the sources for one machine, or read by type checkers alone."""
_DIGITS = 12


@cache
def engine_version() -> str:
    """Return program, version, and a digest of the code that makes trees."""
    return f"treestroke {__version__}+{digest(Path(__file__).parents[1], LIBRARIES)}"


def digest(package: Path, libraries: Mapping[str, str]) -> str:
    """Return a hash of the sources in ``package`` that make trees, and of the versions of ``libraries``."""
    hashed = hashlib.sha256(repr(sorted(libraries.items())).encode())
    for path in sorted(sources(package)):
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        hashed.update(f"{path.relative_to(package).as_posix()} {content}\n".encode())
    return hashed.hexdigest()[:_DIGITS]


def sources(package: Path) -> Iterator[Path]:
    """Yield the source files that make trees, in any order."""
    for name in PACKAGES:
        yield from (path for path in (package / name).rglob("*") if path.is_file() and path.suffix not in _BUILT)
    yield from (package / "service" / f"{name}.py" for name in MODULES)
    yield from (package / f"{name}.py" for name in _BELOW)
