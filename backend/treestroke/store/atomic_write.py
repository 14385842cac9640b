"""Files that are written completely or not at all."""

import os
import secrets
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path


def write_atomically(contents: Mapping[Path, bytes]) -> None:
    """Write files, so that a failure leaves neither a new file nor a damaged old one.

    Each is written to a temporary file in its folder and then renamed. Symbolic links are followed; what is not a
    regular file (a device, a pipe) is written directly.

    Raises
    ------
    OSError
        The disk is full, or a file may not be written.
    """
    temporary: dict[Path, Path] = {}
    try:
        for path, data in contents.items():
            if path.exists() and not path.is_file():
                path.write_bytes(data)
            else:
                target = path.resolve()
                temporary[target] = written = target.with_name(f".treestroke-{secrets.token_hex(8)}")
                write_synced(written, data)
        for target, written in temporary.items():
            written.replace(target)
            sync_folder(target.parent)
    finally:
        for written in temporary.values():
            with suppress(FileNotFoundError):
                written.unlink()


def write_synced(path: Path, data: bytes) -> None:
    """Write a new file and wait until it is on disk.

    Raises
    ------
    OSError
        The disk is full, or the file may not be written.
    """
    with path.open("xb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def sync_folder(folder: Path) -> None:
    """Wait until a rename in the folder is on disk, so that it survives a power cut."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
