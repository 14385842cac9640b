"""A mixed load for an hour, and what the service's processes take meanwhile: `python -m tests.chaos.soak --help`.

It writes one line a minute, and ends with 1 where memory, open files or keys in Redis grew by more than 5 % between the
first minutes after the warm-up and the last ones.
"""

import argparse
import os
import random
import signal
import statistics
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import cv2
import httpx
import numpy as np
from redis import Redis
from tests.chaos.stack import Program, Stack, Team, running_stack
from tests.faults.harness import QUICK, small_tree

WARM_UP_MINUTES = 10
COMPARED = 6
"""Looks at each end that are compared by their medians: single ones depend on what is under way."""
MOST_GROWTH = 1.05
LOOK_SECONDS = 60.0
PAUSE_SECONDS = (1.0, 3.0)
"""Between two deeds of one team."""
_PAGE_MB = os.sysconf("SC_PAGE_SIZE") / 2**20


class Load:
    """What people and programs of a team do, good and bad, one thing after another."""

    def __init__(self, stack: Stack, team: Team, seed: int) -> None:
        self._stack, self._team, self._chance = stack, team, random.Random(seed)
        self._over = threading.Event()
        self._photos: list[str] = []
        self._models: list[str] = []
        self.done: dict[str, int] = {}
        self.failed: list[str] = []
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def stop(self) -> None:
        self._over.set()
        self._thread.join()

    def _run(self) -> None:
        deeds: list[tuple[Callable[[httpx.Client], httpx.Response], float]] = [
            (self._upload, 1.0),
            (self._ask, 2.0),
            (self._trace, 5.0),
            (self._look, 5.0),
            (self._follow, 2.0),
            (self._take_tree, 2.0),
            (self._share, 0.5),
            (self._delete, 1.0),
            (self._ask_nonsense, 1.0),
            (self._upload_nonsense, 1.0),
            (self._come_without_key, 1.0),
        ]
        while not self._over.wait(self._chance.uniform(*PAUSE_SECONDS)):
            (deed,) = self._chance.choices([each for each, _ in deeds], [weight for _, weight in deeds])
            with self._stack.client(self._chance.randrange(len(self._stack.webs)), self._team, 120) as client:
                try:
                    answer = deed(client)
                except httpx.TransportError as error:
                    self.failed.append(f"{deed.__name__}: {error!r}")
                    continue
            name = f"{deed.__name__.lstrip('_')} {answer.status_code}"
            self.done[name] = self.done.get(name, 0) + 1
            if answer.is_server_error:
                self.failed.append(f"{name}: {answer.text}")

    def _upload(self, client: httpx.Client) -> httpx.Response:
        """Send a picture that nobody has sent before."""
        picture = cv2.imdecode(np.frombuffer(small_tree()[0], np.uint8), cv2.IMREAD_COLOR)
        assert picture is not None
        picture[0, :8] = [[self._chance.randrange(256) for _ in range(3)] for _ in range(8)]
        content = cv2.imencode(".png", picture)[1].tobytes()
        answer = client.post("/v1/photos", content=content, headers={"Content-Type": "image/png"})
        if answer.is_success:
            self._photos.append(answer.json()["id"])
        return answer

    def _ask(self, client: httpx.Client) -> httpx.Response:
        if not self._photos:
            return self._upload(client)
        body = {"photo": self._chance.choice(self._photos), "strokes": small_tree()[1], "settings": QUICK}
        answer = client.post("/v1/models", json={**body, "seed": self._chance.randrange(2**30)})
        if answer.is_success:
            self._models.append(answer.json()["id"])
            if self._chance.random() < 0.1:
                return client.post(f"/v1/models/{self._models[-1]}/cancel")
        return answer

    def _trace(self, client: httpx.Client) -> httpx.Response:
        if not self._photos:
            return self._upload(client)
        return client.post(f"/v1/photos/{self._chance.choice(self._photos)}/trace", json=small_tree()[1])

    def _look(self, client: httpx.Client) -> httpx.Response:
        return client.get(self._chance.choice(["/v1/models", "/v1/photos", "/v1/limits", "/readyz", "/v1/keys"]))

    def _follow(self, client: httpx.Client) -> httpx.Response:
        """Follow a model for a while, or to its end."""
        if not self._models:
            return self._ask(client)
        with client.stream("GET", f"/v1/models/{self._models[-1]}/events") as answer:
            until = time.monotonic() + 3
            for _ in answer.iter_lines():
                if time.monotonic() > until:
                    break
        return answer

    def _take_tree(self, client: httpx.Client) -> httpx.Response:
        if not self._models:
            return self._ask(client)
        return client.get(f"/v1/models/{self._chance.choice(self._models)}/tree.glb")

    def _share(self, client: httpx.Client) -> httpx.Response:
        if not self._models:
            return self._ask(client)
        return client.post(f"/v1/models/{self._models[-1]}/shares", json={})

    def _delete(self, client: httpx.Client) -> httpx.Response:
        """Delete the oldest tree or photo: as much goes as comes."""
        if len(self._models) > 20:
            return client.delete(f"/v1/models/{self._models.pop(0)}")
        if len(self._photos) > 10:
            return client.delete(f"/v1/photos/{self._photos.pop(0)}")
        return self._look(client)

    def _ask_nonsense(self, client: httpx.Client) -> httpx.Response:
        return client.post("/v1/models", content=b'{"photo": 1e999, "strokes": [')

    def _upload_nonsense(self, client: httpx.Client) -> httpx.Response:
        content = small_tree()[0][:2000] + self._chance.randbytes(2000)
        return client.post("/v1/photos", content=content, headers={"Content-Type": "image/png"})

    def _come_without_key(self, client: httpx.Client) -> httpx.Response:
        return client.get("/v1/models", headers={"Authorization": "Bearer nonsense"})


def figures(stack: Stack) -> Iterator[tuple[str, float]]:
    """Yield what the programs take now."""
    for program in stack.programs:
        yield f"{program.name} MB", sum(memory_mb(process.pid) for process in program.processes())
        yield f"{program.name} files", sum(open_files(process.pid) for process in program.processes())
        yield f"{program.name} temporary", count_temporary(program)
    with Redis.from_url(stack.redis.url) as redis:
        yield "Redis keys", float(redis.dbsize())
        yield "Redis MB", redis.info("memory")["used_memory"] / 2**20
    yield "connections", len(stack.rows("SELECT pid FROM pg_stat_activity WHERE backend_type = 'client backend'"))


def memory_mb(process: int) -> float:
    """Return a process's own share of memory, so that what forks share is not counted twice."""
    with suppress(OSError):
        for line in Path(f"/proc/{process}/smaps_rollup").read_text().splitlines():
            if line.startswith("Pss:"):
                return int(line.split()[1]) / 1024
    return 0.0


def open_files(process: int) -> int:
    with suppress(OSError):
        return len(os.listdir(f"/proc/{process}/fd"))
    return 0


def count_temporary(program: Program) -> int:
    return sum(path.is_file() for path in (program.data / "tmp").rglob("*"))


def soak(stack: Stack, minutes: float) -> tuple[list[dict[str, float]], list[Load]]:
    """Load a stack, and look at it once a minute."""
    loads = [Load(stack, stack.team(name), at) for at, name in enumerate(("Oaks", "Elms"))]
    looks: list[dict[str, float]] = []
    began = time.monotonic()
    try:
        while time.monotonic() < began + 60 * minutes:
            time.sleep(LOOK_SECONDS)
            looks.append({"minute": round((time.monotonic() - began) / 60, 1), **dict(figures(stack))})
            say(looks[-1])
    finally:
        for load in loads:
            load.stop()
    return looks, loads


def grown(looks: list[dict[str, float]]) -> Iterator[tuple[str, float, float]]:
    """Yield each figure's median after the warm-up and at the end."""
    steady = [look for look in looks if look["minute"] > WARM_UP_MINUTES]
    for name in steady[0]:
        first, last = (
            statistics.median(look[name] for look in part) for part in (steady[:COMPARED], steady[-COMPARED:])
        )
        yield name, first, last


def say(values: dict[str, Any]) -> None:
    sys.stdout.write("  ".join(f"{name} {value:g}" for name, value in values.items()) + "\n")
    sys.stdout.flush()


def main() -> int:
    parser = argparse.ArgumentParser(description="Load a hosted service for an hour and watch what it takes.")
    parser.add_argument("--minutes", type=float, default=60)
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that nothing is left running
    with (
        tempfile.TemporaryDirectory(prefix="treestroke-soak-") as folder,
        running_stack(Path(folder), webs=2, workers=1) as stack,
    ):
        looks, loads = soak(stack, options.minutes)
    for load in loads:
        say(load.done)
        sys.stdout.writelines(f"FAILED {each}\n" for each in load.failed)
    worse = 0
    for name, first, last in grown(looks):
        if name != "minute":
            much = last > max(first * MOST_GROWTH, first + 1)
            worse += much
            sys.stdout.write(f"| {name} | {first:.1f} | {last:.1f} | {'GREW' if much else ''} |\n")
    return 1 if worse or any(load.failed for load in loads) else 0


if __name__ == "__main__":
    sys.exit(main())
