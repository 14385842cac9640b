"""Removal of what was deleted a day ago, with its files, and of files that no row refers to.

The wall clock decides nothing, since it may jump. Ages are measured by a clock of the store's own, and begin when a
sweep first sees a row, or a file, in its present state: nothing is removed that was not seen twice, a day or an hour
apart.
"""

import math
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, delete, exists, func, inspect, select, update

from treestroke.service.stored_models import RESTORABLE_SECONDS
from treestroke.service.unreferenced import BlobSweeper
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.tables import (
    UNFINISHED,
    CaptureRow,
    ClipRow,
    ModelRow,
    PhotoRow,
    Replay,
    SolveRow,
    StoreClock,
    UploadRow,
)
from treestroke.store.upload_pieces import open_uploads
from treestroke.store.webhook_tables import DeliveryRow

UNREFERENCED_SECONDS = 3600.0
"""A blob that no row refers to is kept this long: a row that does may be about to be written."""
UNWATCHED_SECONDS = 12 * 3600.0
"""The most that time without a running process counts, so that a wall clock that jumped cannot add a day."""
DELIVERY_SECONDS = 30 * 86_400.0
MOST_DELIVERIES = 1000
"""Messages to webhooks are kept this long, and so many of one webhook."""
_STEP_ROWS = 50
_PAUSE_SECONDS = 0.02
"""Pause between two steps, in which others write."""
_DAY = 86_400.0
_FINISHED = ModelRow.status.not_in(UNFINISHED)  # NOT IN keeps SQLite from walking the index of states
_SETTLED = ~exists().where(SolveRow.capture == CaptureRow.id, SolveRow.status.in_(UNFINISHED))


@dataclass(frozen=True)
class Swept:
    """How many of each were removed."""

    models: int
    photos: int
    captures: int
    clips: int
    uploads: int
    blobs: int


class Sweeper:
    """Removes deleted rows and unreferenced files, in small steps between which others write.

    Models, photos, captures and clips older than ``keep_days`` are deleted (0: never); ``over`` is set when this
    process ends.
    """

    def __init__(
        self,
        database: Database,
        blobs: Blobs,
        keep_days: float,
        over: threading.Event,
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        self._database, self._keep_days, self._over = database, keep_days, over
        self._uploads, self._monotonic = open_uploads(database, blobs), monotonic
        self._blobs = BlobSweeper(database, blobs, over)
        self._last: float | None = None

    def sweep(self, unreferenced_s: float = UNREFERENCED_SECONDS) -> Swept:
        """Delete what is too old, and remove for good what was deleted a day ago and blobs that no row refers to.

        The first sweep of a process only notes such blobs: the time before it is known by the wall clock alone, and a
        worker may be about to write a row that refers to one.

        Raises
        ------
        OSError
            The place of the blobs is away.
        """
        first, age_s = self._last is None, self._advance_clock()
        removed_until = age_s - RESTORABLE_SECONDS
        for table in (ModelRow, PhotoRow, CaptureRow, ClipRow, UploadRow, Replay, DeliveryRow):
            self._in_steps(table, update(table).values(seen=age_s), table.seen.is_(None))
        if self._keep_days:
            self._delete_older_than(age_s - self._keep_days * _DAY, age_s)
        models = self._in_steps(
            ModelRow, delete(ModelRow), ModelRow.deleted.is_not(None), ModelRow.seen <= removed_until, _FINISHED
        )
        photos = self._in_steps(
            PhotoRow, delete(PhotoRow), PhotoRow.deleted.is_not(None), PhotoRow.seen <= removed_until
        )
        captures = self._in_steps(
            CaptureRow, delete(CaptureRow), CaptureRow.deleted.is_not(None), CaptureRow.seen <= removed_until, _SETTLED
        )
        clips = self._in_steps(ClipRow, delete(ClipRow), ClipRow.deleted.is_not(None), ClipRow.seen <= removed_until)
        self._in_steps(Replay, delete(Replay), Replay.seen <= removed_until)
        self._sweep_deliveries(age_s - DELIVERY_SECONDS)
        uploads = self._sweep_uploads(removed_until)
        blobs = self._blobs.sweep(age_s, age_s - (math.inf if first else unreferenced_s))
        return Swept(models, photos, captures, clips, uploads, blobs)

    def _sweep_uploads(self, removed_until: float) -> int:
        """Remove uploads that stopped a day ago, and what has arrived of those without a row: a row comes first."""
        arrived = self._uploads.ids()
        removed = self._in_steps(UploadRow, delete(UploadRow), UploadRow.seen <= removed_until)
        with self._database.reading() as session:
            kept = set(session.scalars(select(UploadRow.id)))
        for id in arrived:
            if id not in kept:
                self._uploads.remove(id)
        return removed

    def _sweep_deliveries(self, removed_until: float) -> None:
        """Remove old messages to webhooks, and the oldest of many; those that still wait are kept."""
        over, removal = DeliveryRow.state != "waiting", delete(DeliveryRow)
        self._in_steps(DeliveryRow, removal, over, DeliveryRow.seen <= removed_until)
        number, many = DeliveryRow.number, func.count() > MOST_DELIVERIES
        with self._database.reading() as session:
            full = session.scalars(select(DeliveryRow.webhook).group_by(DeliveryRow.webhook).having(many)).all()
        for webhook in full:
            own = DeliveryRow.webhook == webhook
            newest = select(number).where(own).order_by(number.desc()).limit(1).offset(MOST_DELIVERIES)
            with self._database.reading() as session:
                last = session.scalars(newest).one()
            self._in_steps(DeliveryRow, removal, own, over, number <= last)

    def _advance_clock(self) -> float:
        """Advance the store's clock and return its time, seconds.

        It advances by the time that this process has run since its last sweep. Before the first sweep, it advances by
        the time since the latest wall-clock time that was ever written, so that no hour counts twice.
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
        over: dict[type[ModelRow | PhotoRow | CaptureRow | ClipRow], list[ColumnElement[bool]]]
        over = {ModelRow: [_FINISHED], PhotoRow: [], CaptureRow: [_SETTLED], ClipRow: []}
        for table, conditions in over.items():
            change = update(table).values(deleted=time.time(), seen=age_s)
            self._in_steps(table, change, table.deleted.is_(None), table.seen <= oldest, *conditions)

    def _in_steps(self, table: type[Any], change: Any, *conditions: ColumnElement[bool]) -> int:
        """Change all rows that meet conditions, a few at a time; return their number."""
        (key,), changed = inspect(table).primary_key, 0
        while not self._over.is_set():
            with self._database.reading() as session:
                found = session.scalars(select(key).where(*conditions).limit(_STEP_ROWS)).all()
            if not found:
                break
            with self._database.writing() as session:
                changed += session.execute(change.where(key.in_(found), *conditions)).rowcount  # type: ignore[attr-defined]
            self._over.wait(_PAUSE_SECONDS)
        return changed
