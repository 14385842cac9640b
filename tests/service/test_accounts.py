import time

import pytest
from sqlalchemy import select, update
from tests.accounts import accounts, make
from tests.plans import planned, scans

from treestroke.service.accounts import SESSION_SECONDS, Unauthenticated, find_revoked
from treestroke.service.key_format import new_key
from treestroke.service.keys import revoke_key
from treestroke.service.members import change_member, remove_member
from treestroke.store.account_tables import KeyRow, MemberRow, SessionRow
from treestroke.store.database import Database
from treestroke.store.scope import SERVICE


def write(database: Database, statement: object) -> None:
    with database.of(SERVICE).writing() as session:
        session.execute(statement)  # type: ignore[call-overload]


def test_who_has_a_key_is_its_member_with_its_scopes(database: Database) -> None:
    made = make(database, "Ann", scopes=["trees"], read_only=True)
    who = accounts(database).by_key(made.key)
    assert (who.id, who.team, who.name, who.role) == (made.member.id, made.member.team, "Ann", "owner")
    assert (who.scopes, who.read_only, who.credential) == ({"trees"}, True, made.row.id)
    assert who.expires == pytest.approx(time.time() + 90 * 86_400, abs=60)


def test_a_key_is_stored_nowhere(database: Database) -> None:
    made = make(database)
    token, _ = accounts(database).sign_in(made.key)
    database.close()
    content = b"".join(path.read_bytes() for path in database.path.parent.iterdir() if path.is_file())
    assert made.row.id.encode() in content
    assert made.key[7:].encode() not in content
    assert token.encode() not in content


@pytest.mark.parametrize("wrong", [new_key(), new_key()[:-1], "", "ts_", "x" * 10_000], ids=range(5))
def test_nobody_has_another_key(database: Database, wrong: str) -> None:
    make(database)
    with pytest.raises(Unauthenticated):
        accounts(database).by_key(wrong)


def test_a_mistyped_key_is_told_without_asking_the_database(database: Database) -> None:
    key = new_key()
    database.path.unlink()
    with pytest.raises(Unauthenticated, match="mistyped"):
        accounts(database).by_key(f"{key[:-1]}{'b' if key[-1] == 'a' else 'a'}")


def test_with_another_secret_no_key_is_valid(database: Database) -> None:
    made = make(database)
    with pytest.raises(Unauthenticated):
        type(accounts(database)).of(database, "another secret, which is long enough too").by_key(made.key)


@pytest.mark.parametrize("ending", ["revoked", "expired", "removed"])
def test_whatever_ends_a_key_ends_the_session_that_began_with_it(database: Database, ending: str) -> None:
    owner, made = make(database, "Olga"), make(database, "Ann")
    known, who = accounts(database), accounts(database).by_key(owner.key)
    token, person = known.sign_in(made.key)
    assert known.by_session(token).id == known.by_key(made.key).id == made.member.id
    own = {"", owner.row.id, made.row.id, person.credential}
    assert find_revoked(database, own) == set()
    if ending == "revoked":
        revoke_key(database.of(who.scope), who, made.row.id)
    elif ending == "expired":
        write(database, update(KeyRow).where(KeyRow.id == made.row.id).values(expires=time.time() - 1))
    else:
        remove_member(database.of(who.scope), who, made.member.id)
    for ask in (lambda: known.by_key(made.key), lambda: known.by_session(token)):
        with pytest.raises(Unauthenticated):
            ask()
    assert find_revoked(database, {*own, "key_unknown"}) == {made.row.id, person.credential, "key_unknown"}


def test_a_session_ends_by_itself_and_is_removed_when_somebody_signs_in(database: Database) -> None:
    made, known = make(database), accounts(database)
    token, person = known.sign_in(made.key)
    assert person.expires == pytest.approx(time.time() + SESSION_SECONDS, abs=60)
    write(database, update(SessionRow).values(expires=time.time() - 1))
    assert find_revoked(database, [person.credential]) == {person.credential}
    with pytest.raises(Unauthenticated):
        known.by_session(token)
    known.sign_in(made.key)
    with database.of(SERVICE).reading() as session:
        assert person.credential not in session.scalars(select(SessionRow.id)).all()


def test_a_session_ends_no_later_than_its_key(database: Database) -> None:
    made = make(database, days=1)
    _, person = accounts(database).sign_in(made.key)
    assert person.expires == pytest.approx(made.row.expires)


def test_each_sign_in_is_a_session_of_its_own_which_can_be_ended(database: Database) -> None:
    made, known = make(database), accounts(database)
    (first, _), (second, _) = known.sign_in(made.key), known.sign_in(made.key)
    assert first != second
    known.sign_out(first)
    known.sign_out("no session at all")
    with pytest.raises(Unauthenticated):
        known.by_session(first)
    assert known.by_session(second).id == made.member.id


def test_a_role_is_that_of_the_row_at_each_request(database: Database) -> None:
    owner, made, known = make(database, "Olga"), make(database, "Ann"), accounts(database)
    token, _ = known.sign_in(made.key)
    who = known.by_key(owner.key)
    change_member(database.of(who.scope), who, made.member.id, b'{"role": "viewer"}')
    assert (known.by_key(made.key).role, known.by_session(token).role) == ("viewer", "viewer")


def test_the_use_of_a_key_is_written_down_once_a_minute(database: Database) -> None:
    made, known = make(database), accounts(database)

    def last_used() -> float | None:
        with database.of(SERVICE).reading() as session:
            return session.get_one(KeyRow, made.row.id).last_used

    assert last_used() is None
    known.by_key(made.key)
    first = last_used()
    assert first == pytest.approx(time.time(), abs=60)
    known.by_key(made.key)
    assert last_used() == first
    write(database, update(KeyRow).values(last_used=time.time() - 61))
    known.by_key(made.key)
    assert (last_used() or 0) >= (first or 0)


def test_no_request_reads_a_whole_table(database: Database) -> None:
    made, known = make(database), accounts(database)
    token, person = known.sign_in(made.key)
    with planned() as steps:
        known.by_key(made.key)
        known.by_session(token)
        find_revoked(database, [made.row.id, person.credential])
    assert steps
    assert scans(steps) == []


def test_removed_members_keep_their_names(database: Database) -> None:
    owner, made = make(database, "Olga"), make(database, "Ann")
    who = accounts(database).by_key(owner.key)
    remove_member(database.of(who.scope), who, made.member.id)
    with database.of(who.scope).reading() as session:
        assert session.get_one(MemberRow, made.member.id).name == "Ann"
