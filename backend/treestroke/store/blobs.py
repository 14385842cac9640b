"""Blobs: immutable files named by the SHA-256 of their content, so that equal content is stored once."""

import errno
import hashlib
import os
import secrets
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from treestroke.store.atomic_write import sync_folder, write_atomically

_MAX_VERIFIED = 1024
"""Files whose content was verified and need not be read again while their metadata stays the same."""
_SETTLED_NS = 10**9
"""Time after a write: a second write within the resolution of a file's times could not be seen in them."""
_PROCESS_ERRORS = (errno.EMFILE, errno.ENFILE, errno.ENOMEM)
"""Errors that keep this process from reading any file: they say nothing about the file."""


class Damaged(Exception):
    """A stored file is missing, cannot be read, or its content does not have the SHA-256 of its name."""


class Blobs:
    """The blobs of a data folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "blobs"
        self._verified: dict[str, tuple[int, ...]] = {}
        self._lock = threading.Lock()

    def put(self, content: bytes) -> str:
        """Store bytes and return their SHA-256; from then on they survive a power cut.

        They are written even if the blob exists: that repairs a damaged file, and shows a sweep, which may be about
        to remove the file, that it is needed.

        Raises
        ------
        OSError
            The disk is full or not writable.
        """
        sha256 = hashlib.sha256(content).hexdigest()
        path = self.path(sha256)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically({path: content})
        return sha256

    def take(self, path: Path, sha256: str) -> None:
        """Store a file, already on disk and with this SHA-256, that is moved here from the same file system.

        Raises
        ------
        OSError
            It cannot be moved.
        """
        place = self.path(sha256)
        place.parent.mkdir(parents=True, exist_ok=True)
        path.replace(place)
        sync_folder(place.parent)

    def path(self, sha256: str) -> Path:
        """Return the path of a blob, which need not exist."""
        return self.folder / sha256[:2] / sha256

    def get(self, sha256: str) -> bytes:
        """Return a blob's content.

        Raises
        ------
        Damaged
            The blob is missing, cannot be read, or has another SHA-256.
        """
        return read_blob(self.path(sha256))

    def check(self, sha256: str) -> Path:
        """Return a blob's path after verifying its content; it is read again only if the file has changed since.

        Raises
        ------
        Damaged
            The blob is missing, cannot be read, or has another SHA-256.
        """
        path = self.path(sha256)
        try:
            now = path.stat()
            state = (now.st_ino, now.st_size, now.st_mtime_ns, now.st_ctime_ns)
            if self._verified.get(sha256) == state:
                return path
            found = sha256_of(path)
        except OSError as error:
            raise _read_error(path, error) from error
        if found != sha256:
            raise Damaged(f"{path.name}: damaged")
        if time.time_ns() - now.st_ctime_ns > _SETTLED_NS:
            self._remember(sha256, state)
        return path

    def places(self) -> Iterator[tuple[str, list[Path]]]:
        """Yield all files by folder, half-written ones included; a folder's name is the prefix of its blobs' names."""
        for folder in sorted(self.folder.iterdir()) if self.folder.is_dir() else ():
            yield folder.name, list(folder.iterdir())

    def remove(self, path: Path, state: str) -> bool:
        """Remove a file if its `state_of` is ``state``, and return whether it was removed.

        The file is renamed first, and renamed back if it has changed: so a file that is written again at the same
        moment is kept.
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
            self._verified[sha256] = state
            if len(self._verified) > _MAX_VERIFIED:
                del self._verified[next(iter(self._verified))]


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file's content."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def state_of(path: Path) -> str:
    """Return an identifier of a file's content on disk: it survives renaming and changes when the file is written."""
    now = path.stat()
    return f"{now.st_ino}.{now.st_mtime_ns}"


def read_blob(path: Path) -> bytes:
    """Return the content of the blob at ``path``, verified against its name.

    Raises
    ------
    Damaged
        The blob is missing, cannot be read, or has another SHA-256.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise _read_error(path, error) from error
    if hashlib.sha256(content).hexdigest() != path.name:
        raise Damaged(f"{path.name}: damaged")
    return content


def _read_error(path: Path, error: OSError) -> Exception:
    """Return the error for a blob that cannot be read: the same error if the process can read no file at all."""
    if error.errno in _PROCESS_ERRORS:
        return error
    return Damaged(f"{path.name}: {'missing' if isinstance(error, FileNotFoundError) else error.strerror}")
