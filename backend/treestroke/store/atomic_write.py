"""Results written whole or not at all."""

import os
import secrets
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path


def write_atomically(contents: Mapping[Path, bytes]) -> None:
    """Write files, each beside its place and then renamed, so that a failure leaves no new file and no damaged old one.

    A link is followed to the file that it names; what is no plain file (a device, a pipe) is written to directly.

    Raises
    ------
    OSError
        The disk is full, or a place may not be written.
    """
    staged: dict[Path, Path] = {}
    try:
        for path, data in contents.items():
            if path.exists() and not path.is_file():
                path.write_bytes(data)
            else:
                place = path.resolve()
                staged[place] = beside = place.with_name(f".treestroke-{secrets.token_hex(8)}")
                _write_through(beside, data)
        for place, beside in staged.items():
            beside.replace(place)
            _sync_folder(place.parent)
    finally:
        for beside in staged.values():
            with suppress(FileNotFoundError):
                beside.unlink()


def _write_through(path: Path, data: bytes) -> None:
    with path.open("xb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _sync_folder(folder: Path) -> None:
    """Make a rename last over a power cut."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
