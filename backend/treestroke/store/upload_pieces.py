"""Files that arrive in pieces at any of several web processes: each piece is a blob, and its row tells its place."""

import copy
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Self

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session

from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.objects import FolderObjects
from treestroke.store.scope import Scope
from treestroke.store.tables import PieceRow, UploadRow
from treestroke.store.uploads import Finishing, Superseded, Uploads, WrongOffset

_PIECE_BYTES = 8 * 2**20
"""Bytes that are in memory, and would be lost with this process, before they become a piece."""


class BlobWriter:
    """Writes pieces to the end of an upload, until another request takes over, here or in another process."""

    def __init__(self, database: Database, blobs: Blobs, id: str, offset: int) -> None:
        self._database, self._blobs, self._id = database, blobs, id
        self._lock, self._over = threading.Lock(), False
        self._stored, self._waiting = offset, bytearray()

    def write(self, content: bytes) -> int:
        """Write bytes and return how many the upload has.

        Raises
        ------
        Superseded
            Another request has taken over.
        OSError
            The place of the blobs is away.
        """
        with self._lock:
            if self._over:
                raise Superseded
            self._waiting += content
            while len(self._waiting) >= _PIECE_BYTES:
                self._store(_PIECE_BYTES)
            return self._stored + len(self._waiting)

    def end(self) -> None:
        """Write no more; what was written is stored afterwards.

        Raises
        ------
        Superseded, OSError
            As `write`.
        """
        with self._lock:
            if not self._over:
                self._over = True
                if self._waiting:
                    self._store(len(self._waiting))

    def _store(self, size: int) -> None:
        piece = bytes(self._waiting[:size])
        blob = self._blobs.put(piece)
        with self._database.writing() as session:
            upload = session.get(UploadRow, self._id, with_for_update=True)
            if upload is None or _size(session, self._id) != self._stored:
                self._over = True
                raise Superseded
            session.add(PieceRow(upload=self._id, start=self._stored, bytes=size, blob=blob, team=upload.team))
        self._stored += size
        del self._waiting[:size]


class PieceUploads:
    """The unfinished uploads of a service whose web processes share a bucket; its calls are those of `Uploads`."""

    def __init__(self, database: Database, blobs: Blobs) -> None:
        self._database, self._blobs = database, blobs
        self._writers: dict[str, BlobWriter] = {}
        self._lock = threading.Lock()
        self._finishing = Finishing()

    def of(self, scope: Scope) -> Self:
        """Return the same for the uploads of a scope."""
        view = copy.copy(self)
        view._database, view._blobs = self._database.of(scope), self._blobs.of(scope)
        return view

    def size(self, id: str) -> int:
        """Return how many bytes have arrived; a request of this process that still adds some is ended."""
        with self._lock:
            writer = self._writers.pop(id, None)
        if writer is not None:
            writer.end()
        with self._database.reading() as session:
            return _size(session, id)

    @contextmanager
    def adding(self, id: str, offset: int) -> Iterator[BlobWriter]:
        """Yield a writer of one piece, which begins at an offset; whatever happens, what it wrote stays.

        Raises
        ------
        WrongOffset
            So many bytes have not arrived, or more have.
        Superseded, OSError
            As `BlobWriter.write`.
        """
        size = self.size(id)
        if size != offset:
            raise WrongOffset(size)
        writer = BlobWriter(self._database, self._blobs, id, offset)
        with self._lock:
            self._writers[id] = writer
        try:
            yield writer
        finally:
            with self._lock:
                if self._writers.get(id) is writer:
                    del self._writers[id]
            writer.end()

    @contextmanager
    def finishing(self, id: str) -> Iterator[None]:
        """Hold the right to make something of an upload in this process; as `Uploads.finishing`."""
        with self._finishing.of(id):
            yield

    @contextmanager
    def whole(self, id: str) -> Iterator[Path]:
        """Yield the path of what has arrived, joined; unless it is taken away, it is removed afterwards.

        Raises
        ------
        Damaged, OSError
            A piece is damaged, the disk is full, or the place of the blobs is away.
        """
        with self._database.reading() as session:
            found = select(PieceRow.blob).where(PieceRow.upload == id).order_by(PieceRow.start)
            pieces = session.scalars(found).all()
        with self._blobs.temporary() as path:
            with path.open("xb") as file:
                for piece in pieces:
                    file.write(self._blobs.get(piece))
            yield path

    def remove(self, id: str) -> None:
        """Forget what has arrived; its blobs go by the next sweeps."""
        self.size(id)
        with self._database.writing() as session:
            session.execute(delete(PieceRow).where(PieceRow.upload == id))

    def ids(self) -> list[str]:
        """Return the ids of all uploads of which something has arrived."""
        with self._database.reading() as session:
            return sorted(session.scalars(select(PieceRow.upload).distinct()))

    def total_size(self) -> int:
        """Return how many bytes have arrived of all."""
        with self._database.reading() as session:
            return int(session.scalar(select(func.sum(PieceRow.bytes))) or 0)


AnyUploads = Uploads | PieceUploads


def open_uploads(database: Database, blobs: Blobs) -> AnyUploads:
    """Return the uploads beside blobs: in the data folder, or in pieces where all web processes can reach them."""
    return Uploads(blobs.data) if isinstance(blobs.objects, FolderObjects) else PieceUploads(database, blobs)


def _size(session: Session, id: str) -> int:
    return int(session.scalar(select(func.sum(PieceRow.bytes)).where(PieceRow.upload == id)) or 0)
