"""SQLite: a file in the data folder, for one machine."""

import fcntl
import os
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

from sqlalchemy import URL, Connection, Engine, create_engine, event
from sqlalchemy.exc import OperationalError

from treestroke.store.data_folder import BLOBS, DATABASE, check_version

_WRITE, _AUTOCOMMIT = "treestroke_write", "treestroke_autocommit"
"""Execution options of connections: a transaction that writes, or one for each statement."""
_BUSY_SECONDS = 10
"""Time that a writer waits for another."""
_MIGRATION_SECONDS = 60
"""Time that whoever migrates waits for another who does: that takes longer than writing."""
_READERS = 10
"""Connections in the pool for reading; each has two files open."""


class Sqlite:
    """SQLite in WAL mode: many readers and one writer, from several processes.

    A committed change survives a power cut. Only migrating creates the file. If the file is removed or replaced,
    nothing more is read or written until the database is closed: changes to the old file would be lost.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / DATABASE
        self.place = str(self._path)
        self.mend = f"stop the service and restore {self._path} from a copy"
        url = URL.create("sqlite", database=self._path.absolute().as_uri(), query={"mode": "rw", "uri": "true"})
        self._readers, self._writer = _engine(url, _READERS), _engine(url, 1)
        self._write_lock = threading.Lock()
        self._opened: list[tuple[int, int]] = []

    def exists(self) -> bool:
        """Tell whether the file is there."""
        return self._path.exists()

    def check(self) -> None:
        """Check that this program can use the file; see `check_version`."""
        check_version(self._path.parent)

    def fault(self) -> str:
        """Return what is wrong with the file; nothing where it is sound."""
        with self.reading() as connection:
            result = str(connection.exec_driver_sql("PRAGMA quick_check(1)").scalar())
        return "" if result == "ok" else " ".join(result.split())

    @contextmanager
    def reading(self) -> Iterator[Connection]:
        """Open a connection whose transaction reads one snapshot."""
        self._check_file()
        with self._readers.connect() as connection:
            yield connection

    @contextmanager
    def writing(self) -> Iterator[Connection]:
        """Open a connection whose transaction is the only one that writes from its first statement on.

        Raises
        ------
        OperationalError
            Other writers took longer than a writer waits, or the file was removed or replaced.
        """
        with self._write_by(_WRITE) as connection:
            yield connection

    @contextmanager
    def autocommitting(self) -> Iterator[Connection]:
        """Open a connection on which each statement is a transaction of its own.

        The lock that all writers share is then held only while SQLite runs a statement. Otherwise a process that is
        stopped between two statements, or waits for Python's global lock, would keep all others from writing.
        """
        with self._write_by(_AUTOCOMMIT) as connection:
            yield connection

    def may_migrate(self) -> bool:
        """Tell whether tables can be made and changed: whoever may write the file may."""
        return True

    @contextmanager
    def migrating(self) -> Iterator[Connection]:
        """Open a connection in one transaction, which creates the file.

        Foreign keys are not enforced meanwhile: a table that changes is dropped and created again, and the rows that
        refer to it must stay.
        """
        engine = _engine(URL.create("sqlite", database=str(self._path)), 1, migrates=True)
        try:
            with engine.connect().execution_options(**{_WRITE: True}) as connection, connection.begin():
                yield connection
        finally:
            engine.dispose()

    def copying(self) -> AbstractContextManager[Connection]:
        """Open a connection that reads one snapshot for as long as that takes."""
        return self.reading()

    @contextmanager
    def hold(self) -> Iterator[None]:
        """Have `held` tell so meanwhile, in this process and in others."""
        with self._locking(fcntl.LOCK_SH):
            yield

    def held(self) -> bool:
        """Tell whether somebody holds the blobs."""
        try:
            with self._locking(fcntl.LOCK_EX | fcntl.LOCK_NB):
                return False
        except BlockingIOError:
            return True

    @contextmanager
    def _locking(self, kind: int) -> Iterator[None]:
        """Lock the folder of the blobs, which ends with this process: the data folder itself is the launcher's."""
        folder = self._path.parent / BLOBS
        folder.mkdir(mode=0o700, exist_ok=True)
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            fcntl.flock(descriptor, kind)
            yield
        finally:
            os.close(descriptor)

    def close(self) -> None:
        """Close all connections."""
        self._readers.dispose()
        self._writer.dispose()
        self._opened.clear()

    @contextmanager
    def _write_by(self, option: str) -> Iterator[Connection]:
        """Open the one connection that writes; waiting for it occupies no connection for reading."""
        if not self._write_lock.acquire(timeout=_BUSY_SECONDS):
            raise OperationalError("BEGIN IMMEDIATE", None, sqlite3.OperationalError("database is locked"))
        try:
            self._check_file()
            with self._writer.connect().execution_options(**{option: True}) as connection:
                yield connection
        finally:
            self._write_lock.release()

    def _check_file(self) -> None:
        """Raise if the file is not the one that was opened first."""
        found = _identity(self._path)
        if found is not None and not self._opened:
            self._opened.append(found)
        if [found] != self._opened:
            error = sqlite3.OperationalError("the database file was removed or replaced")
            error.sqlite_errorcode = sqlite3.SQLITE_CANTOPEN
            raise OperationalError("open", None, error)


def _identity(path: Path) -> tuple[int, int] | None:
    """Return a file's device and inode, which identify it whatever its path; None without a file."""
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    return found.st_dev, found.st_ino


def _engine(url: URL, connections: int, migrates: bool = False) -> Engine:
    busy_s, foreign_keys = (_MIGRATION_SECONDS, "OFF") if migrates else (_BUSY_SECONDS, "ON")
    engine = create_engine(
        url,
        pool_size=connections,
        max_overflow=0,
        connect_args={"timeout": busy_s, "check_same_thread": False},
    )

    @event.listens_for(engine, "connect")
    def _prepare(connection: Any, _: object) -> None:
        connection.isolation_level = None  # transactions begin in `_begin` below, not implicitly in the driver
        for pragma in ("journal_mode=WAL", "synchronous=FULL", f"foreign_keys={foreign_keys}"):
            connection.execute(f"PRAGMA {pragma}")

    @event.listens_for(engine, "begin")
    def _begin(connection: Connection) -> None:
        options = connection.get_execution_options()
        if not options.get(_AUTOCOMMIT, False):
            connection.exec_driver_sql("BEGIN IMMEDIATE" if options.get(_WRITE, False) else "BEGIN")

    return engine
