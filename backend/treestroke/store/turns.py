"""Who is served next: the team that was served longest ago, and likewise in it the person, the kind of job, the oldest.

Turns are counted, not timed, so that no clock of a machine decides.
"""

from collections.abc import Collection, Iterable, Iterator
from typing import Any

from sqlalchemy import ColumnElement, Select, func, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from treestroke.store.tables import JOBS, AnyJob, Turn

_ALL = ("", "", "")
"""Key of the row that counts the turns of everybody."""


def wait_for_turn(session: Session) -> Turn:
    """Wait until no other claim is under way, and return the row that counts them.

    Whoever claims decides by what all claims before it decided: two at once would serve one team twice in a row.
    """
    return session.scalars(select(Turn).where(_is(*_ALL)).with_for_update()).one()


def next_job(session: Session, engine: str, most_running: int) -> AnyJob | None:
    """Return the queued job of an engine whose turn it is, locked; one that somebody else has locked is passed over.

    So are teams that have ``most_running`` jobs under way, unless it is 0.
    """
    for team, maker in _line(session, engine, most_running):
        kinds = {table.__tablename__: table for table in JOBS}
        for kind in _by_turn(session, Turn.kind, kinds, Turn.team == team, Turn.maker == maker):
            oldest = _oldest(kinds[kind], engine, team, maker).with_for_update(skip_locked=True)
            job: AnyJob | None = session.scalars(oldest).first()
            if job is not None:
                return job
    return None


def note_turn(session: Session, all_turns: Turn, job: AnyJob) -> None:
    """Note that a job's team, person and kind of job were served just now."""
    all_turns.last += 1
    session.merge(Turn(team=job.team, maker=job.maker, kind=job.__tablename__, last=all_turns.last))


def _line(session: Session, engine: str, most_running: int) -> Iterator[tuple[str, str]]:
    """Yield teams for whom jobs wait, each with its people, in the order of their turns."""
    for team in _by_turn(session, Turn.team, _waiting(session, "team", engine)):
        if not most_running or _running(session, team) < most_running:
            people = _waiting(session, "maker", engine, team)
            yield from ((team, maker) for maker in _by_turn(session, Turn.maker, people, Turn.team == team))


def _by_turn(
    session: Session, level: InstrumentedAttribute[str], names: Collection[str], *within: ColumnElement[bool]
) -> list[str]:
    """Return names in the order in which they were served last, those first that never were."""
    served = select(level, func.max(Turn.last)).where(level.in_(names), *within).group_by(level)
    last: dict[str, int] = dict(session.execute(served).all())
    return sorted(names, key=lambda name: (last.get(name, 0), name))


def _waiting(session: Session, level: str, engine: str, team: str | None = None) -> set[str]:
    """Return the teams, or the people of a team, for whom jobs of an engine wait."""
    found: set[str] = set()
    for table in JOBS:
        queued = [table.status == "queued", table.engine == engine, *([] if team is None else [table.team == team])]
        found.update(session.scalars(_distinct(getattr(table, level), queued)))
    return found


def _distinct(column: InstrumentedAttribute[str], where: Iterable[ColumnElement[bool]]) -> Select[Any]:
    """Return a query for the values of a column that reads one row of an index for each, however many rows have it."""
    values = select(func.min(column).label("value")).where(*where).cte("found", recursive=True)
    above = select(func.min(column)).where(*where, column > values.c.value).scalar_subquery()
    values = values.union_all(select(above).where(values.c.value.is_not(None)))
    return select(values.c.value).where(values.c.value.is_not(None))


def _oldest(table: type[AnyJob], engine: str, team: str, maker: str) -> Select[Any]:
    line = table.status == "queued", table.engine == engine, table.team == team, table.maker == maker
    return select(table).where(*line).order_by(table.number).limit(1)


def _running(session: Session, team: str) -> int:
    counts = (select(func.count()).where(table.status == "running", table.team == team) for table in JOBS)
    return sum(session.scalars(count).one() for count in counts)


def _is(team: str, maker: str, kind: str) -> ColumnElement[bool]:
    return (Turn.team == team) & (Turn.maker == maker) & (Turn.kind == kind)
