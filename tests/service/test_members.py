import pytest
from tests.accounts import accounts, make

from treestroke.core.errors import TreestrokeError
from treestroke.service import members
from treestroke.service.members import LastOwner
from treestroke.service.photos import NotFound
from treestroke.service.principals import Principal
from treestroke.store.database import Database


@pytest.fixture
def olga(database: Database) -> Principal:
    """The owner of a team beside which there is another."""
    make(database, "Eve", team="Elms")
    return accounts(database).by_key(make(database, "Olga").key)


def test_members_are_listed_added_changed_and_removed(database: Database, olga: Principal) -> None:
    own = database.of(olga.scope)
    ben = members.add_member(own, b'{"name": "Ben"}')
    assert [(row.name, row.role) for row in members.list_members(own)] == [("Olga", "owner"), ("Ben", "member")]
    changed = members.change_member(own, olga, ben.id, b'{"role": "viewer", "name": "Benno"}')
    assert (changed.name, changed.role) == ("Benno", "viewer")
    assert members.change_member(own, olga, ben.id, b"{}").role == "viewer"
    members.remove_member(own, olga, ben.id)
    assert [row.name for row in members.list_members(own)] == ["Olga"]
    with pytest.raises(NotFound, match="member"):
        members.change_member(own, olga, ben.id, b'{"role": "owner"}')


def test_the_last_owner_stays_one(database: Database, olga: Principal) -> None:
    own = database.of(olga.scope)
    with pytest.raises(LastOwner):
        members.remove_member(own, olga, olga.id)
    with pytest.raises(LastOwner):
        members.change_member(own, olga, olga.id, b'{"role": "member"}')
    assert members.change_member(own, olga, olga.id, b'{"name": "Olga B.", "role": "owner"}').name == "Olga B."
    second = members.add_member(own, b'{"name": "Ben", "role": "owner"}')
    members.change_member(own, olga, olga.id, b'{"role": "member"}')
    with pytest.raises(LastOwner):
        members.remove_member(own, olga, second.id)


def test_an_owner_who_was_removed_counts_no_more(database: Database, olga: Principal) -> None:
    own = database.of(olga.scope)
    second = members.add_member(own, b'{"name": "Ben", "role": "owner"}')
    members.remove_member(own, olga, second.id)
    with pytest.raises(LastOwner):
        members.remove_member(own, olga, olga.id)


def test_a_team_is_renamed_by_its_own_name_alone(database: Database, olga: Principal) -> None:
    own = database.of(olga.scope)
    assert members.rename_team(own, olga, b'{"name": "Old oaks"}').name == "Old oaks"
    assert members.get_team(own, olga).name == "Old oaks"
    eve = accounts(database).by_key(make(database, "Eve", team="Elms").key)
    assert members.get_team(database.of(eve.scope), eve).name == "Elms"


@pytest.mark.parametrize("body", [b'{"name": ""}', b"{}", b'{"name": "x", "role": "king"}', b'{"name": null}', b"1"])
def test_what_is_no_member_is_refused(database: Database, olga: Principal, body: bytes) -> None:
    with pytest.raises(TreestrokeError):
        members.add_member(database.of(olga.scope), body)
