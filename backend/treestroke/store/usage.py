"""How much of the store a team uses; in the scope of the service, all teams together."""

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from treestroke.store.scope import scope_of
from treestroke.store.tables import JOBS, File, ModelRow

_TEAMS = 21
"""First number of the advisory locks of teams, which other locks do not have."""


def lock_team(session: Session) -> None:
    """Let no other transaction that does the same for this team go on until this one ends.

    What is counted afterwards stays true until then. SQLite has one writer, which needs no lock.
    """
    if session.get_bind().dialect.name == "postgresql":
        session.execute(select(func.pg_advisory_xact_lock(_TEAMS, func.hashtext(scope_of(session).team))))


def file_bytes(session: Session) -> int:
    """Return the bytes of the files of models, deleted but not yet removed ones too."""
    return int(session.scalar(select(func.sum(File.bytes))) or 0)  # Postgres sums whole numbers as decimals


def jobs(session: Session, status: str) -> int:
    """Return how many models and solves have a status."""
    counts = (select(func.count()).select_from(table).where(table.status == status) for table in JOBS)
    return sum(session.scalar(count) or 0 for count in counts)


def models_since(session: Session, moment: float) -> tuple[int, float]:
    """Return how many models were asked for since a moment (seconds since 1970), and when the first of them was."""
    since = select(func.count(), func.min(ModelRow.created)).where(ModelRow.created >= moment)
    count, first = session.execute(since).one()
    return count, moment if first is None else first
