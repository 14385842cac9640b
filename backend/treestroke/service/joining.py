"""Who comes with an issuer's word: the member that they are, or become where newcomers are taken."""

import time
from dataclasses import dataclass

import structlog
from sqlalchemy import select
from sqlalchemy.orm import Session

from treestroke.account_schemas import Role
from treestroke.limits import MAX_NAME
from treestroke.service.principals import Principal
from treestroke.store.account_tables import MemberRow, TeamRow
from treestroke.store.audit import record
from treestroke.store.database import Database
from treestroke.store.queries import new_id
from treestroke.store.scope import SERVICE, Scope

log = structlog.get_logger()


class NotMember(Exception):
    """Somebody is in no team, and does not come into one by signing in."""


@dataclass(frozen=True)
class Vouched:
    """A person for whom an issuer vouches; ``issuer`` and ``subject`` together are theirs for good, a name is not."""

    issuer: str
    subject: str
    name: str


def join(database: Database, person: Vouched, team: str, role: Role) -> Principal:
    """Return the member that somebody is; who is new joins a team, by its name or id, with a role.

    Raises
    ------
    NotMember
        They were removed, or are new and there is no such team.
    """
    with database.of(SERVICE).writing() as session:
        member = _find(session, person) or _add(session, person, team, role)
        if member.removed is not None:
            raise NotMember
    return Principal(member.id, member.team, member.name, member.role)  # type: ignore[arg-type]


def _find(session: Session, person: Vouched) -> MemberRow | None:
    known = select(MemberRow).where(MemberRow.issuer == person.issuer, MemberRow.subject == person.subject)
    return session.scalars(known).first()


def _add(session: Session, person: Vouched, name: str, role: Role) -> MemberRow:
    """Return a new member of a team, which is locked: somebody may sign in in two browsers at once."""
    if not name:
        raise NotMember
    named = select(TeamRow).where((TeamRow.name == name) | (TeamRow.team == name)).with_for_update()
    teams = session.scalars(named).all()
    if len(teams) != 1:
        log.error("oidc_team_unclear", team=name, found=len(teams), mend="TREESTROKE_OIDC_TEAM: give the id of one")
        raise NotMember
    if meanwhile := _find(session, person):
        return meanwhile
    member = MemberRow(
        id=new_id("usr"),
        team=teams[0].team,
        name=person.name[:MAX_NAME],
        role=role,
        issuer=person.issuer,
        subject=person.subject,
        created=time.time(),
    )
    session.add(member)
    by = Scope(member.team, member.id, credential="issuer")
    record(session, "member.added", member.id, by, name=member.name, role=role)
    return member
