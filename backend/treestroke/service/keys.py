"""Keys of members: listed, made and revoked."""

import time
from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from treestroke.codec.refusals import checked
from treestroke.core.errors import TreestrokeError
from treestroke.service.key_format import beginning_of, digest_of, new_key
from treestroke.service.model_request import read_body
from treestroke.service.photos import NotFound
from treestroke.service.principals import Principal
from treestroke.store.account_tables import KeyRow, MemberRow
from treestroke.store.audit import record
from treestroke.store.database import Database
from treestroke.store.queries import new_id
from treestroke.store.scope import Scope
from treestroke.wire_accounts import KeyRequest

_DAY_SECONDS = 86_400.0


class Exceeded(Exception):
    """A key was asked for that may do what its maker may not: the name of a scope."""


@dataclass(frozen=True)
class MadeKey:
    """A key that was just made, with what is shown of it once."""

    row: KeyRow
    member: MemberRow
    key: str


def list_keys(database: Database, who: Principal) -> Sequence[tuple[KeyRow, MemberRow]]:
    """Return keys with their members, the newest first: an owner sees all of the team, others their own."""
    found = select(KeyRow, MemberRow).join(MemberRow, MemberRow.id == KeyRow.member)
    if who.role != "owner":
        found = found.where(KeyRow.member == who.id)
    with database.reading() as session:
        return [(key, member) for key, member in session.execute(found.order_by(KeyRow.created.desc(), KeyRow.id))]


def read_key_request(body: bytes) -> KeyRequest:
    """Return the key that a request asks for.

    Raises
    ------
    TreestrokeError
        It is not such a request.
    """
    return checked(KeyRequest, read_body(body), TreestrokeError)


def make_key(database: Database, secret: str, who: Principal, wanted: KeyRequest) -> MadeKey:
    """Make a key of one's own, or as an owner of any member; it has no scope that its maker does not have.

    Raises
    ------
    NotFound
        There is no such member, or it is not for this person to make keys of theirs.
    Exceeded
        It would have a scope that its maker does not have.
    """
    owner = wanted.member or who.id
    if beyond := sorted(set(wanted.scopes) - who.scopes):
        raise Exceeded(beyond[0])
    key, now = new_key(), time.time()
    with database.writing() as session:
        member = session.scalars(select(MemberRow).where(MemberRow.id == owner, MemberRow.removed.is_(None))).first()
        if member is None or (who.role != "owner" and owner != who.id):
            raise NotFound("member")
        row = KeyRow(
            id=new_id("key"),
            member=owner,
            name=wanted.name,
            beginning=beginning_of(key),
            digest=digest_of(secret, key),
            scopes=" ".join(sorted(set(wanted.scopes), reverse=True)),
            read_only=wanted.read_only,
            created=now,
            expires=now + wanted.days * _DAY_SECONDS,
        )
        session.add(row)
        about = {"name": row.name, "scopes": row.scopes, "read_only": row.read_only, "days": wanted.days}
        record(session, "key.made", row.id, member=owner, **about)
    return MadeKey(row, member, key)


def revoke_key(database: Database, who: Principal, id: str) -> None:
    """Revoke a key of one's own, or as an owner any of the team; a revoked one stays as it is.

    Raises
    ------
    NotFound
        There is no such key for this person.
    """
    own = [KeyRow.id == id] if who.role == "owner" else [KeyRow.id == id, KeyRow.member == who.id]
    with database.writing() as session:
        if session.scalars(select(KeyRow.id).where(*own)).first() is None:
            raise NotFound("key")
        end_key(session, id)


def end_key(session: Session, id: str, by: Scope | None = None) -> None:
    """Revoke a key in a session, and record who did it: whose session it is, or ``by``."""
    valid = update(KeyRow).where(KeyRow.id == id, KeyRow.revoked.is_(None)).values(revoked=time.time())
    for name, member in session.execute(valid.returning(KeyRow.name, KeyRow.member)).all():
        record(session, "key.revoked", id, by, name=name, member=member)
