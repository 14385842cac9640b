"""Blobs: immutable files named by the SHA-256 of what they hold, so that the same bytes are stored once."""

import hashlib
import os
import secrets
import time
from collections.abc import Collection, Iterator
from contextlib import suppress
from pathlib import Path

from treestroke.store.files import write_whole


class Blobs:
    """A folder of blobs."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "blobs"

    def put(self, content: bytes) -> str:
        """Store bytes and give their SHA-256; when this returns they survive a power cut.

        They are written anew even where they stand already: that makes them young, and `sweep` leaves the young alone.

        Raises
        ------
        OSError
            The disk is full or may not be written.
        """
        sha256 = hashlib.sha256(content).hexdigest()
        path = self.path(sha256)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole({path: content})
        return sha256

    def path(self, sha256: str) -> Path:
        """Say where a blob is, or would be."""
        return self.folder / sha256[:2] / sha256

    def get(self, sha256: str) -> bytes:
        """Read a blob."""
        return self.path(sha256).read_bytes()

    def sweep(self, kept: Collection[str], older_than_s: float) -> int:
        """Remove the blobs, and what an interrupted writer left, that are not kept and not young; give their number.

        A blob that is written again at this moment survives: it is moved aside first, and back where it is young.
        """
        limit = time.time() - older_than_s
        removed = 0
        for path in self._strays(kept):
            aside = path.with_name(f".swept-{secrets.token_hex(8)}")
            with suppress(FileNotFoundError):
                if path.stat().st_mtime > limit:
                    continue
                path.rename(aside)
                if aside.stat().st_mtime > limit:
                    os.replace(aside, path)
                    continue
                aside.unlink()
                removed += 1
        return removed

    def _strays(self, kept: Collection[str]) -> Iterator[Path]:
        for folder in list(self.folder.iterdir()) if self.folder.is_dir() else ():
            for path in list(folder.iterdir()):
                if path.name not in kept:
                    yield path
