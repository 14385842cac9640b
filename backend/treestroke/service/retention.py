"""What is deleted goes, a day later, with its files; so does what nothing refers to.

The clock on the wall decides nothing, since it may jump. Ages are told by a clock of the store's own, and begin when a
sweep first sees a row, or a file, in its present state: nothing goes that was not seen twice, a day or an hour apart.
"""

import math
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import ColumnElement, delete, inspect, select, update

from treestroke.service.stored_models import RESTORABLE_SECONDS
from treestroke.store.blobs import Blobs, state_of
from treestroke.store.database import Database
from treestroke.store.leases import UNFINISHED
from treestroke.store.queries import referenced
from treestroke.store.tables import ModelRow, PhotoRow, Replay, StoreClock, Stray

STRAY_SECONDS = 3600.0
"""A file that no row names may belong to one that is about to be written; after this it does not."""
UNWATCHED_SECONDS = 12 * 3600.0
"""The most that counts of the time in which no process watched: a clock that jumped meanwhile cannot make it a day."""
_STEP_ROWS = 50
_PAUSE_SECONDS = 0.02
"""Between two steps others write."""
_DAY = 86_400.0
_FINISHED = ModelRow.status.not_in(UNFINISHED)  # said so, it leads nobody to read all finished models by their status


@dataclass(frozen=True)
class Swept:
    """How many of each went."""

    models: int
    photos: int
    blobs: int


class Sweeper:
    """Removes what is to go, in small steps between which others write.

    ``keep_days`` is how old models and photos become before they are deleted (0: as old as they like); ``over`` is set
    when this process ends.
    """

    def __init__(
        self,
        database: Database,
        blobs: Blobs,
        keep_days: float,
        over: threading.Event,
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        self._database, self._blobs, self._keep_days, self._over = database, blobs, keep_days, over
        self._monotonic = monotonic
        self._last: float | None = None

    def sweep(self, stray_s: float = STRAY_SECONDS) -> Swept:
        """Delete what is too old, and remove for good what was deleted a day ago and files that nobody refers to.

        The first sweep of a process only notes such files: what it knows of the time before it has from the wall's
        clock, and a worker may be about to name one.
        """
        first, age_s = self._last is None, self._watch()
        gone = age_s - RESTORABLE_SECONDS
        for table in (ModelRow, PhotoRow, Replay):
            self._in_steps(table, update(table).values(seen=age_s), table.seen.is_(None))
        if self._keep_days:
            self._delete_older_than(age_s - self._keep_days * _DAY, age_s)
        models = self._in_steps(
            ModelRow, delete(ModelRow), ModelRow.deleted.is_not(None), ModelRow.seen <= gone, _FINISHED
        )
        photos = self._in_steps(PhotoRow, delete(PhotoRow), PhotoRow.deleted.is_not(None), PhotoRow.seen <= gone)
        self._in_steps(Replay, delete(Replay), Replay.seen <= gone)
        return Swept(models, photos, sum(self._sweep_folders(age_s, math.inf if first else stray_s)))

    def _watch(self) -> float:
        """Move the store's clock on, and read it.

        It moves by as long as this process has run since it last looked. For the time before its first look, it moves
        by what the wall's clock says beyond all that it ever said: the same hours never count twice.
        """
        now, wall = self._monotonic(), time.time()
        with self._database.writing() as session:
            clock = session.get(StoreClock, 1) or StoreClock(id=1, age_s=0.0, wall=wall)
            unwatched_s = min(max(wall - clock.wall, 0.0), UNWATCHED_SECONDS)
            clock.age_s += unwatched_s if self._last is None else now - self._last
            clock.wall = max(clock.wall, wall)
            session.add(clock)
        self._last = now
        return clock.age_s

    def _delete_older_than(self, oldest: float, age_s: float) -> None:
        for table, finished in ((ModelRow, _FINISHED), (PhotoRow, PhotoRow.id.is_not(None))):
            change = update(table).values(deleted=time.time(), seen=age_s)
            self._in_steps(table, change, table.deleted.is_(None), table.seen <= oldest, finished)

    def _in_steps(self, table: type[Any], change: Any, *which: ColumnElement[bool]) -> int:
        """Make a change to all rows that are so; they are found while others write, and changed a few at a time."""
        (key,), changed = inspect(table).primary_key, 0
        while not self._over.is_set():
            with self._database.reading() as session:
                found = session.scalars(select(key).where(*which).limit(_STEP_ROWS)).all()
            if not found:
                break
            with self._database.writing() as session:
                changed += session.execute(change.where(key.in_(found), *which)).rowcount  # type: ignore[attr-defined]
            self._over.wait(_PAUSE_SECONDS)
        return changed

    def _sweep_folders(self, age_s: float, stray_s: float) -> Iterator[int]:
        """Look at the files folder by folder, so that what is referred to need not be known all at once."""
        for name, files in self._blobs.places():
            if self._over.is_set():
                return
            yield self._sweep_folder(name, files, age_s, stray_s)

    def _sweep_folder(self, folder: str, files: list[Path], age_s: float, stray_s: float) -> int:
        """Remove the files of one folder that are strays for long enough, and write down those that are not yet."""
        with self._database.reading() as session:
            kept = referenced(session, folder)
            known = {stray.name: stray for stray in session.scalars(select(Stray).where(Stray.folder == folder))}
        states = _states(path for path in files if path.name not in kept)
        old = [path for path, state in states.items() if _is_old(known.get(path.name), state, age_s - stray_s)]
        removed = {path for path in old if self._remove(path, states.pop(path))}
        now = {path.name: state for path, state in states.items()}
        forgotten = known.keys() - now.keys()
        found = {name for name, state in now.items() if name not in known or known[name].state != state}
        if forgotten or found:
            with self._database.writing() as session:
                for name in forgotten:
                    session.execute(delete(Stray).where(Stray.folder == folder, Stray.name == name))
                for name in found:
                    session.merge(Stray(folder=folder, name=name, state=now[name], seen=age_s))
        return len(removed)

    def _remove(self, path: Path, state: str) -> bool:
        """Remove a stray, unless a row refers to it by now."""
        with self._database.reading() as session:
            if referenced(session, path.name):
                return False
        return self._blobs.remove(path, state)


def _states(paths: Iterable[Path]) -> dict[Path, str]:
    """Give the states of files; one that is gone by now has none."""
    states = {}
    for path in paths:
        with suppress(FileNotFoundError):
            states[path] = state_of(path)
    return states


def _is_old(seen: Stray | None, state: str, before: float) -> bool:
    return seen is not None and seen.state == state and seen.seen <= before
