"""The database: opening it, migrating it, and short transactions."""

import copy
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from sqlalchemy import URL, Connection, Engine, create_engine, event, inspect
from sqlalchemy.exc import OperationalError
from sqlalchemy.orm import Session

from treestroke.store.data_folder import DATABASE, known_revisions
from treestroke.store.scope import Scope, ScopedSession, scoped

if TYPE_CHECKING:
    from alembic.config import Config

_WRITE, _AUTOCOMMIT = "treestroke_write", "treestroke_autocommit"
"""Execution options of connections: a transaction that writes, or one for each statement."""
_BUSY_SECONDS = 10
"""Time that a writer waits for another."""
_READERS = 10
"""Connections in the pool for reading; each has two files open."""


class Database:
    """SQLite in WAL mode: many readers and one writer, from several processes.

    Each session has a scope (`of`). A committed change survives a power cut. Only `migrate` creates the file. If the
    file is removed or replaced, nothing more is read or written until the database is closed: changes to the old file
    would be lost.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / DATABASE
        url = URL.create("sqlite", database=self.path.absolute().as_uri(), query={"mode": "rw", "uri": "true"})
        self._readers, self._writer = _engine(url, _READERS), _engine(url, 1)
        self._write_lock = threading.Lock()
        self._opened: list[tuple[int, int]] = []
        self._scope: Scope | None = None

    def of(self, scope: Scope) -> Self:
        """Return the same database, by the same connections, for sessions with a scope: without one there are none."""
        view = copy.copy(self)
        view._scope = scope
        return view

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """Open a session that reads one snapshot of the database and changes nothing."""
        self._check_file()
        with ScopedSession(self._readers, expire_on_commit=False, info=scoped(self._scope)) as session:
            yield session

    @contextmanager
    def writing(self) -> Iterator[Session]:
        """Open a session that is the only writer from its first statement on, and commit it at the end.

        Raises
        ------
        OperationalError
            Other writers took longer than a writer waits, or the file was removed or replaced.
        """
        with self._write_by(_WRITE) as session, session.begin():
            yield session

    @contextmanager
    def autocommitting(self) -> Iterator[Session]:
        """Open a session in which each statement is a transaction of its own.

        The lock that all writers share is then held only while SQLite runs a statement. Otherwise a process that is
        stopped between two statements, or waits for Python's global lock, would keep all others from writing.
        """
        with self._write_by(_AUTOCOMMIT) as session:
            yield session

    @contextmanager
    def _write_by(self, option: str) -> Iterator[Session]:
        """Open a session on the one connection that writes; waiting for it occupies no connection for reading."""
        if not self._write_lock.acquire(timeout=_BUSY_SECONDS):
            raise OperationalError("BEGIN IMMEDIATE", None, sqlite3.OperationalError("database is locked"))
        try:
            self._check_file()
            with (
                self._writer.connect().execution_options(**{option: True}) as connection,
                ScopedSession(connection, expire_on_commit=False, info=scoped(self._scope)) as session,
            ):
                yield session
        finally:
            self._write_lock.release()

    def _check_file(self) -> None:
        """Raise if the file is not the one that was opened first."""
        found = _identity(self.path)
        if found is not None and not self._opened:
            self._opened.append(found)
        if [found] != self._opened:
            error = sqlite3.OperationalError("the database file was removed or replaced")
            error.sqlite_errorcode = sqlite3.SQLITE_CANTOPEN
            raise OperationalError("open", None, error)

    def migrate(self) -> None:
        """Create the tables, or migrate them from any older revision, in one transaction.

        Foreign keys are not enforced meanwhile: a table that changes is dropped and created again, and the rows that
        refer to it must stay. Alembic, which takes long to import, is imported only where there is something to do.
        """
        if self.path.exists() and self.current():
            return
        from alembic import command

        engine = _engine(URL.create("sqlite", database=str(self.path)), 1, foreign_keys=False)
        try:
            with engine.connect().execution_options(**{_WRITE: True}) as connection, connection.begin():
                settings = _migrations()
                settings.attributes["connection"] = connection
                command.upgrade(settings, "head")
        finally:
            engine.dispose()

    def current(self) -> bool:
        """Tell whether the tables have the revision that this program needs."""
        with self._readers.connect() as connection:
            if not inspect(connection).has_table("alembic_version"):
                return False
            found = connection.exec_driver_sql("SELECT version_num FROM alembic_version").scalars().all()
        return found == [max(known_revisions())]

    def close(self) -> None:
        """Close all connections."""
        self._readers.dispose()
        self._writer.dispose()
        self._opened.clear()


def _migrations() -> "Config":
    from alembic.config import Config

    settings = Config()
    settings.set_main_option("script_location", "treestroke.store:migrations")
    return settings


def _identity(path: Path) -> tuple[int, int] | None:
    """Return a file's device and inode, which identify it whatever its path; None without a file."""
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    return found.st_dev, found.st_ino


def _engine(url: URL, connections: int, foreign_keys: bool = True) -> Engine:
    engine = create_engine(
        url,
        pool_size=connections,
        max_overflow=0,
        connect_args={"timeout": _BUSY_SECONDS, "check_same_thread": False},
    )

    @event.listens_for(engine, "connect")
    def _prepare(connection: Any, _: object) -> None:
        connection.isolation_level = None  # transactions begin in `_begin` below, not implicitly in the driver
        for pragma in ("journal_mode=WAL", "synchronous=FULL", f"foreign_keys={'ON' if foreign_keys else 'OFF'}"):
            connection.execute(f"PRAGMA {pragma}")

    @event.listens_for(engine, "begin")
    def _begin(connection: Connection) -> None:
        options = connection.get_execution_options()
        if not options.get(_AUTOCOMMIT, False):
            connection.exec_driver_sql("BEGIN IMMEDIATE" if options.get(_WRITE, False) else "BEGIN")

    return engine
