"""What was done in a team, as its owners read it."""

from collections.abc import Mapping, Sequence

from sqlalchemy import select

from treestroke.store.database import Database
from treestroke.store.queries import maker_names
from treestroke.store.tables import AuditRow


def list_entries(
    database: Database, before: str | None, limit: int
) -> tuple[Sequence[AuditRow], Mapping[str, str], str | None]:
    """Return a page of entries, the newest first, the names of who did it by their ids, and where the next begins."""
    query = select(AuditRow).order_by(AuditRow.number.desc()).limit(limit + 1)
    with database.reading() as session:
        rows = session.scalars(query if before is None else query.where(AuditRow.number < int(before))).all()
        names = maker_names(session, {row.who for row in rows if row.who is not None})
    return rows[:limit], names, str(rows[limit - 1].number) if len(rows) > limit else None
