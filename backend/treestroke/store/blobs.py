"""Blobs: immutable files named by the SHA-256 of what they hold, so that the same bytes are stored once."""

import errno
import hashlib
import os
import secrets
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from treestroke.store.atomic_write import write_atomically

_REMEMBERED = 1024
"""Files that are known to be sound as long as their times stay what they are."""
_SETTLED_NS = 10**9
"""After a file was written: a second change at the same moment would not show in its times."""


_OURS = (errno.EMFILE, errno.ENFILE, errno.ENOMEM)
"""What keeps this process from reading any file."""


class Damaged(Exception):
    """A stored file is not there, cannot be read, or does not hold what its name says."""


class Blobs:
    """A folder of blobs."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "blobs"
        self._sound: dict[str, tuple[int, ...]] = {}
        self._lock = threading.Lock()

    def put(self, content: bytes) -> str:
        """Store bytes and give their SHA-256; when this returns they survive a power cut.

        They are written anew even where they stand already: what was damaged is sound again, and a sweep that took
        the file for a stray sees that somebody wants it.

        Raises
        ------
        OSError
            The disk is full or may not be written.
        """
        sha256 = hashlib.sha256(content).hexdigest()
        path = self.path(sha256)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically({path: content})
        return sha256

    def path(self, sha256: str) -> Path:
        """Say where a blob is, or would be."""
        return self.folder / sha256[:2] / sha256

    def get(self, sha256: str) -> bytes:
        """Read a blob.

        Raises
        ------
        Damaged
            As `read_blob`.
        """
        return read_blob(self.path(sha256))

    def check(self, sha256: str) -> Path:
        """Give a blob's place once what it holds is known to be whole; it is read, in pieces, after every change.

        Raises
        ------
        Damaged
            The blob is missing, cannot be read, or holds other bytes than its name says.
        """
        path = self.path(sha256)
        try:
            now = path.stat()
            state = (now.st_ino, now.st_size, now.st_mtime_ns, now.st_ctime_ns)
            if self._sound.get(sha256) == state:
                return path
            with path.open("rb") as file:
                found = hashlib.file_digest(file, "sha256").hexdigest()
        except OSError as error:
            raise _harm(path, error) from error
        if found != sha256:
            raise Damaged(f"{path.name}: damaged")
        if time.time_ns() - now.st_ctime_ns > _SETTLED_NS:
            self._remember(sha256, state)
        return path

    def places(self) -> Iterator[tuple[str, list[Path]]]:
        """Give all files folder by folder, half-written ones too; a folder's name begins its blobs' names."""
        for folder in sorted(self.folder.iterdir()) if self.folder.is_dir() else ():
            yield folder.name, list(folder.iterdir())

    def remove(self, path: Path, state: str) -> bool:
        """Remove a file whose `state_of` is this one; one that is written again at this moment survives.

        It is moved aside first, and back where it is another one.
        """
        aside = path.with_name(f".swept-{secrets.token_hex(8)}")
        with suppress(FileNotFoundError):
            if state_of(path) != state:
                return False
            path.rename(aside)
            if state_of(aside) != state:
                os.replace(aside, path)
                return False
            aside.unlink()
            return True
        return False

    def _remember(self, sha256: str, state: tuple[int, ...]) -> None:
        with self._lock:
            self._sound[sha256] = state
            if len(self._sound) > _REMEMBERED:
                del self._sound[next(iter(self._sound))]


def state_of(path: Path) -> str:
    """Name a file's present state, which stays when it is renamed and changes when it is written anew."""
    now = path.stat()
    return f"{now.st_ino}.{now.st_mtime_ns}"


def read_blob(path: Path) -> bytes:
    """Read the blob at a place and compare it with its name.

    Raises
    ------
    Damaged
        It is missing, cannot be read, or holds other bytes than its name says.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise _harm(path, error) from error
    if hashlib.sha256(content).hexdigest() != path.name:
        raise Damaged(f"{path.name}: damaged")
    return content


def _harm(path: Path, error: OSError) -> Exception:
    """Say what is wrong with a blob that cannot be read; the error itself where nothing can."""
    if error.errno in _OURS:
        return error
    return Damaged(f"{path.name}: {'missing' if isinstance(error, FileNotFoundError) else error.strerror}")
