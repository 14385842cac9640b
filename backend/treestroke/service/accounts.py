"""Who comes with a key or a session: found by its digest, with the role that their row has now."""

import secrets
import time
from collections.abc import Collection
from contextlib import suppress
from dataclasses import dataclass, replace

from sqlalchemy import Select, and_, delete, or_, select, update
from sqlalchemy.exc import OperationalError

from treestroke.account_schemas import Role
from treestroke.codec.refusals import checked
from treestroke.core.errors import TreestrokeError
from treestroke.service.key_format import digest_of, is_key
from treestroke.service.model_request import read_body
from treestroke.service.principals import SCOPES, Principal
from treestroke.store.account_tables import KeyRow, MemberRow, SessionRow
from treestroke.store.audit import record
from treestroke.store.database import Database
from treestroke.store.queries import new_id
from treestroke.store.scope import SERVICE, Scope
from treestroke.wire_accounts import SignIn

SESSION_SECONDS = 7 * 86_400.0
"""How long a browser stays signed in."""
_NOTED_SECONDS = 60.0
"""How often the use of a key is written down."""


class Unauthenticated(Exception):
    """Nobody is known by this key or session; the message says what to do."""


@dataclass(frozen=True)
class Accounts:
    """Keys and sessions of all teams, and the secret by which they are digested."""

    database: Database
    secret: str

    @classmethod
    def of(cls, database: Database, secret: str) -> "Accounts":
        """Return the accounts of a database."""
        return cls(database.of(SERVICE), secret)

    def by_key(self, key: str) -> Principal:
        """Return who has this key.

        Raises
        ------
        Unauthenticated
            It was mistyped, or is unknown, revoked or expired.
        """
        if not is_key(key):
            raise Unauthenticated("this is no key, or it was mistyped; copy it again, it begins with ts_")
        now = time.time()
        with self.database.reading() as session:
            found = session.execute(_valid_keys(now).where(KeyRow.digest == digest_of(self.secret, key))).first()
        if found is None:
            raise Unauthenticated("this key is unknown, revoked or expired; ask an owner of the team for another")
        row, member = found
        if row.last_used is None or row.last_used < now - _NOTED_SECONDS:
            self._note(row.id, now)
        return _principal(member, row, row.id, row.expires)

    def by_session(self, token: str) -> Principal:
        """Return who has signed in with this session's token.

        Raises
        ------
        Unauthenticated
            The session has ended, or its key or member is no longer valid.
        """
        with self.database.reading() as session:
            own = SessionRow.digest == digest_of(self.secret, token)
            found = session.execute(_valid_sessions(time.time()).where(own)).first()
        if found is None:
            raise Unauthenticated("you are no longer signed in; sign in again")
        row, member, key = found
        return _principal(member, key, row.id, row.expires)

    def sign_in(self, key: str) -> tuple[str, Principal]:
        """Begin a session by a key; return the session's new token, and who has it.

        Raises
        ------
        Unauthenticated
            As `by_key`.
        """
        try:
            by = self.by_key(key)
        except Unauthenticated:
            self._record_refusal(key)
            raise
        return self.begin(by, by.credential)

    def begin(self, who: Principal, key: str | None) -> tuple[str, Principal]:
        """Begin a session of somebody who is known, perhaps by a key, with which it ends; remove those that ended."""
        token, now = secrets.token_urlsafe(32), time.time()
        row = SessionRow(
            id=new_id("ses"),
            team=who.team,
            member=who.id,
            key=key,
            digest=digest_of(self.secret, token),
            created=now,
            expires=min(now + SESSION_SECONDS, who.expires or now + SESSION_SECONDS),
        )
        with self.database.writing() as session:
            session.execute(delete(SessionRow).where(SessionRow.expires < now))
            session.add(row)
            record(session, "signed_in", who.id, who.scope, session=row.id)
        return token, self.by_session(token)

    def sign_out(self, token: str) -> None:
        """End a session, if there is one."""
        with self.database.writing() as session:
            own = delete(SessionRow).where(SessionRow.digest == digest_of(self.secret, token))
            ended = session.execute(own.returning(SessionRow.id, SessionRow.team, SessionRow.member)).all()
            for id, team, who in ended:
                record(session, "signed_out", who, Scope(team, who, credential=id), session=id)

    def _record_refusal(self, key: str) -> None:
        """Record that somebody tried to sign in by a key that is valid no more; of an unknown one no team is known."""
        with self.database.reading() as session:
            found = session.scalars(select(KeyRow).where(KeyRow.digest == digest_of(self.secret, key))).first()
        if found is not None:
            by = Scope(found.team, SERVICE.maker, credential=found.id)
            with self.database.writing() as session:
                record(session, "sign_in.refused", found.id, by, name=found.name, member=found.member)

    def _note(self, key: str, now: float) -> None:
        """Write down that a key was used; it is no less valid where that cannot be written."""
        with suppress(OperationalError), self.database.writing() as session:
            session.execute(update(KeyRow).where(KeyRow.id == key).values(last_used=now))


def read_sign_in(body: bytes) -> str:
    """Return the key that a request to sign in holds.

    Raises
    ------
    TreestrokeError
        It is not such a request.
    """
    return checked(SignIn, read_body(body), TreestrokeError).key


def find_revoked(database: Database, credentials: Collection[str]) -> set[str]:
    """Return those of some ids of keys and sessions that are no longer valid, whatever ended them.

    The only person of a service without keys has none: "" is always valid.
    """
    now = time.time()
    with database.of(SERVICE).reading() as session:
        keys = session.scalars(_valid_keys(now).with_only_columns(KeyRow.id).where(KeyRow.id.in_(credentials)))
        sessions = session.scalars(
            _valid_sessions(now).with_only_columns(SessionRow.id).where(SessionRow.id.in_(credentials))
        )
        return set(credentials) - {"", *keys, *sessions}


def _valid_keys(now: float) -> Select[KeyRow, MemberRow]:
    return (
        select(KeyRow, MemberRow)
        .join(MemberRow, MemberRow.id == KeyRow.member)
        .where(MemberRow.removed.is_(None), KeyRow.revoked.is_(None), KeyRow.expires > now)
    )


def _valid_sessions(now: float) -> Select[SessionRow, MemberRow, KeyRow]:
    by_valid_key = and_(KeyRow.revoked.is_(None), KeyRow.expires > now)
    return (
        select(SessionRow, MemberRow, KeyRow)
        .join(MemberRow, MemberRow.id == SessionRow.member)
        .outerjoin(KeyRow, KeyRow.id == SessionRow.key)
        .where(MemberRow.removed.is_(None), SessionRow.expires > now, or_(SessionRow.key.is_(None), by_valid_key))
    )


def _principal(member: MemberRow, key: KeyRow | None, credential: str, expires: float) -> Principal:
    """Return a member as what they came with lets them act; without a key, as their role alone does."""
    role: Role = member.role  # type: ignore[assignment]
    who = Principal(member.id, member.team, member.name, role, credential=credential, expires=expires)
    if key is None:
        return who
    scopes = frozenset(scope for scope in SCOPES if scope in key.scopes.split())
    return replace(who, scopes=scopes, read_only=key.read_only)
