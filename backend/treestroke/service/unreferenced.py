"""Removal of blobs that no row refers to, an hour after that was first seen, in small steps between which others write.

Files that are no blobs by the table, which a process left that died, get rows first and then go in the same way.
"""

import threading
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple

from sqlalchemy import delete, select, tuple_, update

from treestroke.store.blobs import Blobs, insert_blobs
from treestroke.store.database import Database
from treestroke.store.queries import used
from treestroke.store.tables import BlobRow

_PAGE_ROWS = 500
"""Rows that are read at once."""
_STEP_ROWS = 50
"""Blobs that are removed in one transaction."""
_PAUSE_SECONDS = 0.02
"""Pause between two steps, in which others write."""
_USED = used()


class _Seen(NamedTuple):
    """A row of a blob: whether a row refers to it, and since when none is known to."""

    team: str
    sha256: str
    seen: float | None
    used: bool


class BlobSweeper:
    """Removes the blobs of all teams that no row has referred to for a while; ``over`` is set when it is to stop."""

    def __init__(self, database: Database, blobs: Blobs, over: threading.Event) -> None:
        self._database, self._blobs, self._over = database, blobs, over

    def sweep(self, age_s: float, before: float) -> int:
        """Note at ``age_s`` what no row refers to, and remove what was noted until ``before``; return how many.

        Raises
        ------
        OSError
            The place of the blobs is away.
        """
        removed = sum(self._sweep_page(page, age_s, before) for page in self._pages())
        for team, sizes in self._blobs.objects.pages():
            names = sorted(sizes)
            for start in range(0, len(names), _PAGE_ROWS):
                if self._over.is_set():
                    return removed
                self._adopt(team, {name: sizes[name] for name in names[start : start + _PAGE_ROWS]}, age_s)
        return removed

    def _pages(self) -> Iterator[list[_Seen]]:
        """Yield the rows of all blobs in the order of their keys, a page at a time."""
        key = tuple_(BlobRow.team, BlobRow.sha256)
        query = select(BlobRow.team, BlobRow.sha256, BlobRow.seen, _USED).order_by(BlobRow.team, BlobRow.sha256)
        last: tuple[str, str] = ("", "")
        while not self._over.is_set():
            with self._database.reading() as session:
                rows = session.execute(query.where(key > last).limit(_PAGE_ROWS)).all()
            if not rows:
                return
            page = [_Seen(*row) for row in rows]
            yield page
            last = page[-1].team, page[-1].sha256

    def _sweep_page(self, page: Sequence[_Seen], age_s: float, before: float) -> int:
        removed = 0
        for team, rows in groupby(page, lambda row: row.team):
            found = list(rows)
            self._mark(team, [row.sha256 for row in found if row.used and row.seen is not None], None)
            self._mark(team, [row.sha256 for row in found if not row.used and row.seen is None], age_s)
            due = [row.sha256 for row in found if not row.used and row.seen is not None and row.seen <= before]
            for start in range(0, len(due), _STEP_ROWS):
                if not self._over.is_set() and not self._database.held():
                    removed += self._remove(team, due[start : start + _STEP_ROWS], before)
                    self._over.wait(_PAUSE_SECONDS)
        return removed

    def _mark(self, team: str, names: Sequence[str], seen: float | None) -> None:
        """Note since when no row refers to blobs; None where one does again."""
        if names:
            own = BlobRow.team == team, BlobRow.sha256.in_(names)
            with self._database.writing() as session:
                session.execute(
                    update(BlobRow).where(*own).values(seen=seen), execution_options={"synchronize_session": False}
                )

    def _remove(self, team: str, names: Sequence[str], before: float) -> int:
        """Remove blobs, except those that a row refers to by now, or that somebody has stored again."""
        still = BlobRow.team == team, BlobRow.sha256.in_(names), BlobRow.seen <= before, ~_USED
        with self._database.writing() as session:
            gone = session.scalars(
                delete(BlobRow).where(*still).returning(BlobRow.sha256),
                execution_options={"synchronize_session": False},
            ).all()
            self._blobs.objects.remove(team, gone)
        return len(gone)

    def _adopt(self, team: str, sizes: dict[str, int], age_s: float) -> None:
        """Write rows for objects that have none."""
        own = BlobRow.team == team, BlobRow.sha256.in_(sizes)
        with self._database.reading() as session:
            unknown = sizes.keys() - set(session.scalars(select(BlobRow.sha256).where(*own)))
        if unknown:
            rows = [
                {"team": team, "sha256": name, "bytes": sizes[name], "created": 0.0, "seen": age_s} for name in unknown
            ]
            with self._database.writing() as session:
                session.execute(insert_blobs(session, rows).on_conflict_do_nothing())
