"""Where the contents of blobs are kept: the protocol of all such places, and the one without settings, a folder."""

import errno
import hashlib
import os
import secrets
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Protocol

from treestroke.store.atomic_write import sync_folder, write_atomically
from treestroke.store.scope import LOCAL

ARRIVING = ".arriving-"
"""Beginning of the names of files that are being written."""
_PIECE = 2**20
"""Bytes that are in memory at once."""
_MAX_VERIFIED = 1024
"""Files whose content was verified and need not be read again while their metadata stays the same."""
_SETTLED_NS = 10**9
"""Time after a write: a second write within the resolution of a file's times could not be seen in them."""
_PROCESS_ERRORS = (errno.EMFILE, errno.ENFILE, errno.ENOMEM)
"""Errors that keep this process from reading any file: they say nothing about the file."""


class Damaged(Exception):
    """A stored file is missing, cannot be read, or its content does not have the SHA-256 of its name."""


class StorageAway(OSError):
    """The place of the blobs does not respond, or refuses everything at the moment."""


class Objects(Protocol):
    """Files of teams, named by their SHA-256; what was stored survives a power cut."""

    place: str
    """Where they are, for messages."""

    def put(self, team: str, name: str, content: bytes) -> None:
        """Store a file, also where it exists: that repairs a damaged one.

        Raises
        ------
        OSError
            There is no room, or the place is away.
        """

    def take(self, team: str, name: str, path: Path) -> None:
        """Store a file that is on this machine's disk, in the data folder, and is gone from there afterwards.

        Raises
        ------
        OSError
            There is no room, or the place is away.
        """

    def local(self, team: str, name: str, again: bool = False) -> Path:
        """Return the path of a file on this machine; where it is a copy, it is fetched if missing, or ``again``.

        Raises
        ------
        Damaged
            There is no such file, or what was fetched has another SHA-256.
        OSError
            The place is away.
        """

    def copy(self, team: str, name: str, path: Path) -> None:
        """Copy a file to a path elsewhere, whole or not at all; it is compared with its name and synced.

        Raises
        ------
        Damaged
            It is missing, cannot be read, or has another SHA-256.
        OSError
            There is no room at the path, or the place is away.
        """

    def verify(self, team: str, name: str) -> None:
        """Read all of a file and compare it with its name, however often that was done before.

        Raises
        ------
        Damaged
            It is missing, cannot be read, or has another SHA-256.
        OSError
            The place is away.
        """

    def remove(self, team: str, names: Sequence[str]) -> None:
        """Remove files, which need not exist.

        Raises
        ------
        OSError
            The place is away.
        """

    def pages(self) -> Iterator[tuple[str, dict[str, int]]]:
        """Yield all files in pages: a team, and the sizes of some of its files by their names.

        What a process that died has left half written is among them.
        """

    def check_reachable(self) -> None:
        """Do nothing where the place responds.

        Raises
        ------
        StorageAway
            It does not.
        """


class FolderObjects:
    """Objects in the data folder: ``blobs/ab/SHA-256`` of the only team, ``blobs/TEAM/ab/SHA-256`` of others."""

    def __init__(self, data: Path) -> None:
        self._folder = data / "blobs"
        self.place = str(self._folder)

    def put(self, team: str, name: str, content: bytes) -> None:
        """Store a file; as `Objects.put`."""
        path = self.local(team, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically({path: content})

    def take(self, team: str, name: str, path: Path) -> None:
        """Move a file here; as `Objects.take`."""
        place = self.local(team, name)
        place.parent.mkdir(parents=True, exist_ok=True)
        path.replace(place)
        sync_folder(place.parent)

    def local(self, team: str, name: str, again: bool = False) -> Path:  # noqa: ARG002 - nothing is fetched here
        """Return the path of a file, which need not exist."""
        return self._of(team) / name[:2] / name

    def copy(self, team: str, name: str, path: Path) -> None:
        """Copy a file; as `Objects.copy`."""
        write_verified(path, name, pieces_of(self.local(team, name)))

    def verify(self, team: str, name: str) -> None:
        """Compare a file with its name; as `Objects.verify`."""
        Verified().check(self.local(team, name))

    def remove(self, team: str, names: Sequence[str]) -> None:
        """Remove files; as `Objects.remove`."""
        for name in names:
            self._found(team, name).unlink(missing_ok=True)

    def pages(self) -> Iterator[tuple[str, dict[str, int]]]:
        """Yield the files of folder after folder; as `Objects.pages`."""
        for team, folder in self._folders():
            sizes = {}
            for path in folder.iterdir():
                with suppress(FileNotFoundError):
                    sizes[_listed(path)] = path.stat().st_size
            yield team, sizes

    def check_reachable(self) -> None:
        """Do nothing: a folder is there."""

    def _of(self, team: str) -> Path:
        return self._folder if team == LOCAL.team else self._folder / team

    def _found(self, team: str, name: str) -> Path:
        """Return the path of a file by its name in a page."""
        folder, slash, rest = name.partition("/")
        return self._of(team) / folder / rest if slash else self.local(team, name)

    def _folders(self) -> Iterator[tuple[str, Path]]:
        for folder in _folders_in(self._folder):
            if len(folder.name) == 2:
                yield str(LOCAL.team), folder
            else:
                yield from ((folder.name, below) for below in _folders_in(folder))


def _folders_in(folder: Path) -> list[Path]:
    return sorted(below for below in folder.iterdir() if below.is_dir()) if folder.is_dir() else []


def _listed(path: Path) -> str:
    """Return a file's name in a page: that of a blob, or of anything else the folder too."""
    return path.name if path.name.startswith(path.parent.name) else f"{path.parent.name}/{path.name}"


class Verified:
    """Files on disk that are compared with the SHA-256 of their names, again only if they have changed since."""

    def __init__(self) -> None:
        self._known: dict[Path, tuple[int, ...]] = {}
        self._lock = threading.Lock()

    def check(self, path: Path) -> Path:
        """Return the path of a file after verifying its content.

        Raises
        ------
        Damaged
            The file is missing, cannot be read, or has another SHA-256.
        """
        try:
            now = path.stat()
            state = (now.st_ino, now.st_size, now.st_mtime_ns, now.st_ctime_ns)
            if self._known.get(path) == state:
                return path
            found = sha256_of(path)
        except OSError as error:
            raise _read_error(path, error) from error
        if found != path.name:
            raise Damaged(f"{path.name}: damaged")
        if time.time_ns() - now.st_ctime_ns > _SETTLED_NS:
            self._remember(path, state)
        return path

    def _remember(self, path: Path, state: tuple[int, ...]) -> None:
        with self._lock:
            self._known[path] = state
            if len(self._known) > _MAX_VERIFIED:
                del self._known[next(iter(self._known))]


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file's content."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def pieces_of(path: Path) -> Iterator[bytes]:
    """Yield the content of the blob at ``path`` in pieces, which nobody has verified.

    Raises
    ------
    Damaged
        The blob is missing or cannot be read.
    """
    try:
        with path.open("rb") as file:
            while piece := file.read(_PIECE):
                yield piece
    except OSError as error:
        raise _read_error(path, error) from error


def write_verified(path: Path, sha256: str, pieces: Iterable[bytes]) -> None:
    """Write a file of pieces that together have this SHA-256, whole or not at all, and wait until it is on disk.

    Its rename is on disk only after `store.atomic_write.sync_folder`.

    Raises
    ------
    Damaged
        They have another SHA-256.
    OSError
        The disk is full, or the file may not be written.
    """
    arriving, found = path.with_name(f"{ARRIVING}{secrets.token_hex(8)}"), hashlib.sha256()
    try:
        with arriving.open("xb") as file:
            for piece in pieces:
                found.update(piece)
                file.write(piece)
            file.flush()
            os.fsync(file.fileno())
        if found.hexdigest() != sha256:
            raise Damaged(f"{sha256}: damaged")
        arriving.replace(path)
    finally:
        arriving.unlink(missing_ok=True)


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
