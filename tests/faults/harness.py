"""A real service to do harm to: `treestroke serve` in a folder of its own, watched from outside all the time."""

import hashlib
import json
import os
import re
import signal
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any, Self

import cv2
import httpx
from tests.faults.held import released
from tests.faults.processes import Process, end_sessions, processes, wait_for
from tests.running import FAR_LIMITS

from treestroke.service.retention import Sweeper
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.queries import referenced
from treestroke.store.scope import LOCAL
from treestroke.store.tables import TERMINAL

ROOT = Path(__file__).parents[2]
PHOTO = ROOT / "tests" / "data" / "beech_round.jpg"
SHRUNK = 0.35
QUICK: dict[str, object] = {"iterations": 0, "foliage": "bare"}
"""Of a model that takes about a second."""
ENDLESS: dict[str, object] = {"iterations": 2000, "foliage": "leaves", "variants": 16}
"""Of a model that is still under way when a test stops it."""
PATIENCE_SECONDS = 300.0
"""Emergency exit of what a test waits for: nothing is expected to take this long, however busy the machine is."""
POISONED = "tests.faults.poisoned_serve"
Row = dict[str, Any]


@cache
def small_tree() -> tuple[bytes, dict[str, Any]]:
    """Give a real photo, made small, and its strokes."""
    picture = cv2.imread(str(PHOTO))
    assert picture is not None
    strokes = json.loads(PHOTO.with_suffix(".strokes.json").read_text())
    small = cv2.resize(picture, None, fx=SHRUNK, fy=SHRUNK, interpolation=cv2.INTER_AREA)
    for stroke in (strokes["crown"], *strokes["branches"]):
        stroke["points"] = [[x * SHRUNK, y * SHRUNK] for x, y in stroke["points"]]
        stroke.pop("width", None)
    return cv2.imencode(".png", small)[1].tobytes(), strokes


@dataclass(frozen=True)
class Change:
    """A model's row had a new status or attempt at this time of the monotonic clock."""

    at: float
    status: str
    attempt: int


class History:
    """What became of every model, as the database showed it every few milliseconds."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._over = threading.Event()
        self.changes: dict[str, list[Change]] = {}
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        self._over.set()
        self._thread.join()

    def rows(self, columns: str = "*") -> list[Row]:
        """Read the models' rows beside the service, which may be dead."""
        with closing(sqlite3.connect(f"file:{self._path}?mode=ro", uri=True, timeout=10)) as connection:
            connection.row_factory = sqlite3.Row
            return [dict(row) for row in connection.execute(f"SELECT {columns} FROM models ORDER BY number")]

    def _run(self) -> None:
        while not self._over.wait(0.03):
            with suppress(sqlite3.Error):
                rows = self.rows("id, status, attempt")
                now = time.monotonic()
                for row in rows:
                    changes = self.changes.setdefault(row["id"], [])
                    if not changes or (changes[-1].status, changes[-1].attempt) != (row["status"], row["attempt"]):
                        changes.append(Change(now, row["status"], row["attempt"]))


class Service:
    """One service and all that a test starts beside it; leaving it kills whatever still runs.

    ``program`` is `treestroke`, or `POISONED` for one whose worker knows poisoned jobs.
    """

    def __init__(self, folder: Path, data: Path | None = None, program: str = "treestroke", **settings: object) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.data = data or folder / "data"
        self.log_path = folder / "log.txt"
        self._program = program
        self._settings = {**FAR_LIMITS, "workers": 1, "tracers": 1, "memory_mb": 2048, **settings}
        self._started: list[subprocess.Popen[bytes]] = []
        self._seeds = count()
        self._photo: str | None = None
        self.accepted: list[str] = []
        self.launcher: subprocess.Popen[bytes] | None = None
        self.history = History(self.data / "treestroke.sqlite3")

    def __enter__(self) -> Self:
        try:
            self.start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.history.stop()
        end_sessions(self._sessions)
        for process in self._started:
            process.wait()

    # Processes

    def start(self) -> None:
        """Run `treestroke serve` and wait until it answers."""
        begins = len(self.log())
        self.launcher = self.run(self._program, "serve", "--data", str(self.data), "--port", "0")
        pattern = re.compile(r"open (\S+) in a browser")
        found = wait_for(
            lambda: pattern.search(self.log()[begins:]), PATIENCE_SECONDS, f"the service's address in {self.log_path}"
        )
        # Each request has a connection of its own: one that is open already dies with the process at its other end.
        limits = httpx.Limits(max_keepalive_connections=0)
        self.client = httpx.Client(base_url=found[1], timeout=PATIENCE_SECONDS, trust_env=False, limits=limits)

    def run(self, module: str, *arguments: str, **environment: object) -> subprocess.Popen[bytes]:
        """Start a module of Python beside the service, in a session of its own."""
        variables = {f"TREESTROKE_{name.upper()}": value for name, value in self._settings.items()}
        variables |= {"TREESTROKE_DATA": self.data, "PYTHONPATH": f"{ROOT / 'backend'}:{ROOT}", **environment}
        if sys.dont_write_bytecode:  # the many processes of a test would each compile everything anew
            variables |= {"PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": self.log_path.parents[1] / "bytecode"}
        with self.log_path.open("ab") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", module, *arguments],
                env={**os.environ, **{name: str(value) for name, value in variables.items()}},
                cwd=self.log_path.parent,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )
        self._started.append(process)
        return process

    @property
    def _sessions(self) -> set[int]:
        return {process.pid for process in self._started}

    def log(self) -> str:
        return self.log_path.read_text(errors="replace") if self.log_path.exists() else ""

    def logged(self, event: str) -> list[Row]:
        """Give the log's lines of one event."""
        lines = (line for line in self.log().splitlines() if f'"event": "{event}"' in line)
        return [json.loads(line) for line in lines]

    def alive(self) -> list[Process]:
        return processes(self._sessions)

    def web(self) -> Process | None:
        return next((one for one in self.alive() if one.command.endswith("treestroke.api")), None)

    def workers(self) -> list[Process]:
        """Give the workers' own processes, without their children."""
        named = [one for one in self.alive() if re.search(r"-m \S*(treestroke|poisoned_)\.?worker\b", one.command)]
        return [one for one in named if one.parent not in {other.pid for other in named}]

    def growers(self, worker: Process | None = None) -> list[Process]:
        """Give the processes in which a worker grows models."""
        parents = {worker.pid} if worker else {one.pid for one in self.workers()}
        return [one for one in self.alive() if one.parent in parents]

    def name_of(self, worker: Process) -> str:
        """Give the name by which a worker holds its jobs, as its log tells it; "" before it is ready."""
        ready = [line["worker"] for line in self.logged("worker_ready") if line["process"] == worker.pid]
        return str(ready[-1]) if ready else ""

    def wait_for_workers(self, number: int) -> list[str]:
        """Wait until so many workers have said that they live; give their names."""

        def names() -> list[str]:
            with closing(sqlite3.connect(f"file:{self.data / 'treestroke.sqlite3'}?mode=ro", uri=True)) as connection:
                return [str(row[0]) for row in connection.execute("SELECT id FROM workers")]

        wait_for(lambda: len(names()) >= number, PATIENCE_SECONDS, f"{number} workers")
        return names()

    def stop(self) -> float:
        """Tell the launcher to stop and wait until all its processes are gone; say how long that took."""
        assert self.launcher is not None
        began, session = time.monotonic(), {self.launcher.pid}
        self.launcher.send_signal(signal.SIGTERM)
        wait_for(lambda: not processes(session), PATIENCE_SECONDS, "the end of all processes")
        self.launcher.wait()
        return time.monotonic() - began

    def freeze(self, frozen: list[Process]) -> None:
        """Stop processes in their tracks, but between their writes.

        SQLite's lock cannot be taken from one that stands still while it writes: no other could write until it goes on.
        """

        def stand_still() -> bool:
            for process in frozen:
                process.hit(signal.SIGSTOP)
            if self._can_write():
                return True
            for process in frozen:
                process.hit(signal.SIGCONT)
            return False

        wait_for(stand_still, PATIENCE_SECONDS, "a moment at which none of them writes")

    def _can_write(self) -> bool:
        with closing(sqlite3.connect(self.data / "treestroke.sqlite3", timeout=1)) as connection:
            try:
                connection.execute("BEGIN IMMEDIATE")
            except sqlite3.OperationalError:
                return False
        return True

    # Requests

    def upload(self) -> str:
        answer = self.client.post("/v1/photos", content=small_tree()[0], headers={"content-type": "image/png"})
        answer.raise_for_status()
        return str(answer.json()["id"])

    def body(self, name: str = "", **settings: object) -> Row:
        """Make a request for a model that nobody has asked for yet."""
        self._photo = self._photo or self.upload()
        chosen = {**QUICK, **settings}
        return {
            "photo": self._photo,
            "strokes": small_tree()[1],
            "settings": chosen,
            "seed": next(self._seeds),
            "name": name,
        }

    def ask(self, name: str = "", **settings: object) -> str:
        """Ask for one model; give its id."""
        answer = self.client.post("/v1/models", json=self.body(name, **settings))
        assert answer.status_code == 202, answer.text
        self.accepted.append(answer.json()["id"])
        return self.accepted[-1]

    def ask_for(self, number: int, name: str = "", **settings: object) -> list[str]:
        return [self.ask(name, **settings) for _ in range(number)]

    def release(self, *ids: str) -> None:
        """Let jobs named "held" go on."""
        for id in ids:
            released(self.data, id).touch()

    def get(self, id: str) -> Row:
        answer = self.client.get(f"/v1/models/{id}")
        answer.raise_for_status()
        return dict(answer.json())

    def row(self, id: str) -> Row:
        return next(row for row in self.history.rows() if row["id"] == id)

    def wait_until(self, id: str, what: Callable[[Row], bool], seconds: float = PATIENCE_SECONDS) -> Row:
        """Wait for a state of a model's row."""

        def look() -> Row | None:
            with suppress(sqlite3.Error):
                row = self.row(id)
                return row if what(row) else None
            return None

        return wait_for(look, seconds, f"the state of {id} (now {self.row(id)})")

    def wait_running(self, id: str) -> Row:
        """Wait until a model is well under way."""
        return self.wait_until(id, lambda row: row["status"] == "running" and bool(row["phase"]))

    def finish(self, ids: Iterable[str] | None = None, seconds: float = PATIENCE_SECONDS) -> list[Row]:
        """Wait until models are finished, each way; give their rows."""
        return [self.wait_until(id, lambda row: row["status"] in TERMINAL, seconds) for id in ids or self.accepted]

    # What must hold whatever was done to it

    def check_invariants(self) -> None:
        """Check all that the service promises, once every model has ended."""
        rows = {row["id"]: row for row in self.history.rows()}
        wait_for(lambda: self._followed(rows), PATIENCE_SECONDS, "the history's last line")
        assert set(self.accepted) <= set(rows)
        assert {row["id"]: row["status"] for row in rows.values() if row["status"] not in TERMINAL} == {}
        for id, changes in self.history.changes.items():
            ends = [change for change in changes if change.status in TERMINAL]
            assert len(ends) <= 1, f"{id} ended twice: {changes}"
            assert not ends or changes[-1] == ends[0], f"{id} went on after its end: {changes}"
            attempts = [change.attempt for change in changes]
            assert attempts == sorted(attempts), f"{id}: {changes}"
        for row in rows.values():
            self._check_files(row)
        self._check_folder()

    def _followed(self, rows: dict[str, Row]) -> bool:
        return all(
            id in self.history.changes and self.history.changes[id][-1].status == rows[id]["status"] for id in rows
        )

    def _check_files(self, row: Row) -> None:
        answer = self.client.get(f"/v1/models/{row['id']}/tree.glb")
        with closing(sqlite3.connect(f"file:{self.data / 'treestroke.sqlite3'}?mode=ro", uri=True)) as connection:
            files = dict(connection.execute("SELECT name, blob FROM files WHERE model = ?", (row["id"],)).fetchall())
        if row["status"] == "succeeded":
            assert answer.status_code == 200
            assert hashlib.sha256(answer.content).hexdigest() == files["tree.glb"] == answer.headers["etag"].strip('"')
            assert set(files) == {"tree.glb", "preview.png", "growth.json"}
        else:
            assert answer.status_code == 404
            assert set(files) <= {"growth.json"}

    def _check_folder(self) -> None:
        database = Database(self.data).of(LOCAL)
        sweeper = Sweeper(database, open_blobs(database, self.data), 0, threading.Event())
        for _ in range(2):  # what no row names is to be seen twice
            sweeper.sweep(unreferenced_s=0)
        with database.reading() as session:
            assert {path.name for path in (self.data / "blobs").rglob("*") if path.is_file()} == referenced(session)
        database.close()
        temporary = [path.name for path in self.data.rglob(".*")]
        assert temporary == []
        assert [path.name for path in (self.data / "tmp").rglob("*") if path.is_file()] == []
