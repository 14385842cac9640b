"""`treestroke serve`: starts, supervises, restarts and stops a web process and a worker."""

import errno
import fcntl
import math
import os
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import closing, suppress
from http.client import HTTPConnection
from pathlib import Path
from types import FrameType

from treestroke.core.errors import SettingsError
from treestroke.parent_process import LISTENER, PARENT_HOLDS_STDIN, PREVIOUS_RUN_ID, RUN_ID
from treestroke.settings import LOOPBACK, Settings, check_oidc_installed, check_secret
from treestroke.store.data_folder import DataFolderError, check_version, prepare_folder

STOP_SECONDS = 10.0
"""Time that the processes have to finish or give back their work."""
_POLL_SECONDS = 0.2
_LONGEST_BACKOFF_SECONDS = 10.0
_STABLE_AFTER_SECONDS = 3.0
"""A process that ran longer than this did not fail at its start, so its backoff is reset."""
_START_SECONDS = 60.0


class Child:
    """A process that is restarted whenever it ends.

    Each run gets an id, and the id of the run before it, which has certainly ended.
    """

    def __init__(self, module: str, environment: dict[str, str], sockets: tuple[int, ...] = ()) -> None:
        self.module = module
        self._environment, self._sockets = environment, sockets
        self._process: subprocess.Popen[bytes] | None = None
        self._run_id = ""
        self._failures = 0
        self._next = self._started = 0.0

    def keep_running(self) -> None:
        """Start the process if it does not run; wait longer each time if it keeps failing."""
        now = time.monotonic()
        if self._process is not None and self._process.poll() is not None:
            self._plan_restart(self._process, now)
            self._process = None
        if self._process is None and now >= self._next:
            self._process, self._started = self._start(), now

    def _plan_restart(self, ended: subprocess.Popen[bytes], now: float) -> None:
        ended.communicate()  # closes its standard input
        self._failures = 1 if now - self._started > _STABLE_AFTER_SECONDS else self._failures + 1
        self._next = now + min(0.1 * 2**self._failures, _LONGEST_BACKOFF_SECONDS)
        message = f"treestroke: {self.module} ended ({ended.returncode}) and is started again"
        print(message, file=sys.stderr, flush=True)

    def _start(self) -> subprocess.Popen[bytes]:
        previous, self._run_id = self._run_id, secrets.token_hex(12)
        return subprocess.Popen(
            [sys.executable, "-m", self.module],
            env={**self._environment, RUN_ID: self._run_id, PREVIOUS_RUN_ID: previous},
            pass_fds=self._sockets,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,  # standard output is for the launcher's one line; processes log to stderr
            process_group=0,  # Ctrl+C reaches the launcher alone, which then stops its processes in order
        )

    def stop(self) -> None:
        """Ask the process to stop."""
        if self._process is not None:
            self._process.terminate()

    def wait(self, deadline: float) -> None:
        """Wait until the process has stopped; kill it at the deadline."""
        if self._process is not None:
            try:
                self._process.wait(max(deadline - time.monotonic(), 0.0))
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()


def serve(settings: Settings) -> int:
    """Run the web process and the worker until this process is told to stop; return the exit code.

    This process owns the listening socket: while a web process is restarted, requests wait instead of failing.

    Raises
    ------
    SettingsError
        The address is not a loopback address though there are no keys or no names to answer to, keys cannot be
        digested, or the port is taken.
    DataFolderError
        Other users can read the data folder and it may not be the service's alone, or its database is lost or was
        made by a newer treestroke.
    OSError
        The data folder cannot be written.
    """
    _check_reach(settings)
    with _listen(settings) as listener:
        _check_metrics_port(settings)
        prepare_folder(settings.folder)
        _lock(settings.folder)
        _check_database(settings)
        port = listener.getsockname()[1]
        threading.Thread(target=_announce, args=(address(settings, port), settings.host, port), daemon=True).start()
        _supervise(_children(settings, listener.fileno()))
    return 0


def _check_database(settings: Settings) -> None:
    """Refuse a database that cannot be used: the processes would only end and be started again, over and over.

    Raises
    ------
    DataFolderError
        The database is lost, cannot be read, was made by a newer program, or Postgres is away; or its tables are not
        up to date and belong to another user.
    """
    if not settings.hosted:
        check_version(settings.folder)
        return
    from sqlalchemy.exc import OperationalError

    from treestroke.store.database import Database

    database = Database(settings.folder, settings.database_url, settings.owner_database_url)
    try:
        database.check()
        database.check_owner()
    except OperationalError as error:
        why = " ".join(str(error.orig).split())
        raise DataFolderError(f"{database.place}: Postgres cannot be used ({why}); {database.mend}") from error
    finally:
        database.close()


def _check_reach(settings: Settings) -> None:
    """Check that whoever can reach the service needs a key, or is on this machine."""
    if settings.hosted:
        check_secret(settings)
        check_oidc_installed(settings)
        if settings.host not in LOOPBACK and not settings.host_names:
            raise SettingsError(
                f"--host {settings.host}: name what the service answers to by TREESTROKE_HOSTS, such as trees.example"
            )
    elif settings.host not in LOOPBACK:
        raise SettingsError(
            f"--host {settings.host}: without keys only this machine may reach treestroke; take 127.0.0.1, or let a "
            "team share it by keys: set TREESTROKE_DATABASE_URL"
        )


def _children(settings: Settings, listener: int) -> list[Child]:
    """Return the web process and, unless workers run elsewhere, the worker; not started yet."""
    temporary = settings.folder / "tmp"
    _empty(temporary)
    environment = {
        **os.environ,
        **settings.environment(),
        "TREESTROKE_DATA": str(settings.folder),
        "TMPDIR": str(temporary),
        PARENT_HOLDS_STDIN: "1",
    }
    children = [Child("treestroke.api", {**environment, LISTENER: str(listener)}, (listener,))]
    if settings.workers:
        children.append(Child("treestroke.worker", environment))
    return children


def _supervise(children: Sequence[Child]) -> None:
    """Keep all processes running until SIGTERM or SIGINT, then stop them."""
    stopping = False

    def stop(_signal: int, _frame: FrameType | None) -> None:
        nonlocal stopping
        stopping = True

    for name in (signal.SIGTERM, signal.SIGINT):
        signal.signal(name, stop)
    while not stopping:
        for child in children:
            child.keep_running()
        time.sleep(_POLL_SECONDS)
    deadline = time.monotonic() + STOP_SECONDS
    for child in children:
        child.stop()
    for child in children:
        child.wait(deadline)


def _listen(settings: Settings) -> socket.socket:
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    try:
        return socket.create_server((settings.host, settings.port), family=family, backlog=1024)
    except OSError as error:
        why = "another program listens there" if error.errno == errno.EADDRINUSE else os.strerror(error.errno or 0)
        other = 8000 if settings.port == 65535 else settings.port + 1
        raise SettingsError(
            f"--port {settings.port}: {why}; take another: --port {other}, or `make run PORT={other}`"
        ) from None


def _check_metrics_port(settings: Settings) -> None:
    """Check that the port of the metrics, which the web process listens on, is free."""
    if settings.metrics_port:
        family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
        try:
            socket.create_server((settings.host, settings.metrics_port), family=family).close()
        except OSError as error:
            why = os.strerror(error.errno or 0)
            raise SettingsError(f"TREESTROKE_METRICS_PORT {settings.metrics_port}: {why}; take another port") from None


def _lock(folder: Path) -> None:
    """Lock the data folder for as long as this process lives.

    The lock is on the folder itself: a lock file could be removed and made again by another process.
    """
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)  # stays open until this process ends
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise SettingsError(
            f"--data {folder}: another `treestroke serve` uses this data folder; stop it, or name another folder"
        ) from None


def _empty(folder: Path) -> None:
    """Make the folder empty: an earlier run may have left temporary files."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)


def _announce(page: str, host: str, port: int) -> None:
    """Print the page's address as soon as it responds; say where that takes long."""
    late = time.monotonic() + _START_SECONDS
    while True:
        with suppress(OSError), closing(HTTPConnection(host, port, timeout=_START_SECONDS)) as connection:
            connection.request("GET", "/livez")
            connection.getresponse()
            print(f"treestroke: open {page} in a browser; Ctrl+C ends it", flush=True)
            return
        if time.monotonic() > late:
            late = math.inf
            message = "treestroke: it does not respond yet; `treestroke doctor` says what is missing"
            print(message, file=sys.stderr, flush=True)
        time.sleep(_POLL_SECONDS)


def address(settings: Settings, port: int) -> str:
    """Return the address of the page."""
    host = f"[{settings.host}]" if ":" in settings.host else settings.host
    return f"http:{'//'}{host}:{port}/"
