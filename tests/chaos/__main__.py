"""Chaos: three teams ask for models while everything around them breaks; `python -m tests.chaos --help`.

It prints a table in Markdown, and ends with 1 where a promise of the service was broken.
"""

import argparse
import random
import signal
import statistics
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from tests.chaos import invariants
from tests.chaos.asking import Asked, Asker
from tests.chaos.blows import Blow, Blows, mount_small_disk, unmount
from tests.chaos.stack import Row, Stack, running_stack
from tests.faults.harness import Change

TEAMS = ("Oaks", "Elms", "Firs")
PAUSE_SECONDS = (6.0, 14.0)
"""Between two blows: about as long as a process takes to start again on a small machine."""
KEPT = Path(tempfile.gettempdir()) / "treestroke-chaos"
"""Where the logs go of a run that broke a promise."""


@dataclass
class Outcome:
    """What came of it all."""

    seconds: float
    rows: list[Row]
    asked: list[Asked]
    blows: list[Blow]
    recoveries_s: list[float]
    found: dict[str, list[str]]

    def table(self) -> Iterator[tuple[str, str]]:
        """Yield names and figures."""
        states = Counter(row["status"] for row in self.rows)
        answered = sorted(seconds for each in self.asked for seconds in each.answered_s)
        accepted = sorted(seconds for each in self.asked for seconds in each.accepted_s)
        yield "jobs", f"{len(self.rows)} of {len(self.asked)} teams, in {self.seconds / 60:.1f} minutes"
        yield "ended", ", ".join(f"{count} {state}" for state, count in states.most_common())
        yield "failed for", ", ".join(f"{n} {code}" for code, n in _codes(self.rows).most_common()) or "-"
        yield "attempts", ", ".join(f"{n} with {attempt}" for attempt, n in sorted(_attempts(self.rows).items()))
        yield "blows", str(len(self.blows))
        for kind, count in sorted(Counter(blow.kind for blow in self.blows).items()):
            yield f"- {kind}", str(count)
        yield "accepting answers", f"p50 {_part(answered, 0.5):.2f} s, p99 {_part(answered, 0.99):.1f} s"
        yield "the same with tries before", f"p50 {_part(accepted, 0.5):.2f} s, p99 {_part(accepted, 0.99):.1f} s"
        found = sorted(self.recoveries_s)
        yield "jobs whose attempt was lost", str(len(found))
        yield "recovery", f"p50 {_part(found, 0.5):.1f} s, p99 {_part(found, 0.99):.1f} s, longest {found[-1]:.1f} s"
        yield from ((name, str(len(each))) for name, each in self.found.items())


def torment(stack: Stack, jobs: int, seconds: float, seed: int) -> Outcome:
    """Strike at a stack while teams ask for models; let it finish, and see what became of everything."""
    began, blows, history = time.monotonic(), Blows(stack, seed), invariants.History(stack)
    shares = [jobs // len(TEAMS) + (at < jobs % len(TEAMS)) for at in range(len(TEAMS))]
    askers = [Asker(stack, stack.team(name), share, seconds, seed) for name, share in zip(TEAMS, shares, strict=True)]
    for asker in askers:
        asker.thread.start()
    chance = random.Random(seed)
    while any(asker.thread.is_alive() for asker in askers):
        blows.go_on(chance.uniform(*PAUSE_SECONDS))
        blows.strike()
    blows.mend()
    stack.wait_until_ready()
    rows = invariants.wait_for_ends(stack)
    took, asked = time.monotonic() - began, [asker.asked for asker in askers]
    time.sleep(1)  # for the history's last look
    history.stop()
    found = {
        "lost": [*invariants.lost(rows, asked), *(each for one in asked for each in one.violations)],
        "doubled": list(invariants.doubled(rows, asked, history.changes)),
        "wrong or missing files": list(invariants.unlike(stack, rows, asked)),
        "orphans": list(invariants.orphans(stack)),
    }
    if len(rows) != jobs:
        found["lost"].append(f"{jobs} jobs were to be asked for")
    return Outcome(took, rows, asked, blows.done, recoveries(rows, blows.done, history.changes), found)


def recoveries(rows: list[Row], blows: list[Blow], changes: dict[str, list[Change]]) -> list[float]:
    """Give, for each job that lost an attempt, the time from the last blow that did it to its end, less the usual."""
    easy = [row["finished"] - row["started"] for row in rows if row["status"] == "succeeded" and row["attempt"] == 1]
    usual, found = statistics.median(easy) if easy else 0.0, []
    for row in rows:
        hits = [
            blow.began for blow in blows for id, attempt in blow.running if id == row["id"] and attempt < row["attempt"]
        ]
        if hits and row["status"] == "succeeded":
            found.append(max(changes[row["id"]][-1].at - max(hits) - usual, 0.0))
    return found or [0.0]


def _codes(rows: list[Row]) -> Counter[str]:
    return Counter(row["error"]["code"] for row in rows if row["status"] == "failed")


def _attempts(rows: list[Row]) -> Counter[int]:
    return Counter(row["attempt"] for row in rows)


def _part(ordered: list[float], part: float) -> float:
    return ordered[min(int(part * len(ordered)), len(ordered) - 1)]


def main() -> int:
    parser = argparse.ArgumentParser(description="Break everything around a hosted service while jobs come in.")
    parser.add_argument("--jobs", type=int, default=500)
    parser.add_argument("--seconds", type=float, default=900, help="in which they come in")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that nothing is left running
    with ExitStack() as opened:
        folder = Path(opened.enter_context(tempfile.TemporaryDirectory(prefix="treestroke-chaos-")))
        for name in ("web-1", "worker-1"):
            mount_small_disk(folder / name)
            opened.callback(unmount, folder / name)
        stack = opened.enter_context(running_stack(folder))
        outcome = torment(stack, options.jobs, options.seconds, options.seed)
        broken = [f"{name}: {each}" for name, found in outcome.found.items() for each in found]
        lines = [f"| {name} | {figure} |" for name, figure in outcome.table()]
        sys.stdout.write("\n".join([f"seed {options.seed}", *lines, *broken, ""]))
        if broken:
            keep_logs(stack)
    return 1 if broken else 0


def keep_logs(stack: Stack) -> None:
    """Keep the logs of all programs."""
    KEPT.mkdir(exist_ok=True)
    for program in stack.programs:
        (KEPT / f"{program.name}.log").write_bytes(program.log_path.read_bytes())
    sys.stdout.write(f"logs: {KEPT}\n")


if __name__ == "__main__":
    sys.exit(main())
