"""Workers that are killed at random for minutes, while jobs come in: `python -m tests.faults.chaos --help`.

It ends with 1 where a promise of the service was broken, and prints how long it took jobs to recover.
"""

import argparse
import json
import random
import signal
import statistics
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import httpx
from tests.faults.harness import Change, Row, Service

PAUSE_SECONDS = (2.0, 6.0)
"""Between two blows."""
STOP_SECONDS = (12.0, 15.0)
"""What is stopped stands still for longer than a lease."""
COMING_IN = 0.6
"""Jobs come in during this part of the time."""
BLOWS = {"kill child": 5, "kill worker": 3, "stop child": 1, "stop worker": 1}
MAX_ATTEMPTS = 3


@dataclass
class Blow:
    """Something that was done to a worker, and the attempts that it had under way."""

    kind: str
    at: float
    running: set[tuple[str, int]]


@dataclass
class Outcome:
    """What came of it all."""

    blows: list[Blow]
    rows: list[Row]
    usual_s: float
    recoveries_s: list[float]
    violations: list[str]

    def lines(self) -> Iterator[str]:
        done = Counter(row["status"] for row in self.rows)
        yield f"jobs: {len(self.rows)}: {dict(done)}; a job usually took {self.usual_s:.1f} s"
        yield f"blows: {dict(Counter(blow.kind for blow in self.blows))}"
        yield f"attempts used: {dict(sorted(Counter(row['attempt'] for row in self.rows).items()))}"
        yield f"lost three times, and so failed: {sum(lost_thrice(row) for row in self.rows)}"
        if self.recoveries_s:
            found = sorted(self.recoveries_s)
            p50, p90 = (found[min(int(part * len(found)), len(found) - 1)] for part in (0.5, 0.9))
            yield f"recovery beside a job's own time, of {len(found)} that were hit: "
            yield f"    p50 {p50:.1f} s, p90 {p90:.1f} s, longest {found[-1]:.1f} s"
        yield from (f"VIOLATION {violation}" for violation in self.violations)


def torment(service: Service, seconds: float, jobs: int, seed: int) -> Outcome:
    """Strike at a service's workers for a while, then let it finish and see what became of everything."""
    chance, blows, over = random.Random(seed), list[Blow](), threading.Event()
    before = len(service.accepted)
    asking = threading.Thread(target=ask_in_time, args=(service, jobs, seconds * COMING_IN))
    asking.start()
    later: list[threading.Timer] = []
    deadline = time.monotonic() + seconds
    while not over.wait(chance.uniform(*PAUSE_SECONDS)) and time.monotonic() < deadline:
        blows += strike(service, chance, later)
    asking.join()
    for timer in later:
        timer.join()
    rows = service.finish(service.accepted[before:], seconds=300 + 10 * jobs)
    violations = [f"{row['id']} {row['error']}" for row in rows if not (succeeded(row) or lost_thrice(row))]
    if len(rows) != jobs:
        violations.append(f"{jobs} jobs were asked for, {len(rows)} were taken")
    try:
        service.check_invariants()
    except AssertionError as error:
        violations.append(str(error))
    return Outcome(blows, rows, *recoveries(rows, blows, service.history.changes), violations)


def ask_in_time(service: Service, jobs: int, seconds: float) -> None:
    """Ask for models at an even pace."""
    began = time.monotonic()
    for number in range(jobs):
        time.sleep(max(began + seconds * number / jobs - time.monotonic(), 0.0))
        ask_until_taken(service)


def ask_until_taken(service: Service) -> None:
    body, key = service.body(), {"Idempotency-Key": f"chaos-{time.monotonic_ns()}"}
    for _ in range(20):
        answer = service.client.post("/v1/models", json=body, headers=key)
        if answer.status_code == httpx.codes.ACCEPTED:
            service.accepted.append(answer.json()["id"])
            return
        time.sleep(1)
    raise AssertionError(f"not taken: {answer.text}")


def strike(service: Service, chance: random.Random, later: list[threading.Timer]) -> list[Blow]:
    """Do one thing to one worker; nothing where none is up."""
    kind = chance.choices(list(BLOWS), list(BLOWS.values()))[0]
    workers = service.workers()
    if not workers:
        return []
    worker = chance.choice(workers)
    children = service.growers(worker)
    whole, act = kind.endswith("worker"), kind.split()[0]
    victims = [worker, *children] if whole else children[:1]
    running = [row for row in service.history.rows() if row["status"] == "running"]
    name = service.name_of(worker)
    hit = {(row["id"], row["attempt"]) for row in running if row["worker"] == name}
    for victim in victims:
        victim.hit(signal.SIGKILL if act == "kill" else signal.SIGSTOP)
    if act == "stop":
        for victim in victims:
            later.append(threading.Timer(chance.uniform(*STOP_SECONDS), victim.hit, [signal.SIGCONT]))
            later[-1].start()
    return [Blow(kind, time.monotonic(), hit)]


def recoveries(rows: list[Row], blows: list[Blow], changes: dict[str, list[Change]]) -> tuple[float, list[float]]:
    """Give a job's usual time, and from each last blow that cost an attempt the time to the model, less the usual."""
    easy = [row["finished"] - row["started"] for row in rows if succeeded(row) and row["attempt"] == 1]
    usual = statistics.median(easy) if easy else 0.0
    found = []
    for row in rows:
        hits = [blow.at for blow in blows if any(id == row["id"] and n < row["attempt"] for id, n in blow.running)]
        if succeeded(row) and hits:
            found.append(max(changes[row["id"]][-1].at - max(hits) - usual, 0.0))
    return usual, found


def succeeded(row: Row) -> bool:
    return bool(row["status"] == "succeeded")


def lost_thrice(row: Row) -> bool:
    """Tell whether a job failed as one may that was struck three times."""
    return bool(
        row["status"] == "failed"
        and row["attempt"] == MAX_ATTEMPTS
        and json.loads(row["error"])["code"] == "worker_lost"
    )


def main() -> int:
    parser = argparse.ArgumentParser(description="Kill workers at random while jobs come in.")
    parser.add_argument("--seconds", type=float, default=180)
    parser.add_argument("--jobs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="treestroke-chaos-")))
        service = stack.enter_context(Service(folder / "service", workers=options.workers))
        service.wait_for_workers(1)
        outcome = torment(service, options.seconds, options.jobs, options.seed)
        sys.stdout.write("\n".join((*outcome.lines(), "")))
        if outcome.violations:
            kept = Path(tempfile.gettempdir()) / "treestroke-chaos.log"
            kept.write_text(service.log())
            sys.stdout.write(f"log: {kept}\n")
    return 1 if outcome.violations else 0


if __name__ == "__main__":
    sys.exit(main())
