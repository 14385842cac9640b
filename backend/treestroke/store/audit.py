"""The audit: a row for each act that a team may later have to account for, in the transaction of the act itself."""

import time
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

from sqlalchemy.orm import Session

from treestroke.store.scope import LOCAL, SERVICE, Scope, scope_of
from treestroke.store.tables import AuditRow

COMMAND_LINE = "command line"
"""What acts as the credential of whoever runs the service."""


@dataclass(frozen=True)
class Origin:
    """From where a request came: its address, and its id in the log."""

    address: str = ""
    request_id: str = ""


_NOWHERE = Origin()
ORIGIN: ContextVar[Origin] = ContextVar("origin", default=_NOWHERE)
"""Of the request that is handled, also in the threads that handle it."""


def operator_of(team: str) -> Scope:
    """Return the scope of whoever runs the service, for rows of one team."""
    return Scope(team, SERVICE.maker, credential=COMMAND_LINE)


def record(session: Session, action: str, subject: str, by: Scope | None = None, /, **details: Any) -> None:
    """Record what is done in a session to ``subject``, an id; it is there only if what was done is.

    Who did it is the person whose session this is, or ``by``. A service without keys has one person and records
    nothing. ``details`` hold no secrets.
    """
    scope = by or scope_of(session)
    if scope.team == LOCAL.team:
        return
    origin = ORIGIN.get()
    row = AuditRow(
        team=scope.team,
        at=time.time(),
        who=None if scope.maker == SERVICE.maker else scope.maker,
        credential=scope.credential,
        action=action,
        subject=subject,
        details=details,
        address=origin.address,
        request_id=origin.request_id,
    )
    session.add(row)
