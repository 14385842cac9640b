"""What the service sends of teams, members, keys and sessions in its responses, for its documents and its clients."""

from typing import Any, Literal

from pydantic import Field

from treestroke.schemas import MakerInfo
from treestroke.wire_strokes import Wire

Role = Literal["viewer", "member", "owner"]
KeyScope = Literal["trees", "team"]
_SECONDS = "seconds since 1970"


class Member(Wire):
    """A person of a team."""

    id: str
    name: str
    role: Role


class MemberInfo(Member):
    """A person of a team, as the list of members shows them."""

    created: float = Field(description=_SECONDS)


class MemberList(Wire):
    """All members of a team, the first one first."""

    members: list[MemberInfo]


class Team(Wire):
    """A team."""

    id: str
    name: str


class TeamInfo(Team):
    """A team, as its members see it."""

    created: float = Field(description=_SECONDS)


class SessionInfo(Wire):
    """Who is signed in, as what, and until when; in a service without keys, the only person of its only team."""

    hosted: bool = Field(description="whether the service has keys and teams")
    member: Member
    team: Team
    scopes: list[KeyScope]
    read_only: bool
    expires: float | None = Field(description=f"{_SECONDS}; null: never")


class SignInIssuer(Wire):
    """An issuer that people sign in at (OpenID Connect)."""

    name: str = Field(description="its host, as people know it")


class SignInWays(Wire):
    """How one may sign in beside by a key."""

    oidc: SignInIssuer | None = Field(description="null: by a key alone")


class KeyInfo(Wire):
    """A key, without itself."""

    id: str
    name: str
    beginning: str = Field(description="its first characters")
    member: Member = Field(description="whose it is")
    scopes: list[KeyScope]
    read_only: bool
    created: float = Field(description=_SECONDS)
    expires: float = Field(description=_SECONDS)
    last_used: float | None = Field(description=f"{_SECONDS}, to a minute; null: never used")
    revoked: float | None = Field(description=f"{_SECONDS}; null: it is valid until it expires")


class NewKey(KeyInfo):
    """A key that was just made: the only time that it is shown."""

    key: str


class KeyList(Wire):
    """Keys, the newest first."""

    keys: list[KeyInfo]


class AuditEntry(Wire):
    """Something that was done in a team."""

    id: str
    at: float = Field(description=_SECONDS)
    who: MakerInfo | None = Field(description="null: whoever runs the service, or somebody who is not known")
    credential: str = Field(description="id of the key or session that they came with, or `command line`")
    action: str
    subject: str = Field(description="id of what it was done to")
    details: dict[str, Any]
    address: str
    request_id: str


class AuditList(Wire):
    """What was done in a team, the newest first."""

    entries: list[AuditEntry]
    next: str | None = Field(description="`before` of the next page; null: there is no more")
