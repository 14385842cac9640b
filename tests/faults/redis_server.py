"""A Redis of the test's own: it can be killed, frozen, emptied and started again."""

import os
import shutil
import signal
import socket
import subprocess
from pathlib import Path

import pytest
from redis import Redis
from redis.exceptions import RedisError
from tests.faults.processes import wait_for


class RedisServer:
    """`redis-server` on a port and in a folder of its own, with its file of changes kept as the manual says."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        with socket.create_server(("127.0.0.1", 0)) as listener:
            self.port = listener.getsockname()[1]
        self._process: subprocess.Popen[bytes] | None = None
        self.start()

    @property
    def url(self) -> str:
        return f"redis:{'//'}127.0.0.1:{self.port}/0"

    def start(self, empty: bool = False) -> None:
        if empty:
            shutil.rmtree(self._folder)
        self._folder.mkdir(exist_ok=True)
        options = ["--bind", "127.0.0.1", "--port", str(self.port), "--dir", str(self._folder), "--save", ""]
        options += ["--appendonly", "yes", "--appendfsync", "everysec", "--maxmemory-policy", "noeviction"]
        self._process = subprocess.Popen(["redis-server", *options], stdout=subprocess.DEVNULL)
        wait_for(self._answers, 10, "an answer from Redis")

    def kill(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            self._process = None

    def freeze(self) -> None:
        assert self._process is not None
        os.kill(self._process.pid, signal.SIGSTOP)

    def thaw(self) -> None:
        assert self._process is not None
        os.kill(self._process.pid, signal.SIGCONT)

    def empty(self) -> None:
        with Redis.from_url(self.url) as redis:
            redis.flushall()

    def limit_memory(self, size: int) -> None:
        """Let it keep at most so many bytes, which it then refuses to pass; 0: any."""
        with Redis.from_url(self.url) as redis:
            redis.config_set("maxmemory", size)

    def clients(self) -> int:
        with Redis.from_url(self.url) as redis:
            return len(redis.client_list())

    def waiting(self) -> int:
        """Count the messages that nobody has taken."""
        with Redis.from_url(self.url) as redis:
            return int(redis.llen("treestroke"))

    def taken(self) -> int:
        """Count the messages that workers hold and have not begun with."""
        with Redis.from_url(self.url) as redis:
            return int(redis.hlen("unacked"))

    def _answers(self) -> bool:
        try:
            with Redis.from_url(self.url, socket_timeout=1) as redis:
                return bool(redis.ping())
        except RedisError:
            return False


def need_redis() -> None:
    """Skip where there is no Redis; where tests must be whole, fail."""
    if shutil.which("redis-server") is None:
        reason = "redis-server is not installed; on Debian and Ubuntu: apt-get install redis-server"
        pytest.fail(reason) if os.environ.get("CI") == "true" else pytest.skip(reason)
