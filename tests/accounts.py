"""Teams, members and keys written without a service."""

from typing import Any

from treestroke.account_schemas import Role
from treestroke.service.accounts import Accounts
from treestroke.service.keys import MadeKey
from treestroke.service.team_setup import Person, add_key
from treestroke.store.database import Database
from treestroke.wire_accounts import KeyRequest

SECRET = "a secret of the tests, long enough to digest keys by"


def make(database: Database, member: str = "Ann", role: Role | None = None, team: str = "Oaks", **more: Any) -> MadeKey:
    """Make a key; team and member are made where they are new."""
    wanted = KeyRequest(**{"name": "test", "scopes": ["trees", "team"], **more})
    return add_key(database, SECRET, Person(team, member, role), wanted)


def accounts(database: Database) -> Accounts:
    return Accounts.of(database, SECRET)
