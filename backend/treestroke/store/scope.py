"""Whose rows a session sees and changes: those of one team, or all for the service itself. Nothing else scopes."""

from dataclasses import dataclass
from typing import Any, Literal

from sqlalchemy import String, event
from sqlalchemy.orm import Mapped, ORMExecuteState, Session, mapped_column, with_loader_criteria

_SCOPE = "scope"
"""Under which a session keeps its scope."""
_LOCAL = "local"
Removes = Literal["all", "own", "none"]


@dataclass(frozen=True)
class Scope:
    """A team whose rows are seen, and who makes new ones in it; without a team, all rows are seen.

    ``removes`` tells which of the rows that are seen may be deleted and restored (`store.queries.check_removable`).
    ``credential`` is the id of the key or session by which this person came, for the audit.
    """

    team: str | None
    maker: str
    removes: Removes = "all"
    credential: str = ""


SERVICE = Scope(None, "service")
"""The service itself, which serves all teams: workers, dispatcher, sweeps."""
LOCAL = Scope(_LOCAL, _LOCAL)
"""The only team of a service without keys, and the only person."""


class Unscoped(Exception):
    """A database was asked for a session without a scope: a programmer's mistake, which must not show all rows."""


class Foreign(Exception):
    """A row of one team was about to be written in the scope of another."""


class Owned:
    """A row that belongs to a team; in a session with a team, no statement sees or changes one of another team."""

    team: Mapped[str] = mapped_column(String(40), server_default=_LOCAL)


class Authored(Owned):
    """A row that somebody made."""

    maker: Mapped[str] = mapped_column(String(40), server_default=_LOCAL)
    """Id of who made it."""


class ScopedSession(Session):
    """A session whose every select, update and delete is limited to a team, and whose new rows get that team."""


def scoped(scope: Scope | None) -> dict[str, Any]:
    """Return the ``info`` of a session with a scope.

    Raises
    ------
    Unscoped
        There is none.
    """
    if scope is None:
        raise Unscoped("name whose rows these are: database.of(scope)")
    return {_SCOPE: scope}


def scope_of(session: Session) -> Scope:
    """Return the scope of a session."""
    scope: Scope = session.info[_SCOPE]
    return scope


@event.listens_for(ScopedSession, "do_orm_execute")
def _limit(state: ORMExecuteState) -> None:
    team = scope_of(state.session).team
    if team is not None:
        own = with_loader_criteria(Owned, lambda table: table.team == team, include_aliases=True)
        state.statement = state.statement.options(own)


@event.listens_for(ScopedSession, "before_flush")
def _own(session: Session, *_: Any) -> None:
    scope = scope_of(session)
    for row in session.new:
        if isinstance(row, Owned):
            team: str | None = row.team or scope.team
            if team is None or scope.team not in (None, team):
                raise Foreign(f"a new row of {type(row).__name__} for team {team}, by team {scope.team}")
            row.team = team
        if isinstance(row, Authored):
            row.maker = row.maker or scope.maker
