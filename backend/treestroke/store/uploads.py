"""Files that arrive in pieces: what has arrived stays, so that a broken connection loses nothing."""

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, Self

from treestroke.store.scope import Scope


class Superseded(Exception):
    """Another request goes on with this upload."""


class WrongOffset(Exception):
    """A piece does not begin where what has arrived ends.

    Attributes
    ----------
    size
        How many bytes have arrived.
    """

    def __init__(self, size: int) -> None:
        super().__init__(f"{size} bytes have arrived")
        self.size = size


class PieceWriter:
    """Writes one piece to the end of a file, until another request takes over."""

    def __init__(self, file: BinaryIO) -> None:
        self._file, self._lock, self._over = file, threading.Lock(), False

    def write(self, content: bytes) -> int:
        """Write bytes and return how many the file has.

        Raises
        ------
        Superseded
            Another request has taken over.
        """
        with self._lock:
            if self._over:
                raise Superseded
            self._file.write(content)
            return self._file.tell()

    def end(self) -> None:
        """Write no more; what was written is on disk afterwards."""
        with self._lock:
            if not self._over:
                self._over = True
                self._file.flush()
                os.fsync(self._file.fileno())


class Finishing:
    """Of which uploads something is being made in this process."""

    def __init__(self) -> None:
        self._ids: set[str] = set()
        self._lock = threading.Lock()

    @contextmanager
    def of(self, id: str) -> Iterator[None]:
        """Hold the right to make something of an upload.

        Raises
        ------
        Superseded
            Another request has it.
        """
        with self._lock:
            if id in self._ids:
                raise Superseded
            self._ids.add(id)
        try:
            yield
        finally:
            with self._lock:
                self._ids.discard(id)


class Uploads:
    """The unfinished uploads of a data folder, each a file of its id."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "uploads"
        self._writers: dict[str, PieceWriter] = {}
        self._finishing = Finishing()
        self._lock = threading.Lock()

    def of(self, _: Scope) -> Self:
        """Return the same: an id tells whose upload it is."""
        return self

    def path(self, id: str) -> Path:
        """Return the path of what has arrived, which need not exist."""
        return self.folder / id

    def size(self, id: str) -> int:
        """Return how many bytes have arrived; a request that still adds some is ended."""
        with self._lock:
            writer = self._writers.pop(id, None)
        if writer is not None:
            writer.end()
        try:
            return self.path(id).stat().st_size
        except FileNotFoundError:
            return 0

    @contextmanager
    def adding(self, id: str, offset: int) -> Iterator[PieceWriter]:
        """Yield a writer of one piece, which begins at an offset; whatever happens, what it wrote stays.

        Raises
        ------
        WrongOffset
            So many bytes have not arrived, or more have.
        OSError
            The disk is full or not writable.
        """
        size = self.size(id)
        if size != offset:
            raise WrongOffset(size)
        self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        with self.path(id).open("ab") as file:
            writer = PieceWriter(file)
            with self._lock:
                self._writers[id] = writer
            try:
                yield writer
            finally:
                writer.end()
                with self._lock:
                    if self._writers.get(id) is writer:
                        del self._writers[id]

    @contextmanager
    def finishing(self, id: str) -> Iterator[None]:
        """Hold the right to make something of an upload.

        Raises
        ------
        Superseded
            Another request has it.
        """
        with self._finishing.of(id):
            yield

    @contextmanager
    def whole(self, id: str) -> Iterator[Path]:
        """Yield the path of what has arrived; it stays there, unless it is taken away."""
        yield self.path(id)

    def remove(self, id: str) -> None:
        """Remove what has arrived; a request that still adds some is ended."""
        self.size(id)
        with suppress(FileNotFoundError):
            self.path(id).unlink()

    def ids(self) -> list[str]:
        """Return the ids of all files."""
        return sorted(path.name for path in self.folder.iterdir()) if self.folder.is_dir() else []

    def total_size(self) -> int:
        """Return how many bytes all files have."""
        sizes = 0
        for id in self.ids():
            with suppress(FileNotFoundError):
                sizes += self.path(id).stat().st_size
        return sizes
