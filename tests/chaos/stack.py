"""A hosted service as several machines would run it: Postgres, Redis, S3, web processes and workers.

Each web process and each worker has a data folder of its own, and is started again when it ends, as an init system
does.
"""

import json
import os
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import httpx
import psycopg
from psycopg.rows import dict_row
from tests.accounts import SECRET
from tests.bucket import S3Server
from tests.faults.harness import ROOT
from tests.faults.processes import Process, end_sessions, processes, wait_for
from tests.faults.redis_server import RedisServer, need_redis
from tests.hosted import Hosted
from tests.postgres import PostgresServer, running_postgres
from tests.running import FAR_LIMITS

from treestroke.store.database import Database

Row = dict[str, Any]
START_SECONDS = 120.0
"""Emergency exit of waiting for a process that starts."""
AGAIN_SECONDS = 1.0
"""Pause before a process that ended is started again."""


class Program:
    """`treestroke serve` or `treestroke worker` in a folder and a session of its own."""

    def __init__(self, name: str, folder: Path, arguments: list[str], environment: dict[str, str]) -> None:
        self.name, self.data, self.log_path = name, folder / "data", folder / "log.txt"
        folder.mkdir(exist_ok=True)
        self._arguments, self._environment = arguments, {**environment, "TREESTROKE_DATA": str(self.data)}
        self._process: subprocess.Popen[bytes] | None = None
        self.wanted = True
        self.starts = 0
        self.start()

    def start(self) -> None:
        """Start it; what is left of an earlier run is killed first, as by a machine that starts anew."""
        self.end()
        with self.log_path.open("ab") as log:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "treestroke", *self._arguments],
                env=self._environment,
                cwd=self.log_path.parent,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )
        self.starts += 1

    def ended(self) -> bool:
        return self._process is None or self._process.poll() is not None

    def end(self) -> None:
        """Kill all of it."""
        if self._process is not None:
            end_sessions({self._process.pid})
            self._process.wait()

    def ask_to_stop(self) -> int:
        """Stop it as a new version does, and return its exit code."""
        assert self._process is not None
        self._process.terminate()
        return self._process.wait(START_SECONDS)

    def processes(self) -> list[Process]:
        """Give all of its processes, those first that started the others."""
        return [] if self._process is None else sorted(processes({self._process.pid}), key=lambda one: one.pid)

    def logged(self, event: str) -> list[Row]:
        """Give the log's lines of one event."""
        lines = self.log_path.read_text(errors="replace").splitlines()
        return [json.loads(line) for line in lines if f'"event": "{event}"' in line]


@dataclass(frozen=True)
class Team:
    """A team, and the key by which its programs ask."""

    name: str
    key: str

    @property
    def headers(self) -> dict[str, str]:
        return {"Authorization": f"Bearer {self.key}"}


class Stack:
    """All servers and programs of a service; leaving it ends them."""

    def __init__(
        self, folder: Path, servers: tuple[PostgresServer, RedisServer, S3Server], webs: int, workers: int
    ) -> None:
        self.postgres, self.redis, self.s3 = servers
        self.folder, self.database_url = folder, self.postgres.fresh_with_tables()
        self.bucket_url = self.s3.fresh()
        self._environment = self._variables()
        self._over = threading.Event()
        self.ports = [_free_port() for _ in range(webs)]
        self.webs = [self._program(f"web-{at}", "serve", "--port", str(port)) for at, port in enumerate(self.ports)]
        self.workers = [self._program(f"worker-{at}", "worker") for at in range(workers)]
        self._keeper = threading.Thread(target=self._keep, daemon=True)
        self._keeper.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._keeper.join()
        for program in self.programs:
            program.end()

    @property
    def programs(self) -> list[Program]:
        return [*self.webs, *self.workers]

    def wait_until_ready(self) -> None:
        """Wait until each web process answers and each worker is there."""
        for web in range(len(self.webs)):
            with self.client(web) as client:
                wait_for(lambda client=client: answers(client), START_SECONDS, "a web process", 0.2)
        wait_for(lambda: len(self.rows("SELECT id FROM workers")) == len(self.workers), START_SECONDS, "the workers")

    def client(self, web: int, team: Team | None = None, seconds: float = 30.0) -> httpx.Client:
        """Return a client of a web process; each request has a connection of its own."""
        limits = httpx.Limits(max_keepalive_connections=0)
        address = f"http:{'//'}127.0.0.1:{self.ports[web]}"
        headers = {} if team is None else team.headers
        return httpx.Client(base_url=address, headers=headers, timeout=seconds, trust_env=False, limits=limits)

    def team(self, name: str) -> Team:
        """Make a team with one owner."""
        database = Database(self.folder, self.database_url)
        with self.client(0) as client:
            key = Hosted(client, database).key(team=name)
        database.close()
        return Team(name, key)

    def rows(self, query: str) -> list[Row]:
        """Read rows beside the service."""
        with psycopg.connect(self.database_url, connect_timeout=2, row_factory=dict_row, autocommit=True) as connection:
            connection.execute("SET statement_timeout = 5000")
            return connection.execute(query).fetchall()  # type: ignore[call-overload,no-any-return]

    def worker_named(self, id: str) -> Program | None:
        """Give the worker that holds its jobs by a name."""
        return next((one for one in self.workers if any(line["worker"] == id for line in _ready(one))), None)

    def _variables(self) -> dict[str, str]:
        settings = {
            **FAR_LIMITS,
            "database_url": self.database_url,
            "broker_url": self.redis.url,
            "bucket_url": self.bucket_url,
            "secret": SECRET,
            "tracers": 1,
            "team_queued": 1000,
            "team_models_a_day": 0,
            "memory_mb": 2048,
        }
        own = {f"TREESTROKE_{name.upper()}": str(value) for name, value in settings.items()}
        python = {"PYTHONPATH": f"{ROOT / 'backend'}:{ROOT}", "PYTHONPYCACHEPREFIX": str(self.folder / "bytecode")}
        return {**os.environ, **python, **self.s3.environment, **own}

    def _program(self, name: str, *arguments: str) -> Program:
        workers = "0" if name.startswith("web") else "1"
        environment = {**self._environment, "TREESTROKE_WORKERS": workers, "PYTHONDONTWRITEBYTECODE": ""}
        return Program(name, self.folder / name, list(arguments), environment)

    def _keep(self) -> None:
        """Start again what has ended, a moment later."""
        while not self._over.wait(AGAIN_SECONDS):
            for program in self.programs:
                if program.wanted and program.ended() and not self._over.is_set():
                    program.start()


def _ready(worker: Program) -> list[Row]:
    return worker.logged("worker_ready")


def answers(client: httpx.Client) -> bool:
    """Tell whether a web process says that it lives."""
    try:
        return client.get("/livez").status_code == httpx.codes.OK
    except httpx.TransportError:
        return False


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        return int(listener.getsockname()[1])


@contextmanager
def running_stack(folder: Path, webs: int = 2, workers: int = 3) -> Iterator[Stack]:
    """Run everything on this machine, and wait until it is ready."""
    need_redis()
    with ExitStack() as opened:
        postgres = opened.enter_context(running_postgres())
        redis = RedisServer(folder / "redis")
        opened.callback(redis.kill)
        s3 = S3Server(folder / "s3")
        opened.callback(s3.kill)
        os.environ.update(s3.environment)  # of whoever looks at the bucket beside the service
        stack = opened.enter_context(Stack(folder, (postgres, redis, s3), webs, workers))
        stack.wait_until_ready()
        yield stack
