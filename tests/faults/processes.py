"""Processes, seen through /proc: who lives, who started whom, and how to hit exactly one of them."""

import os
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")


@dataclass(frozen=True)
class Process:
    pid: int
    parent: int
    session: int
    command: str

    def hit(self, number: signal.Signals = signal.SIGKILL) -> None:
        """Send a signal; one that is gone already is no failure."""
        with suppress(ProcessLookupError):
            os.kill(self.pid, number)


def processes(sessions: set[int] | None = None) -> list[Process]:
    """List the processes of some sessions, or all; the dead, all of whose threads are gone, do not count."""
    found = []
    for folder in Path("/proc").iterdir():
        if folder.name.isdecimal():
            with suppress(OSError):
                state, parent, _, session, *others = (folder / "stat").read_text().rpartition(")")[2].split()
                threads = int(others[13])
                command = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode()
                if (state not in "ZX" or threads > 1) and (sessions is None or int(session) in sessions):
                    found.append(Process(int(folder.name), int(parent), int(session), command.strip()))
    return found


def end_sessions(sessions: set[int]) -> None:
    """Kill everything in some sessions, and wait until it is gone."""

    def gone() -> bool:
        left = processes(sessions)
        for process in left:
            process.hit()
        return not left

    wait_for(gone, 60, "the sessions' end")


def wait_for(look: Callable[[], T], seconds: float, what: str, every_s: float = 0.02) -> T:
    """Look until there is something to see, and give it."""
    deadline = time.monotonic() + seconds
    while not (seen := look()):
        if time.monotonic() > deadline:
            raise AssertionError(f"not within {seconds:g} s: {what}")
        time.sleep(every_s)
    return seen
