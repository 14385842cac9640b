"""The database: opened, migrated, and used in short transactions."""

import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import URL, Connection, Engine, create_engine, event
from sqlalchemy.exc import OperationalError
from sqlalchemy.orm import Session

from treestroke.store.data_folder import DATABASE

_WRITES, _STATES = "treestroke_writes", "treestroke_states"
_BUSY_SECONDS = 10
"""How long a writer waits for another."""
_READERS = 10
"""Connections that are kept for reading: each has two files open."""


class Database:
    """SQLite in WAL mode: many readers beside one writer, from several processes.

    A committed change survives a power cut: what was accepted is never lost. Only `migrate` makes the file; once it is
    gone from its place, or another is there, nothing more is read or written until the database is closed: what went to
    the old file would be lost.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / DATABASE
        there = URL.create("sqlite", database=self.path.absolute().as_uri(), query={"mode": "rw", "uri": "true"})
        self._readers, self._writer = _engine(there, _READERS), _engine(there, 1)
        self._turn = threading.Lock()
        self._opened: tuple[int, int] | None = None

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """Open a session that sees one state of the database and changes nothing."""
        self._look_at_file()
        with Session(self._readers, expire_on_commit=False) as session:
            yield session

    @contextmanager
    def writing(self) -> Iterator[Session]:
        """Open a session that is the only writer from its first statement on, and commit it at the end.

        Raises
        ------
        OperationalError
            Others write for longer than a writer waits, or the file is gone.
        """
        with self._write_by(_WRITES) as session, session.begin():
            yield session

    @contextmanager
    def stating(self) -> Iterator[Session]:
        """Open a session in which each statement is a transaction of its own.

        The one lock that all writers share is then held inside SQLite alone. A process that stands still, or that is
        busy in a library with Python's lock held, would keep everybody else from writing between two statements.
        """
        with self._write_by(_STATES) as session:
            yield session

    @contextmanager
    def _write_by(self, option: str) -> Iterator[Session]:
        """Open a session on the one connection that writes; who waits for it holds none that others could read by."""
        if not self._turn.acquire(timeout=_BUSY_SECONDS):
            raise OperationalError("BEGIN IMMEDIATE", None, sqlite3.OperationalError("database is locked"))
        try:
            self._look_at_file()
            with (
                self._writer.connect().execution_options(**{option: True}) as connection,
                Session(connection, expire_on_commit=False) as session,
            ):
                yield session
        finally:
            self._turn.release()

    def _look_at_file(self) -> None:
        """Refuse a file that is not the one which was opened first."""
        found = _identity(self.path)
        self._opened = self._opened or found
        if found is None or found != self._opened:
            error = sqlite3.OperationalError("the database file was removed or replaced")
            error.sqlite_errorcode = sqlite3.SQLITE_CANTOPEN
            raise OperationalError("open", None, error)

    def migrate(self) -> None:
        """Bring the tables to the newest form, from nothing or from any older one.

        A table that is made anew is dropped for a moment: rows that refer to its rows must not go with them.
        """
        engine = _engine(URL.create("sqlite", database=str(self.path)), 1, foreign_keys=False)
        try:
            with engine.connect().execution_options(**{_WRITES: True}) as connection:
                settings = _migrations()
                settings.attributes["connection"] = connection
                command.upgrade(settings, "head")
        finally:
            engine.dispose()

    def current(self) -> bool:
        """Tell whether the tables have the form that this program knows."""
        with self._readers.connect() as connection:
            found = MigrationContext.configure(connection).get_current_revision()
        return found == ScriptDirectory.from_config(_migrations()).get_current_head()

    def close(self) -> None:
        """Close all connections."""
        self._readers.dispose()
        self._writer.dispose()
        self._opened = None


def _migrations() -> Config:
    settings = Config()
    settings.set_main_option("script_location", "treestroke.store:migrations")
    return settings


def _identity(path: Path) -> tuple[int, int] | None:
    """Tell one file from another that takes its place."""
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    return found.st_dev, found.st_ino


def _engine(place: URL, connections: int, foreign_keys: bool = True) -> Engine:
    engine = create_engine(
        place,
        pool_size=connections,
        max_overflow=0,
        connect_args={"timeout": _BUSY_SECONDS, "check_same_thread": False},
    )

    @event.listens_for(engine, "connect")
    def _prepare(connection: Any, _: object) -> None:
        connection.isolation_level = None  # transactions begin below, not by the driver's guess
        for pragma in ("journal_mode=WAL", "synchronous=FULL", f"foreign_keys={'ON' if foreign_keys else 'OFF'}"):
            connection.execute(f"PRAGMA {pragma}")

    @event.listens_for(engine, "begin")
    def _begin(connection: Connection) -> None:
        options = connection.get_execution_options()
        if not options.get(_STATES, False):
            connection.exec_driver_sql("BEGIN IMMEDIATE" if options.get(_WRITES, False) else "BEGIN")

    return engine
