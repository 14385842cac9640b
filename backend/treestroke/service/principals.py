"""Who asks: a person or a key of a team, with a role and scopes."""

from dataclasses import dataclass

from treestroke.account_schemas import KeyScope, Role
from treestroke.store.scope import LOCAL, Removes, Scope

ROLES: tuple[Role, ...] = ("viewer", "member", "owner")
"""From the least that one may do to the most."""
_REMOVES: dict[Role, Removes] = {"viewer": "none", "member": "own", "owner": "all"}
SCOPES: tuple[KeyScope, ...] = ("trees", "team")
"""What a key may be for: trees, and all that they are made of; the team, its people and its keys."""


@dataclass(frozen=True)
class Principal:
    """Who asks, as what: ``id`` is that of a member, and of all that they make.

    A read-only one changes nothing, whatever its role. ``credential`` is the id of the key or session that they came
    with, which may be revoked.
    """

    id: str
    team: str
    name: str
    role: Role
    scopes: frozenset[KeyScope] = frozenset(SCOPES)
    read_only: bool = False
    credential: str = ""
    expires: float | None = None
    """When that ends, in seconds since 1970; None: never."""

    @property
    def scope(self) -> Scope:
        """Whose rows are seen, whose new ones are, and which may be deleted."""
        return Scope(self.team, self.id, _REMOVES[self.role], self.credential)


LOCAL_PERSON = Principal(LOCAL.maker, str(LOCAL.team), "", "owner")
"""The only person of a service without keys."""
