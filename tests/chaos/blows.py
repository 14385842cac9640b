"""What is done to a service: processes are killed and stopped, servers go and come back, a disk fills."""

import ctypes
import os
import random
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import psycopg
from tests.chaos.stack import Program, Stack

LONGER_THAN_A_LEASE = (12.0, 15.0)
AWAY = (2.0, 8.0)
FULL = (3.0, 8.0)
_LOOK_SECONDS = 0.1
DISK = "size=96m"
_libc = ctypes.CDLL(None, use_errno=True)


@dataclass
class Blow:
    """Something that was done, from when to when, and the attempts that it may have cost."""

    kind: str
    began: float
    ended: float = 0.0
    running: set[tuple[str, int]] = field(default_factory=set)


class Blows:
    """Strikes at a stack at random, and mends what is broken a while later.

    All is done by the thread that calls: some servers end with the thread that started them.
    """

    def __init__(self, stack: Stack, seed: int) -> None:
        self.done: list[Blow] = []
        self._stack, self._chance = stack, random.Random(seed)
        self._mending: list[tuple[float, str, Blow, Callable[[], object]]] = []
        self._kinds: dict[str, tuple[int, Callable[[Blow], None]]] = {
            "child of a worker killed": (5, lambda blow: self._strike_worker(blow, child=True)),
            "worker killed": (4, lambda blow: self._strike_worker(blow, child=False)),
            "worker stopped for 12 to 15 s": (2, self._freeze_worker),
            "web process killed": (3, self._kill_web),
            "web machine killed": (2, self._kill_web_machine),
            "web machine stopped for 12 to 15 s": (2, self._freeze_web),
            "Redis killed": (2, lambda blow: self._lose_redis(blow, empty=False)),
            "Redis wiped and restarted": (2, lambda blow: self._lose_redis(blow, empty=True)),
            "Redis emptied": (2, self._empty_redis),
            "Redis stopped": (2, self._freeze_redis),
            "Postgres crashed": (2, self._lose_postgres),
            "Postgres stopped": (1, self._freeze_postgres),
            "S3 killed": (2, self._lose_s3),
            "S3 stopped": (1, self._freeze_s3),
            "disk of a machine full": (2, self._fill_disk),
        }

    def go_on(self, seconds: float) -> None:
        """Mend what is due, for so long."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            self._mend(time.monotonic())
            time.sleep(_LOOK_SECONDS)

    def mend(self) -> None:
        """Mend everything, each thing at its time."""
        while self._mending:
            self.go_on(_LOOK_SECONDS)

    def strike(self) -> None:
        """Do one thing that does not concern a part that is down already."""
        kind = self._chance.choices(list(self._kinds), [weight for weight, _ in self._kinds.values()])[0]
        part, down = kind.split()[0], {part for _, part, _, _ in self._mending}
        if part in down or (part == "disk" and not small_disks(self._stack)):
            return
        blow = Blow(kind, time.monotonic(), running=self._running(None))
        self._kinds[kind][1](blow)
        self.done.append(blow)

    def _mend(self, now: float) -> None:
        due = [each for each in self._mending if each[0] <= now]
        self._mending = [each for each in self._mending if each[0] > now]
        for _, _, blow, mend in due:
            mend()
            blow.ended = time.monotonic()

    # Workers and web processes, which are started again by the stack

    def _strike_worker(self, blow: Blow, child: bool) -> None:
        worker = self._chance.choice(self._stack.workers)
        blow.running = self._running(worker)
        victims = worker.processes()
        for victim in victims[-1:] if child else victims:
            victim.hit(signal.SIGKILL)
        blow.ended = time.monotonic()

    def _freeze_worker(self, blow: Blow) -> None:
        worker = self._chance.choice(self._stack.workers)
        blow.running = self._running(worker)
        self._freeze(blow, worker, self._chance.uniform(*LONGER_THAN_A_LEASE))

    def _kill_web(self, blow: Blow) -> None:
        """Kill the web process alone: its launcher starts another on the same socket."""
        web = self._chance.choice(self._stack.webs)
        for victim in web.processes():
            if victim.command.endswith("treestroke.api"):
                victim.hit(signal.SIGKILL)
        self._costs_nothing(blow)

    def _kill_web_machine(self, blow: Blow) -> None:
        for victim in self._chance.choice(self._stack.webs).processes():
            victim.hit(signal.SIGKILL)
        self._costs_nothing(blow)

    def _freeze_web(self, blow: Blow) -> None:
        blow.running = set()
        self._freeze(blow, self._chance.choice(self._stack.webs), self._chance.uniform(*LONGER_THAN_A_LEASE))

    def _costs_nothing(self, blow: Blow) -> None:
        blow.running, blow.ended = set(), time.monotonic()

    def _freeze(self, blow: Blow, program: Program, seconds: float) -> None:
        frozen = program.processes()
        for process in frozen:
            process.hit(signal.SIGSTOP)
        self._later(blow, seconds, "", lambda: [process.hit(signal.SIGCONT) for process in frozen])

    # Servers

    def _lose_redis(self, blow: Blow, empty: bool) -> None:
        self._stack.redis.kill()
        self._later(blow, self._away(), "Redis", lambda: self._stack.redis.start(empty))

    def _empty_redis(self, blow: Blow) -> None:
        self._stack.redis.empty()
        blow.ended = time.monotonic()

    def _freeze_redis(self, blow: Blow) -> None:
        self._stack.redis.freeze()
        self._later(blow, self._away(), "Redis", self._stack.redis.thaw)

    def _lose_postgres(self, blow: Blow) -> None:
        self._stack.postgres.crash()
        self._later(blow, self._away(), "Postgres", self._stack.postgres.start)

    def _freeze_postgres(self, blow: Blow) -> None:
        self._stack.postgres.freeze()
        self._later(blow, self._away(), "Postgres", self._stack.postgres.thaw)

    def _lose_s3(self, blow: Blow) -> None:
        self._stack.s3.kill()
        self._later(blow, self._away(), "S3", self._stack.s3.launch)

    def _freeze_s3(self, blow: Blow) -> None:
        self._stack.s3.freeze()
        self._later(blow, self._away(), "S3", self._stack.s3.thaw)

    def _fill_disk(self, blow: Blow) -> None:
        """Fill the disk of a web process or a worker, whose data folder is on a small one."""
        disk = self._chance.choice(small_disks(self._stack))
        fill(disk)
        self._later(blow, self._chance.uniform(*FULL), "disk", lambda: (disk / "filler").unlink(missing_ok=True))

    def _away(self) -> float:
        return self._chance.uniform(*AWAY)

    def _later(self, blow: Blow, seconds: float, part: str, mend: Callable[[], object]) -> None:
        """Mend after a while; until then the part is not struck again."""
        self._mending.append((time.monotonic() + seconds, part, blow, mend))

    def _running(self, worker: Program | None) -> set[tuple[str, int]]:
        """Give the attempts that are under way, of all workers or of one."""
        with suppress(psycopg.Error):
            rows = self._stack.rows("SELECT id, attempt, worker FROM models WHERE status = 'running'")
            return {
                (row["id"], row["attempt"])
                for row in rows
                if worker is None or self._stack.worker_named(row["worker"]) is worker
            }
        return set()


def mount_small_disk(place: Path) -> None:
    """Mount a small disk of its own at a place.

    Raises
    ------
    OSError
        This user may not.
    """
    place.mkdir(parents=True)
    if _libc.mount(b"tmpfs", str(place).encode(), b"tmpfs", 0, DISK.encode()):
        raise OSError(ctypes.get_errno(), f"no disk can be mounted at {place}: {os.strerror(ctypes.get_errno())}")


def unmount(place: Path) -> None:
    """Take a small disk away, whoever still uses it."""
    _libc.umount2(str(place).encode(), 2)


def fill(disk: Path) -> None:
    """Take all the room that there is."""
    for size in (2**20, 2**12, 1):
        with (disk / "filler").open("ab", buffering=0) as file, suppress(OSError):
            while file.write(bytes(size)) == size:
                pass


def small_disks(stack: Stack) -> list[Path]:
    """Give the disks on which programs have their data folders."""
    return [program.data.parent for program in stack.programs if program.data.parent.is_mount()]
