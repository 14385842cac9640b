"""Copies of blobs on this machine: bounded, each compared with its name when it arrives."""

import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from treestroke.store.objects import write_verified

MAX_BYTES = 8_000_000_000
"""Size of all copies; those that were used longest ago go first."""


class Copies:
    """The copies in a data folder, which several processes may share: ``cache/TEAM/ab/SHA-256``."""

    def __init__(self, data: Path, max_bytes: int = MAX_BYTES) -> None:
        self._folder, self._max_bytes = data / "cache", max_bytes

    def find(self, team: str, name: str) -> Path | None:
        """Return the path of a copy, which counts as used now; None where there is none."""
        path = self._path(team, name)
        try:
            os.utime(path)
        except FileNotFoundError:
            return None
        return path

    def write(self, team: str, name: str, size: int, pieces: Iterable[bytes]) -> Path:
        """Write a copy of so many bytes and return its path; nothing is left of one that cannot be used.

        Raises
        ------
        Damaged
            What arrives has another SHA-256.
        OSError
            The disk is full.
        """
        self._make_room(size)
        place = self._place(team, name)
        write_verified(place, name, pieces)
        return place

    def take(self, team: str, name: str, path: Path) -> None:
        """Make a file, which is in the data folder, a copy."""
        self._make_room(path.stat().st_size)
        path.replace(self._place(team, name))

    def remove(self, team: str, name: str) -> None:
        """Remove a copy, which need not exist."""
        self._path(team, name).unlink(missing_ok=True)

    def _path(self, team: str, name: str) -> Path:
        return self._folder / team / name[:2] / name

    def _place(self, team: str, name: str) -> Path:
        """Return the path of a copy that is about to be made, in a folder that is there."""
        place = self._path(team, name)
        place.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        return place

    def _make_room(self, size: int) -> None:
        """Remove the copies that were used longest ago, until one of this size fits in."""
        found = []
        for path in self._folder.rglob("*"):
            with suppress(FileNotFoundError):
                if not path.is_dir():
                    now = path.stat()
                    found.append((now.st_mtime_ns, now.st_size, path))
        room = self._max_bytes - size - sum(size for _, size, _ in found)
        for _, freed, path in sorted(found):
            if room >= 0:
                return
            path.unlink(missing_ok=True)
            room += freed
