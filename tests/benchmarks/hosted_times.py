"""What a hosted service grows with one, two and three workers, and whom it serves next; `make bench` prints it.

Two web processes, Postgres, Redis, S3 and the workers are all on this machine. Models are those of the first example
with its default settings, each with a seed of its own, so that each is grown.
"""

import json
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import psycopg
from tests.benchmarks.service_times import PHOTO, STROKES
from tests.chaos.stack import Row, Stack, Team, running_stack
from tests.faults.harness import QUICK
from tests.faults.processes import wait_for

WORKERS, MODELS = (1, 2, 3), 12
REQUESTS, MOST_SECONDS = 10, 1.0
"""In each state of Redis; what each may take to be accepted."""
MANY = 100
"""Models of one team that wait when another team asks for one."""
LEAST_GAIN = 1.6
"""Of two workers over one, on two cores."""
_PATIENCE_SECONDS = 1800.0


def add_photo(stack: Stack, team: Team) -> str:
    with stack.client(0, team) as client:
        return str(client.post("/v1/photos", content=PHOTO.read_bytes()).raise_for_status().json()["id"])


def ask(stack: Stack, team: Team, photo: str, seeds: range, **settings: object) -> list[str]:
    """Ask for models; return their ids."""
    ids = []
    with stack.client(0, team, 60) as client:
        for seed in seeds:
            body = {"photo": photo, "strokes": json.loads(STROKES.read_bytes()), "settings": settings, "seed": seed}
            while (answer := client.post("/v1/models", json=body)).status_code == 429:
                time.sleep(float(answer.headers["Retry-After"]))
            ids.append(str(answer.raise_for_status().json()["id"]))
    return ids


def wait_for_models(stack: Stack, ids: list[str]) -> list[Row]:
    """Wait until models have succeeded; return their rows."""
    names = ", ".join(f"'{id}'" for id in ids)

    def ended() -> list[Row] | None:
        with suppress(psycopg.Error):
            rows = stack.rows(f"SELECT id, status, created, started, finished FROM models WHERE id IN ({names})")
            return rows if all(row["status"] == "succeeded" for row in rows) else None
        return None

    return wait_for(ended, _PATIENCE_SECONDS, "the last model", 0.2)


def keep_workers(stack: Stack, number: int) -> None:
    """Stop all workers but some."""
    for worker in stack.workers[number:]:
        worker.wanted = False
        if not worker.ended():
            worker.ask_to_stop()
    wait_for(lambda: len(stack.rows("SELECT id FROM workers")) == number, 60, f"{number} workers", 0.2)


def throughput(stack: Stack, teams: dict[Team, str]) -> dict[int, float]:
    """Return the models a minute of so many workers, the most workers first."""
    found, first = {}, 0
    for number in sorted(WORKERS, reverse=True):
        keep_workers(stack, number)
        began, ids = time.monotonic(), list[str]()
        for team, photo in teams.items():
            share = MODELS // len(teams)
            ids += ask(stack, team, photo, range(first, first + share))
            first += share
        wait_for_models(stack, ids)
        found[number] = MODELS / (time.monotonic() - began) * 60
        sys.stdout.write(f"{number} workers: {found[number]:.1f} models a minute\n")
    return found


def served_between(stack: Stack, many: Team, one: Team, photos: dict[Team, str]) -> int:
    """Let one team ask for many and then another for one; return how many of the first's began before the other's."""
    ids = ask(stack, many, photos[many], range(10_000, 10_000 + MANY), **QUICK)
    wanted = ask(stack, one, photos[one], range(1), **QUICK)
    rows = wait_for_models(stack, [*ids, *wanted])
    its = next(row for row in rows if row["id"] == wanted[0])
    return sum(its["created"] < row["started"] < its["started"] for row in rows)


def accepted_without_redis(stack: Stack, team: Team, photo: str) -> float:
    """Print how long a model takes to be accepted while Redis is not as it should be; return the longest time."""
    redis, worst, seeds = stack.redis, 0.0, iter(range(20_000, 21_000, REQUESTS))
    states: dict[str, tuple[Callable[[], None], Callable[[], None]]] = {
        "down": (redis.kill, redis.start),
        "frozen": (redis.freeze, redis.thaw),
        "empty": (redis.empty, lambda: None),
        "full": (lambda: redis.limit_memory(1), lambda: redis.limit_memory(0)),
    }
    for state, (harm, mend) in states.items():
        harm()
        took, ids = [], list[str]()
        for seed in range(begin := next(seeds), begin + REQUESTS):
            began = time.monotonic()
            ids += ask(stack, team, photo, range(seed, seed + 1), **QUICK)
            took.append(time.monotonic() - began)
        mend()
        wait_for_models(stack, ids)
        sys.stdout.write(f"accepted while Redis is {state}: at most {max(took):.2f} s; all {len(ids)} were grown\n")
        worst = max(worst, *took)
    return worst


def main() -> int:
    """Print the figures; give 1 where they are not what is promised."""
    with (
        tempfile.TemporaryDirectory(prefix="treestroke-hosted-") as folder,
        running_stack(Path(folder), webs=2, workers=max(WORKERS)) as stack,
    ):
        photos = {team: add_photo(stack, team) for team in map(stack.team, ("Oaks", "Elms", "Firs"))}
        found = throughput(stack, photos)
        first, second, _ = photos
        between = served_between(stack, first, second, photos)  # by one worker, which is all that is left
        worst = accepted_without_redis(stack, first, photos[first])
    sys.stdout.write(f"of {MANY} that waited, begun before another team's one: {between}\n")
    gain = found[2] / found[1]
    sys.stdout.write(f"two workers over one: {gain:.2f} (at least {LEAST_GAIN})\n")
    return 0 if gain >= LEAST_GAIN and between == 0 and worst < MOST_SECONDS else 1


if __name__ == "__main__":
    sys.exit(main())
