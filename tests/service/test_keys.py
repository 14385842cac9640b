import pytest
from tests.accounts import SECRET, accounts, make

from treestroke.core.errors import SettingsError, TreestrokeError
from treestroke.service.keys import Exceeded, list_keys, make_key, read_key_request, revoke_key
from treestroke.service.photos import NotFound
from treestroke.service.principals import Principal
from treestroke.service.team_setup import list_all_keys, revoke_any_key
from treestroke.store.database import Database
from treestroke.wire_accounts import KeyRequest


def person(database: Database, *member: str, **more: object) -> Principal:
    return accounts(database).by_key(make(database, *member, **more).key)  # type: ignore[arg-type]


def test_an_owner_sees_all_keys_of_the_team_and_others_their_own(database: Database) -> None:
    olga, ann, other = person(database, "Olga"), person(database, "Ann"), person(database, "Eve", team="Elms")
    for who, seen in ((olga, {"Olga", "Ann"}), (ann, {"Ann"}), (other, {"Eve"})):
        assert {member.name for _, member in list_keys(database.of(who.scope), who)} == seen


def test_an_owner_makes_keys_for_any_member_and_others_for_themselves(database: Database) -> None:
    olga, ann, other = person(database, "Olga"), person(database, "Ann"), person(database, "Eve", team="Elms")
    made = make_key(database.of(olga.scope), SECRET, olga, KeyRequest(name="for Ann", member=ann.id))
    assert accounts(database).by_key(made.key).id == ann.id
    assert make_key(database.of(ann.scope), SECRET, ann, KeyRequest(name="mine")).member.id == ann.id
    for who, member in ((ann, olga.id), (olga, other.id), (olga, "usr_nobody")):
        with pytest.raises(NotFound, match="member"):
            make_key(database.of(who.scope), SECRET, who, KeyRequest(name="not mine", member=member))


def test_a_key_makes_none_with_more_scopes(database: Database) -> None:
    who = person(database, "Olga", scopes=["team"])
    with pytest.raises(Exceeded, match="trees"):
        make_key(database.of(who.scope), SECRET, who, KeyRequest(name="more", scopes=["trees", "team"]))


def test_only_ones_own_keys_can_be_revoked_or_the_team_s_by_an_owner(database: Database) -> None:
    olga, ann, other = person(database, "Olga"), person(database, "Ann"), person(database, "Eve", team="Elms")
    for who, key in ((ann, olga.credential), (olga, other.credential), (ann, "key_nothing")):
        with pytest.raises(NotFound, match="key"):
            revoke_key(database.of(who.scope), who, key)
    revoke_key(database.of(olga.scope), olga, ann.credential)
    (first,) = [row.revoked for row, _ in list_keys(database.of(ann.scope), ann)]
    revoke_key(database.of(ann.scope), ann, ann.credential)
    assert [row.revoked for row, _ in list_keys(database.of(ann.scope), ann)] == [first] != [None]


@pytest.mark.parametrize(
    "body",
    [
        b'{"name": ""}',
        b"{}",
        b'{"name": "x", "days": 0}',
        b'{"name": "x", "days": 366}',
        b'{"name": "x", "days": true}',
        b'{"name": "x", "scopes": []}',
        b'{"name": "x", "scopes": ["all"]}',
        b'{"name": "x", "read_only": "yes"}',
        b'{"name": "x\\ny"}',
        b'{"name": "x", "role": "owner"}',
        b"[]",
    ],
)
def test_what_is_no_request_for_a_key_is_refused(body: bytes) -> None:
    with pytest.raises(TreestrokeError):
        read_key_request(body)


def test_a_team_s_first_member_is_its_owner_and_the_next_ones_are_not(database: Database) -> None:
    assert [make(database, name).member.role for name in ("Ann", "Ben", "Ann")] == ["owner", "member", "owner"]
    assert make(database, "Cleo", "viewer").member.role == "viewer"
    assert len({found.team.team for found in list_all_keys(database, "")}) == 1
    with pytest.raises(SettingsError, match="a member with the role member"):
        make(database, "Ben", "owner")


def test_an_operator_sees_and_revokes_keys_of_all_teams(database: Database) -> None:
    ann, eve = make(database, "Ann"), make(database, "Eve", team="Elms")
    assert [found.key.id for found in list_all_keys(database, "")] == [eve.row.id, ann.row.id]
    assert [found.key.id for found in list_all_keys(database, "Elms")] == [eve.row.id]
    revoke_any_key(database, eve.row.id)
    assert [found.key.revoked is None for found in list_all_keys(database, "")] == [False, True]
    with pytest.raises(SettingsError, match="no such key"):
        revoke_any_key(database, "key_nothing")
