"""`treestroke serve`: a web process and a worker, started, watched, restarted and stopped together."""

import errno
import fcntl
import os
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import closing, suppress
from http.client import HTTPConnection
from pathlib import Path
from types import FrameType

from treestroke.core.errors import SettingsError
from treestroke.parent_process import PARENT_HOLDS_STDIN, PREVIOUS_RUN_ID, RUN_ID
from treestroke.settings import Settings
from treestroke.store.data_folder import check_version, prepare_folder

LOOPBACK = ("127.0.0.1", "localhost", "::1")
STOP_SECONDS = 10.0
"""What the processes may take to finish or give back what they do."""
_LOOK_SECONDS = 0.2
_SLOWEST_RESTART_SECONDS = 10.0
_WELL_AFTER_SECONDS = 3.0
_START_SECONDS = 60.0


class Child:
    """One process that is started again whenever it ends.

    Each run has a name, and is told that of the one before it, which is surely over.
    """

    def __init__(self, module: str, environment: dict[str, str], sockets: tuple[int, ...] = ()) -> None:
        self.module = module
        self._environment, self._sockets = environment, sockets
        self._process: subprocess.Popen[bytes] | None = None
        self._run = ""
        self._failures = 0
        self._next = self._started = 0.0

    def look(self) -> None:
        """Start the process where it does not run; one that keeps dying is started ever more slowly."""
        now = time.monotonic()
        if self._process is not None and self._process.poll() is not None:
            self._process.communicate()  # it has nothing to say; this closes its lifeline
            code = self._process.returncode
            self._failures = 1 if now - self._started > _WELL_AFTER_SECONDS else self._failures + 1
            self._next = now + min(0.1 * 2**self._failures, _SLOWEST_RESTART_SECONDS)
            self._process = None
            print(f"treestroke: {self.module} ended ({code}) and is started again", file=sys.stderr, flush=True)
        if self._process is None and now >= self._next:
            before, self._run = self._run, secrets.token_hex(12)
            command = [sys.executable, "-m", self.module]
            # Standard output is the launcher's own, for its one line; what the processes have to say is on stderr.
            self._process = subprocess.Popen(
                command,
                env={**self._environment, RUN_ID: self._run, PREVIOUS_RUN_ID: before},
                pass_fds=self._sockets,
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                process_group=0,  # Ctrl+C is for this process, which then stops the others in good order
            )
            self._started = now

    def stop(self) -> None:
        """Tell the process to stop."""
        if self._process is not None:
            self._process.terminate()

    def wait(self, deadline: float) -> None:
        """Wait until it has stopped, and end it where it does not."""
        if self._process is not None:
            try:
                self._process.wait(max(deadline - time.monotonic(), 0.0))
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()


def serve(settings: Settings) -> int:
    """Run web process and worker until this process is told to stop.

    The listening socket is this process's own: while a web process is replaced, requests wait instead of failing.

    Raises
    ------
    SettingsError
        The address is not this machine's own: without keys nobody else may reach it. Or the port is taken.
    DataFolderError
        The data folder is open to others and not plainly ours, or its database is lost or a newer program's.
    OSError
        The data folder cannot be written.
    """
    if settings.host not in LOOPBACK:
        raise SettingsError(
            f"--host {settings.host}: without keys only this machine may reach treestroke; take 127.0.0.1, or put a "
            "server that asks for a password before it"
        )
    folder = settings.folder
    with _listen(settings) as listener:
        prepare_folder(folder)
        _hold(folder)
        check_version(folder)
        _clear(folder / "tmp")
        environment = {
            **os.environ,
            **settings.environment(),
            "TREESTROKE_DATA": str(folder),
            "TMPDIR": str(folder / "tmp"),
            PARENT_HOLDS_STDIN: "1",
        }
        port = listener.getsockname()[1]
        children = [Child("treestroke.api", {**environment, "LISTEN_FD": str(listener.fileno())}, (listener.fileno(),))]
        if settings.workers:
            children.append(Child("treestroke.worker", environment))
        stopping = False

        def stop(_signal: int, _frame: FrameType | None) -> None:
            nonlocal stopping
            stopping = True

        for name in (signal.SIGTERM, signal.SIGINT):
            signal.signal(name, stop)
        threading.Thread(target=_announce, args=(address(settings, port), settings.host, port), daemon=True).start()
        while not stopping:
            for child in children:
                child.look()
            time.sleep(_LOOK_SECONDS)
        deadline = time.monotonic() + STOP_SECONDS
        for child in children:
            child.stop()
        for child in children:
            child.wait(deadline)
    return 0


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


def _hold(folder: Path) -> None:
    """Keep the data folder to this process, as long as it lives.

    The folder itself is locked: a file in it could be removed, and made anew by another process.
    """
    held = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)  # until this process ends
    try:
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise SettingsError(
            f"--data {folder}: another `treestroke serve` keeps its data there; stop it, or name another folder"
        ) from None


def _clear(folder: Path) -> None:
    """Begin with an empty folder for what an earlier run left half done."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)


def _announce(page: str, host: str, port: int) -> None:
    """Say where the page is, once it answers."""
    deadline = time.monotonic() + _START_SECONDS
    while time.monotonic() < deadline:
        with suppress(OSError), closing(HTTPConnection(host, port, timeout=_START_SECONDS)) as line:
            line.request("GET", "/livez")
            line.getresponse()
            print(f"treestroke: open {page} in a browser; Ctrl+C ends it", flush=True)
            return
        time.sleep(_LOOK_SECONDS)
    print("treestroke: it does not answer; `treestroke doctor` says what is missing", file=sys.stderr, flush=True)


def address(settings: Settings, port: int) -> str:
    """Write the page's address."""
    host = f"[{settings.host}]" if ":" in settings.host else settings.host
    return f"http:{'//'}{host}:{port}/"
