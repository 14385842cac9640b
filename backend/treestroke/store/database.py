"""The database: migrating it, and short transactions, whether it is SQLite or Postgres."""

import copy
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, Self

from sqlalchemy import Connection, inspect
from sqlalchemy.orm import Session

from treestroke.store.data_folder import DATABASE, DataFolderError, known_revisions
from treestroke.store.postgres import Postgres
from treestroke.store.revisions import revisions_of
from treestroke.store.scope import Scope, ScopedSession, scoped
from treestroke.store.sqlite import Sqlite

if TYPE_CHECKING:
    from alembic.config import Config


class _Form(Protocol):
    """One kind of database: where it is, how it is mended where it fails, and its connections."""

    place: str
    mend: str

    def check(self) -> None: ...
    def fault(self) -> str: ...
    def exists(self) -> bool: ...
    def reading(self) -> AbstractContextManager[Connection]: ...
    def writing(self) -> AbstractContextManager[Connection]: ...
    def autocommitting(self) -> AbstractContextManager[Connection]: ...
    def may_migrate(self) -> bool: ...
    def migrating(self) -> AbstractContextManager[Connection]: ...
    def copying(self) -> AbstractContextManager[Connection]: ...
    def hold(self) -> AbstractContextManager[None]: ...
    def held(self) -> bool: ...
    def close(self) -> None: ...


class Database:
    """A Postgres by its URL; without one, SQLite in the data folder. Each session has a scope (`of`).

    Tables are made and migrated by ``owner_url``, where their owner is another user than the service's.
    """

    def __init__(self, folder: Path, url: str = "", owner_url: str = "") -> None:
        self.path = folder / DATABASE
        self.url = url
        self._form: _Form = Postgres(folder, url, owner_url) if url else Sqlite(folder)
        self._scope: Scope | None = None

    def of(self, scope: Scope) -> Self:
        """Return the same database, by the same connections, for sessions with a scope: without one there are none."""
        view = copy.copy(self)
        view._scope = scope
        return view

    @property
    def place(self) -> str:
        """Where the database is, without a password."""
        return self._form.place

    @property
    def mend(self) -> str:
        """How whoever runs the service mends a database that fails."""
        return self._form.mend

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """Open a session that reads one snapshot of the database and changes nothing."""
        with self._session(self._form.reading()) as session:
            yield session

    @contextmanager
    def writing(self) -> Iterator[Session]:
        """Open a session in a transaction, and commit it at the end.

        On SQLite it is the only writer from its first statement on. On Postgres others write meanwhile: what is read
        and then changed is locked by the reading statement.

        Raises
        ------
        OperationalError
            Other writers took longer than a writer waits, or the database is away.
        """
        with self._session(self._form.writing()) as session, session.begin():
            yield session

    @contextmanager
    def autocommitting(self) -> Iterator[Session]:
        """Open a session in which each statement is a transaction of its own."""
        with self._session(self._form.autocommitting()) as session:
            yield session

    def within(self, connection: Connection) -> AbstractContextManager[Session]:
        """Open a session in the transaction of a connection, by which alone its changes are committed."""
        return self._session(nullcontext(connection))

    @contextmanager
    def _session(self, opened: AbstractContextManager[Connection]) -> Iterator[Session]:
        info = scoped(self._scope)
        with opened as connection, ScopedSession(connection, expire_on_commit=False, info=info) as session:
            yield session

    def migrate(self, again: bool = False) -> None:
        """Create the tables, or migrate them from any older revision, in one transaction.

        With ``again`` also grant anew what the service's user may.

        Raises
        ------
        DataFolderError
            They belong to another user.
        """
        if self.current() and not again:
            return
        self.check_owner()
        with self.migrating() as connection:
            upgrade(connection)

    def migrating(self) -> AbstractContextManager[Connection]:
        """Open a connection in one transaction that changes the tables, while no other process does (`upgrade`)."""
        import alembic.command  # noqa: F401 - takes long, so it is imported before the others have to wait

        return self._form.migrating()

    def check_owner(self) -> None:
        """Check that tables which are not up to date can be brought up to date.

        Raises
        ------
        DataFolderError
            They belong to another user.
        """
        if not self.current() and not self._form.may_migrate():
            raise DataFolderError(
                f"{self.place}: its tables are not up to date and belong to another user; run `treestroke migrate` "
                "with TREESTROKE_OWNER_DATABASE_URL"
            )

    def current(self) -> bool:
        """Tell whether the tables have the revision that this program needs."""
        if not self.exists():
            return False
        with self._form.reading() as connection:
            return revisions_of(connection) == {max(known_revisions())}

    def exists(self) -> bool:
        """Tell whether there may be tables: SQLite's file is there, or a Postgres was named."""
        return self._form.exists()

    def empty(self) -> bool:
        """Tell whether there are no tables, of whatever program."""
        if not self.exists():
            return True
        with self._form.reading() as connection:
            return not inspect(connection).get_table_names()

    def copying(self) -> AbstractContextManager[Connection]:
        """Open a connection to all rows that reads one snapshot for as long as that takes."""
        return self._form.copying()

    def hold(self) -> AbstractContextManager[None]:
        """Keep the sweeps of all processes from removing blobs meanwhile; several may do so at once."""
        return self._form.hold()

    def held(self) -> bool:
        """Tell whether somebody keeps sweeps from removing blobs."""
        return self._form.held()

    def check(self) -> None:
        """Check that this program can use the database; one without tables and files is new.

        Raises
        ------
        DataFolderError
            The database is lost, cannot be read, or was made by a newer program.
        OperationalError
            Postgres is away.
        """
        self._form.check()

    def fault(self) -> str:
        """Return what is wrong with the database itself, for whoever mends it; nothing where it is sound."""
        return self._form.fault()

    def close(self) -> None:
        """Close all connections."""
        self._form.close()


def upgrade(connection: Connection, revision: str = "head") -> None:
    """Create the tables as they were at a revision, or migrate them to it, in the connection's transaction.

    Alembic, which takes long to import, is imported only where there is something to do.
    """
    from alembic import command

    settings = _migrations()
    settings.attributes["connection"] = connection
    command.upgrade(settings, revision)


def _migrations() -> "Config":
    from alembic.config import Config

    settings = Config()
    settings.set_main_option("script_location", "treestroke.store:migrations")
    return settings
