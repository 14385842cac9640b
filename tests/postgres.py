"""A Postgres of the tests' own: one server for each process of the tests, with a fresh database for whoever asks."""

import os
import shutil
import signal
import socket
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path

import psycopg
import pytest
from psycopg import sql
from tests.faults.processes import processes, wait_for

from treestroke.store.database import Database

KINDS = ("sqlite", "postgres")
"""Kinds of databases, for fixtures called ``database_kind``."""
SQLITE_ONLY = pytest.mark.parametrize("database_kind", ["sqlite"])
"""For tests of what is SQLite's own; each says why."""
_NUMBERS = count(1)
_MIGRATED = "migrated"
"""A database with the tables, which is copied; making them takes longer."""


class PostgresServer:
    """`postgres` on a port of 127.0.0.1, with a folder of its own; it can be stopped, killed and started again.

    Postgres refuses to run as root, so root runs it as the user that Debian's package makes. It ends with the process
    of the tests, however that ends.
    """

    def __init__(self, folder: Path, *options: str) -> None:
        self._folder, self._options = folder, options
        with socket.create_server(("127.0.0.1", 0)) as listener:
            self.port = listener.getsockname()[1]
        self._process: subprocess.Popen[bytes] | None = None
        folder.mkdir()
        if os.geteuid() == 0:
            shutil.chown(folder, "postgres")
        subprocess.run(
            self._command("initdb", "--auth=trust", "--username=postgres", "--no-sync", "--locale=C.UTF-8"),
            stdout=subprocess.DEVNULL,
            check=True,
        )
        self.start()

    def url(self, database: str = "postgres") -> str:
        return f"postgresql:{'//'}postgres@127.0.0.1:{self.port}/{database}"

    def start(self) -> None:
        """Start the server and wait until it answers."""
        settings = ("fsync=off", "max_connections=120", "unix_socket_directories=", *self._options)
        self._process = subprocess.Popen(
            self._command("postgres", "-p", str(self.port), *(part for each in settings for part in ("-c", each))),
            stderr=subprocess.DEVNULL,
        )
        wait_for(self._answers, 30, "an answer from Postgres")

    def stop(self) -> None:
        """Stop the server; whoever is connected is cut off, and everything that was committed is kept."""
        if self._process is not None:
            subprocess.run(self._command("pg_ctl", "stop", "--mode=fast"), stdout=subprocess.DEVNULL, check=True)
            self._process.wait()
            self._process = None

    def crash(self) -> None:
        """End the server at once, as a power cut does; it recovers when it is started again."""
        if self._process is not None:
            subprocess.run(self._command("pg_ctl", "stop", "--mode=immediate"), stdout=subprocess.DEVNULL, check=True)
            self._process.wait()
            self._process = None

    def freeze(self) -> None:
        """Stop all of its processes where they stand."""
        self._signal(signal.SIGSTOP)

    def thaw(self) -> None:
        """Let them go on."""
        self._signal(signal.SIGCONT)

    def fresh(self, like: str = "template1") -> str:
        """Make a database like another and return its URL."""
        name = f"test_{next(_NUMBERS)}"
        self.execute(sql.SQL("CREATE DATABASE {} TEMPLATE {}").format(sql.Identifier(name), sql.Identifier(like)))
        return self.url(name)

    def fresh_with_tables(self) -> str:
        """Make a database with all tables and return its URL."""
        if not self.execute(sql.SQL("SELECT 1 FROM pg_database WHERE datname = {}").format(_MIGRATED)):
            self.execute(sql.SQL("CREATE DATABASE {}").format(sql.Identifier(_MIGRATED)))
            database = Database(self._folder, self.url(_MIGRATED))
            database.migrate()
            database.close()
        return self.fresh(_MIGRATED)

    def execute(self, statement: sql.SQL | sql.Composed, url: str = "") -> int:
        """Run a statement by itself and return how many rows it concerned."""
        with psycopg.connect(url or self.url(), autocommit=True) as connection:
            return connection.execute(statement).rowcount

    def _command(self, program: str, *arguments: str) -> list[str]:
        user = ["--reuid=postgres", "--regid=postgres", "--clear-groups"] if os.geteuid() == 0 else []
        return ["setpriv", "--pdeathsig=INT", *user, str(_programs() / program), "-D", str(self._folder), *arguments]

    def _signal(self, number: signal.Signals) -> None:
        assert self._process is not None
        for process in processes():
            if self._process.pid in (process.pid, process.parent):
                process.hit(number)

    def _answers(self) -> bool:
        try:
            with psycopg.connect(self.url(), connect_timeout=2):
                return True
        except psycopg.OperationalError:
            return False


@contextmanager
def running_postgres(*options: str) -> Iterator[PostgresServer]:
    """Start a server, in a folder that the server's user can reach, and remove it afterwards."""
    need_postgres()
    with tempfile.TemporaryDirectory(prefix="treestroke-postgres-") as folder:
        os.chmod(folder, 0o711)
        server = PostgresServer(Path(folder) / "data", *options)
        try:
            yield server
        finally:
            server.stop()


def need_postgres() -> None:
    """Skip where there is no Postgres; where tests must be whole, fail."""
    if not (_programs() / "postgres").exists():
        reason = "Postgres is not installed; on Debian and Ubuntu: apt-get install postgresql"
        pytest.fail(reason) if os.environ.get("CI") == "true" else pytest.skip(reason)


def _programs() -> Path:
    """Return the folder of the newest Postgres's programs; Debian keeps most of them off the path."""
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin"), key=lambda path: int(path.parent.name))
    return found[-1] if found else Path(shutil.which("postgres") or "/missing/postgres").parent
