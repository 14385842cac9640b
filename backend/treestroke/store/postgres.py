"""Postgres: a server that many machines share. Its driver is imported where a connection is made, not before."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import Connection, Engine, NullPool, create_engine, func, make_url, select, text
from sqlalchemy.engine.interfaces import IsolationLevel

from treestroke.store.data_folder import DataFolderError, check_revisions
from treestroke.store.revisions import revisions_of

_CONNECTIONS = 10
"""Connections of one process."""
_CONNECT_SECONDS = 2
"""Time to connect: then the database counts as away. It is the least that libpq knows."""
_POOL_SECONDS = 1.5
"""Time to wait for a connection that others use: then the database counts as busy."""
_LIMITS = {
    "statement_timeout": "20s",
    "lock_timeout": "5s",
    "idle_in_transaction_session_timeout": "10s",
}
"""What the server ends: the transaction of a process that was stopped must not keep others from its rows."""
_MIGRATION_LIMITS = {"statement_timeout": "0", "lock_timeout": "60s"}
_COPYING_LIMITS = {"statement_timeout": "0", "idle_in_transaction_session_timeout": "10min"}
"""Limits of a transaction that copies all rows to a disk, which may be slow. It locks none."""
_NETWORK = {"keepalives_idle": 5, "keepalives_interval": 2, "keepalives_count": 3, "tcp_user_timeout": 10_000}
"""How soon a server whose machine or network is gone is noticed."""
_APPEND_ONLY = "audit"
"""The table whose rows nobody but the owner changes or removes."""
_MIGRATING = 0x7472_6565
"""Number of the advisory lock that whoever migrates holds."""
_HOLDING = 0x7472_6566
"""Number of the advisory lock that whoever holds the blobs shares."""


_MAY_MIGRATE = """
    SELECT coalesce(
        (SELECT pg_has_role(tableowner, 'USAGE') FROM pg_tables
         WHERE schemaname = current_schema() AND tablename = 'alembic_version'),
        has_schema_privilege(current_schema(), 'CREATE'))
"""
_GRANTS = (
    "GRANT USAGE ON SCHEMA {schema} TO {user}",
    "GRANT SELECT, INSERT, UPDATE, DELETE ON ALL TABLES IN SCHEMA {schema} TO {user}",
    "GRANT USAGE ON ALL SEQUENCES IN SCHEMA {schema} TO {user}",
    f"REVOKE UPDATE, DELETE ON {{schema}}.{_APPEND_ONLY}, {{schema}}.alembic_version FROM {{user}}",
    "REVOKE INSERT ON {schema}.alembic_version FROM {user}",
)


class Postgres:
    """Postgres by psycopg: writers of different rows do not wait for each other.

    A transaction that writes is READ COMMITTED, so a change of a row that others change too is one statement, or
    locks the row first. One that reads sees a snapshot. A connection that was lost is replaced before it is used.
    """

    def __init__(self, folder: Path, url: str, owner_url: str = "") -> None:
        self._folder, self._owner_url = folder, owner_url or url
        self._granting = bool(owner_url)
        self.place = make_url(url).render_as_string(hide_password=True)
        self.mend = "start Postgres, or correct TREESTROKE_DATABASE_URL"
        self._engine = _engine(url, _LIMITS, pool=True)

    def exists(self) -> bool:
        """Tell whether there may be tables: whoever made the database made it before."""
        return True

    def check(self) -> None:
        """Check that this program can use the tables, if there are any; see `check_revisions`."""
        with self.reading() as connection:
            found = revisions_of(connection)
        check_revisions(found, self._folder, self.place, "name another database by TREESTROKE_DATABASE_URL")

    def fault(self) -> str:
        """Return what is wrong with the server; nothing where it may be written to."""
        with self.reading() as connection:
            standby = connection.execute(text("SELECT pg_is_in_recovery()")).scalar()
        return "a standby, which accepts no changes" if standby else ""

    @contextmanager
    def reading(self) -> Iterator[Connection]:
        """Open a connection whose transaction reads one snapshot."""
        with self._connect("REPEATABLE READ", postgresql_readonly=True) as connection:
            yield connection

    @contextmanager
    def writing(self) -> Iterator[Connection]:
        """Open a connection whose statements each see what is committed by then."""
        with self._connect("READ COMMITTED") as connection:
            yield connection

    @contextmanager
    def autocommitting(self) -> Iterator[Connection]:
        """Open a connection on which each statement is a transaction of its own."""
        with self._connect("AUTOCOMMIT") as connection:
            yield connection

    def may_migrate(self) -> bool:
        """Tell whether tables can be made and changed: by their owner, or as one who may make tables."""
        if self._granting:
            return True
        with self.reading() as connection:
            return bool(connection.execute(text(_MAY_MIGRATE)).scalar())

    @contextmanager
    def migrating(self) -> Iterator[Connection]:
        """Open a connection in one transaction while no other process migrates.

        It is the tables' owner's, where there is one of their own. Then the service's user gets in the same transaction
        what it may.
        """
        engine = _engine(self._owner_url, _MIGRATION_LIMITS, pool=False)
        with engine.connect() as connection, connection.begin():
            connection.execute(text("SELECT pg_advisory_xact_lock(:number)"), {"number": _MIGRATING})
            yield connection
            if self._granting:
                self._grant(connection)

    def _grant(self, owner: Connection) -> None:
        """Let the service's user read and write all rows, but of the audit only read and add some."""
        who = text("SELECT quote_ident(current_user::text), quote_ident(current_schema()::text)")
        with self.reading() as connection:
            user, schema = connection.execute(who).one()
        if owner.execute(who).one()[0] == user:
            raise DataFolderError(
                f"TREESTROKE_OWNER_DATABASE_URL: {user} is the service's own user; name another, who owns the tables"
            )
        for statement in _GRANTS:
            owner.execute(text(statement.format(user=user, schema=schema)))

    @contextmanager
    def copying(self) -> Iterator[Connection]:
        """Open a connection that reads one snapshot for as long as that takes."""
        with self.reading() as connection:
            for name, value in _COPYING_LIMITS.items():
                connection.exec_driver_sql(f"SET LOCAL {name} = '{value}'")
            yield connection

    @contextmanager
    def hold(self) -> Iterator[None]:
        """Have `held` tell so meanwhile, in all processes; it ends with this connection."""
        with self.autocommitting() as connection:
            connection.execute(select(func.pg_advisory_lock_shared(_HOLDING)))
            try:
                yield
            finally:
                connection.invalidate()  # by which the server unlocks, whatever became of the connection

    def held(self) -> bool:
        """Tell whether somebody holds the blobs."""
        with self.reading() as connection:
            return not connection.scalar(select(func.pg_try_advisory_xact_lock(_HOLDING)))

    def close(self) -> None:
        """Close all connections."""
        self._engine.dispose()

    @contextmanager
    def _connect(self, isolation: IsolationLevel, **options: bool) -> Iterator[Connection]:
        with self._engine.connect().execution_options(isolation_level=isolation, **options) as connection:
            yield connection


def _engine(url: str, limits: dict[str, str], pool: bool) -> Engine:
    pooled = {"pool_size": _CONNECTIONS, "max_overflow": 0, "pool_timeout": _POOL_SECONDS, "pool_pre_ping": True}
    return create_engine(
        make_url(url).set(drivername="postgresql+psycopg"),
        connect_args={
            "connect_timeout": _CONNECT_SECONDS,
            "fallback_application_name": "treestroke",
            "options": " ".join(f"-c {name}={value}" for name, value in limits.items()),
            **_NETWORK,
        },
        **(pooled if pool else {"poolclass": NullPool}),
    )
