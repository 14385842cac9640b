"""Keys from the command line: how a team and its first owner begin, and how an operator revokes any key."""

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from sqlalchemy import select
from sqlalchemy.orm import Session

from treestroke.account_schemas import Role
from treestroke.core.errors import SettingsError
from treestroke.service.keys import MadeKey, end_key, make_key
from treestroke.service.principals import Principal
from treestroke.store.account_tables import KeyRow, MemberRow, TeamRow
from treestroke.store.audit import operator_of, record
from treestroke.store.database import Database
from treestroke.store.queries import new_id
from treestroke.store.scope import SERVICE
from treestroke.wire_accounts import KeyRequest


@dataclass(frozen=True)
class Person:
    """Whose key it is to be: team and member by name or id, and the role of a member who is new."""

    team: str
    member: str
    role: Role | None


class ListedKey(NamedTuple):
    """A key with its member and team."""

    key: KeyRow
    member: MemberRow
    team: TeamRow


def add_key(database: Database, secret: str, person: Person, wanted: KeyRequest) -> MadeKey:
    """Make a key; team and member are made where they are new. The first member of a team is its owner.

    Raises
    ------
    SettingsError
        Several have this name, or the member is there with another role.
    """
    with database.of(SERVICE).writing() as session:
        member = _member_of(session, _team_of(session, person.team), person)
    who = Principal(member.id, member.team, member.name, "owner")
    return make_key(database.of(operator_of(member.team)), secret, who, wanted)


def list_all_keys(database: Database, team: str) -> Sequence[ListedKey]:
    """Return the keys of a team by name or id, or of all teams where ``team`` is empty, the newest first."""
    found = (
        select(KeyRow, MemberRow, TeamRow)
        .join(MemberRow, MemberRow.id == KeyRow.member)
        .join(TeamRow, TeamRow.team == KeyRow.team)
    )
    if team:
        found = found.where((TeamRow.name == team) | (TeamRow.team == team))
    with database.of(SERVICE).reading() as session:
        return [ListedKey(*row) for row in session.execute(found.order_by(KeyRow.created.desc(), KeyRow.id))]


def revoke_any_key(database: Database, id: str) -> None:
    """Revoke a key; a revoked one stays as it is.

    Raises
    ------
    SettingsError
        There is no such key.
    """
    with database.of(SERVICE).writing() as session:
        key = session.get(KeyRow, id)
        if key is None:
            raise SettingsError(f"{id}: there is no such key; `treestroke keys list` names all")
        end_key(session, id, operator_of(key.team))


def _team_of(session: Session, name: str) -> TeamRow:
    """Return a team, which is made where there is none of this name."""
    found = session.scalars(select(TeamRow).where((TeamRow.name == name) | (TeamRow.team == name))).all()
    if len(found) > 1:
        raise SettingsError(
            f"--team {name}: several teams have this name; give one's id: {_ids(t.team for t in found)}"
        )
    if found:
        return found[0]
    team = TeamRow(team=new_id("team"), name=name, created=time.time())
    session.add(team)
    record(session, "team.made", team.team, operator_of(team.team), name=name)
    return team


def _member_of(session: Session, team: TeamRow, person: Person) -> MemberRow:
    """Return a member of a team, who is made where there is none of this name."""
    members = session.scalars(select(MemberRow).where(MemberRow.team == team.team, MemberRow.removed.is_(None))).all()
    found = [member for member in members if person.member in (member.name, member.id)]
    if len(found) > 1:
        ids = _ids(member.id for member in found)
        raise SettingsError(f"--member {person.member}: several members have this name; give one's id: {ids}")
    if not found:
        role = person.role or ("member" if members else "owner")
        row = MemberRow(id=new_id("usr"), team=team.team, name=person.member, role=role, created=time.time())
        session.add(row)
        record(session, "member.added", row.id, operator_of(team.team), name=row.name, role=role)
        return row
    if person.role not in (None, found[0].role):
        raise SettingsError(
            f"--role {person.role}: {person.member} is a member with the role {found[0].role}; leave --role out, or "
            "let an owner change it in the page"
        )
    return found[0]


def _ids(ids: Iterable[str]) -> str:
    return ", ".join(sorted(ids))
