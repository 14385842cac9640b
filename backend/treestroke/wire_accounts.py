"""Requests about teams, members, keys and sessions: the one description that checks them and that the API follows."""

from typing import Annotated

from pydantic import ConfigDict, Field, Strict
from pydantic.json_schema import SkipJsonSchema

from treestroke.account_schemas import KeyScope, Role
from treestroke.limits import MAX_ID, MAX_NAME
from treestroke.wire_requests import NAME_PATTERN
from treestroke.wire_strokes import RequestPart, no_default

MAX_DAYS, USUAL_DAYS = 365, 90
_LONGEST_KEY = 200
Title = Annotated[str, Strict(), Field(min_length=1, max_length=MAX_NAME, pattern=NAME_PATTERN)]
"""A name that is not empty."""
Days = Annotated[int, Strict(), Field(ge=1, le=MAX_DAYS)]


class SignIn(RequestPart):
    """A key to sign in with."""

    model_config = ConfigDict(json_schema_extra={"example": {"key": "ts_..."}})

    key: Annotated[str, Strict(), Field(max_length=_LONGEST_KEY)]


class KeyRequest(RequestPart):
    """A key to be made."""

    model_config = ConfigDict(json_schema_extra={"example": {"name": "render farm", "read_only": True, "days": 30}})

    name: Title
    member: Annotated[str, Strict(), Field(max_length=MAX_ID)] | SkipJsonSchema[None] = Field(
        default=None, description="id of whose it is to be; your own where absent", json_schema_extra=no_default
    )
    scopes: Annotated[list[KeyScope], Field(min_length=1, max_length=2)] = Field(default=["trees"])
    read_only: Annotated[bool, Strict()] = False
    days: Days = USUAL_DAYS


class MemberRequest(RequestPart):
    """A member to be added to the team."""

    model_config = ConfigDict(json_schema_extra={"example": {"name": "Ann", "role": "member"}})

    name: Title
    role: Role = "member"


class MemberChange(RequestPart):
    """What is to be changed of a member."""

    model_config = ConfigDict(json_schema_extra={"example": {"role": "viewer"}, "minProperties": 1})

    name: Title | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
    role: Role | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)


class TeamChange(RequestPart):
    """The new name of a team."""

    model_config = ConfigDict(json_schema_extra={"example": {"name": "Oak studio"}})

    name: Title
