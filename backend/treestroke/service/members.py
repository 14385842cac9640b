"""A team and its members: shown, added, changed, removed."""

import time
from collections.abc import Sequence

from sqlalchemy import delete, func, select, update
from sqlalchemy.orm import Session

from treestroke.codec.refusals import checked
from treestroke.core.errors import TreestrokeError
from treestroke.service.model_request import read_body
from treestroke.service.photos import NotFound
from treestroke.service.principals import Principal
from treestroke.store.account_tables import KeyRow, MemberRow, SessionRow, TeamRow
from treestroke.store.audit import record
from treestroke.store.database import Database
from treestroke.store.queries import new_id
from treestroke.wire_accounts import MemberChange, MemberRequest, TeamChange


class LastOwner(Exception):
    """The only owner of a team was to be removed or given another role: then nobody could manage it."""


def get_team(database: Database, who: Principal) -> TeamRow:
    """Return the team of somebody.

    Raises
    ------
    NotFound
        It is gone.
    """
    with database.reading() as session:
        return _team(session, who)


def rename_team(database: Database, who: Principal, body: bytes) -> TeamRow:
    """Give a team another name.

    Raises
    ------
    TreestrokeError, NotFound
        The body is not such a request, or the team is gone.
    """
    name = checked(TeamChange, read_body(body), TreestrokeError).name
    with database.writing() as session:
        team = _team(session, who)
        record(session, "team.renamed", team.team, name=name, before=team.name)
        team.name = name
    return team


def list_members(database: Database) -> Sequence[MemberRow]:
    """Return the members of a team, the first one first."""
    present = select(MemberRow).where(MemberRow.removed.is_(None))
    with database.reading() as session:
        return session.scalars(present.order_by(MemberRow.created, MemberRow.id)).all()


def add_member(database: Database, body: bytes) -> MemberRow:
    """Add a member, who signs in once they have a key.

    Raises
    ------
    TreestrokeError
        The body is not such a request.
    """
    wanted = checked(MemberRequest, read_body(body), TreestrokeError)
    row = MemberRow(id=new_id("usr"), name=wanted.name, role=wanted.role, created=time.time())
    with database.writing() as session:
        session.add(row)
        record(session, "member.added", row.id, name=row.name, role=row.role)
    return row


def change_member(database: Database, who: Principal, id: str, body: bytes) -> MemberRow:
    """Give a member another name or role, which holds from their next request on.

    Raises
    ------
    TreestrokeError, NotFound, LastOwner
        The body is not such a request, there is no such member, or nobody would be an owner.
    """
    wanted = checked(MemberChange, read_body(body), TreestrokeError)
    with database.writing() as session:
        member = _member(session, who, id)
        if wanted.role not in (None, "owner"):
            _keep_an_owner(session, member)
        before = {"name": member.name, "role": member.role}
        member.name, member.role = wanted.name or member.name, wanted.role or member.role
        record(session, "member.changed", id, name=member.name, role=member.role, before=before)
    return member


def remove_member(database: Database, who: Principal, id: str) -> None:
    """Remove a member with all their keys and sessions; what they made stays.

    Raises
    ------
    NotFound, LastOwner
        There is no such member, or nobody would be an owner.
    """
    now = time.time()
    with database.writing() as session:
        member = _member(session, who, id)
        _keep_an_owner(session, member)
        member.removed = now
        session.execute(update(KeyRow).where(KeyRow.member == id, KeyRow.revoked.is_(None)).values(revoked=now))
        session.execute(delete(SessionRow).where(SessionRow.member == id))
        record(session, "member.removed", id, name=member.name)


def _team(session: Session, who: Principal, lock: bool = False) -> TeamRow:
    found = session.get(TeamRow, who.team, with_for_update=lock)
    if found is None:
        raise NotFound("team")
    return found


def _member(session: Session, who: Principal, id: str) -> MemberRow:
    """Return a member of the team, which is locked: two owners may remove each other at the same time."""
    _team(session, who, lock=True)
    found = session.scalars(select(MemberRow).where(MemberRow.id == id, MemberRow.removed.is_(None))).first()
    if found is None:
        raise NotFound("member")
    return found


def _keep_an_owner(session: Session, leaving: MemberRow) -> None:
    """Raise where a member is the only owner of their team."""
    others = select(func.count()).where(
        MemberRow.role == "owner", MemberRow.removed.is_(None), MemberRow.id != leaving.id
    )
    if leaving.role == "owner" and not session.scalar(others):
        raise LastOwner
