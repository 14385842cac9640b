"""Blobs: immutable files of teams, named by the SHA-256 of their content, so that equal content is stored once a team.

The table of blobs is the truth. A row is written before its object; removal deletes rows, and then their objects,
before it commits. So whoever stores a blob that is being removed waits, and stores it anew. A process that dies leaves
at most a row without an object, which the next one to store it writes, or an object without a row, which a sweep finds.
"""

import copy
import hashlib
import secrets
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Self

from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from treestroke.store.bucket import BucketObjects
from treestroke.store.copies import Copies
from treestroke.store.database import Database
from treestroke.store.objects import Damaged, FolderObjects, Objects, Verified, read_blob
from treestroke.store.scope import Foreign, Scope
from treestroke.store.tables import BlobRow

_INSERTS: dict[str, Any] = {"sqlite": sqlite.insert, "postgresql": postgresql.insert}


class Blobs:
    """The blobs of one team: rows of the database, and objects; each is seen by its team alone (`of`).

    Attributes
    ----------
    objects
        Where the contents are.
    data
        The data folder of this machine.
    """

    def __init__(self, database: Database, objects: Objects, data: Path) -> None:
        self.objects, self.data = objects, data
        self._database, self._verified = database, Verified()
        self._team: str | None = None

    def of(self, scope: Scope) -> Self:
        """Return the same for the blobs of a scope's team."""
        view = copy.copy(self)
        view._database, view._team = self._database.of(scope), scope.team
        return view

    def put(self, content: bytes) -> str:
        """Store bytes and return their SHA-256; from then on they survive a power cut.

        They are written even if the blob exists: that repairs a damaged object.

        Raises
        ------
        OSError
            There is no room, or the place of the objects is away.
        """
        sha256 = hashlib.sha256(content).hexdigest()
        self._note(sha256, len(content))
        self.objects.put(self._owner, sha256, content)
        return sha256

    def take(self, path: Path, sha256: str) -> None:
        """Store a file that is on disk, in the data folder, with this SHA-256; it is gone from there afterwards.

        Raises
        ------
        OSError
            There is no room, or the place of the objects is away.
        """
        self._note(sha256, path.stat().st_size)
        self.objects.take(self._owner, sha256, path)

    def path(self, sha256: str) -> Path:
        """Return the path of a blob on this machine, whose content is still to be verified.

        Raises
        ------
        Damaged
            The blob is missing; where it was at hand already, only reading it tells.
        OSError
            The place of the objects is away.
        """
        return self.objects.local(self._owner, sha256)

    def get(self, sha256: str) -> bytes:
        """Return a blob's content.

        Raises
        ------
        Damaged
            The blob is missing, cannot be read, or has another SHA-256.
        OSError
            The place of the objects is away.
        """
        try:
            return read_blob(self.path(sha256))
        except Damaged:
            return read_blob(self.objects.local(self._owner, sha256, again=True))

    def check(self, sha256: str) -> Path:
        """Return a blob's path on this machine after verifying its content, which is read again only if it changed.

        Raises
        ------
        Damaged
            The blob is missing, cannot be read, or has another SHA-256.
        OSError
            The place of the objects is away.
        """
        try:
            return self._verified.check(self.path(sha256))
        except Damaged:
            return self._verified.check(self.objects.local(self._owner, sha256, again=True))

    def verify(self, sha256: str) -> None:
        """Read a blob where it is kept and compare it with its name, however often that was done before.

        Raises
        ------
        Damaged
            The blob is missing, cannot be read, or has another SHA-256.
        OSError
            The place of the objects is away.
        """
        self.objects.verify(self._owner, sha256)

    @contextmanager
    def temporary(self) -> Iterator[Path]:
        """Yield a path in the data folder for a file that is to become a blob; nothing is left there."""
        folder = self.data / "tmp"
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        path = folder / secrets.token_hex(8)
        try:
            yield path
        finally:
            path.unlink(missing_ok=True)

    @property
    def _owner(self) -> str:
        if self._team is None:
            raise Foreign("a blob belongs to a team: blobs.of(scope)")
        return self._team

    def _note(self, sha256: str, size: int) -> None:
        """Write the row of a blob; where it exists, note that it is wanted, so that no sweep removes it now."""
        with self._database.autocommitting() as session:
            row = insert_blobs(session, [_values(self._owner, sha256, size)])
            wanted = {"seen": None, "bytes": size}
            session.execute(row.on_conflict_do_update(index_elements=["team", "sha256"], set_=wanted))


def open_blobs(database: Database, data: Path, bucket_url: str = "", patience_s: float = 0.0) -> Blobs:
    """Return the blobs of the service: in the data folder, or in a bucket, with as much patience while that is away.

    A process that forks opens them afterwards.
    """
    if not bucket_url:
        return Blobs(database, FolderObjects(data), data)
    return Blobs(database, BucketObjects(bucket_url, Copies(data), patience_s), data)


def insert_blobs(session: Session, rows: Sequence[dict[str, Any]]) -> Any:
    """Return a statement that inserts rows of blobs, which goes on with ``on_conflict_...``."""
    return _INSERTS[session.get_bind().dialect.name](BlobRow.__table__).values(rows)


def _values(team: str, sha256: str, size: int) -> dict[str, Any]:
    return {"team": team, "sha256": sha256, "bytes": size, "created": time.time(), "seen": None}
