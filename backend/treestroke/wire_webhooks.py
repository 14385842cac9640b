"""Requests about webhooks: the one description that checks them and that the API follows."""

from typing import Annotated, Any

from pydantic import ConfigDict, Field, Strict
from pydantic.json_schema import SkipJsonSchema

from treestroke.webhook_schemas import JOB_EVENTS, JobEvent
from treestroke.wire_strokes import RequestPart, no_default

MAX_URL = 2000
Url = Annotated[str, Strict(), Field(min_length=1, max_length=MAX_URL)]
Events = Annotated[list[JobEvent], Field(min_length=1, max_length=len(JOB_EVENTS))]
_EXAMPLE: dict[str, Any] = {
    "url": f"https:{'//'}studio.example/hooks/trees",
    "events": ["model.succeeded", "model.failed"],
}


class WebhookRequest(RequestPart):
    """A webhook to be made."""

    model_config = ConfigDict(json_schema_extra={"example": _EXAMPLE})

    url: Url
    events: Events


class WebhookChange(RequestPart):
    """What is to be changed of a webhook; ``rotate`` gives it a new secret."""

    model_config = ConfigDict(json_schema_extra={"example": {"enabled": True}, "minProperties": 1})

    url: Url | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
    events: Events | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
    enabled: Annotated[bool, Strict()] | SkipJsonSchema[None] = Field(default=None, json_schema_extra=no_default)
    rotate: Annotated[bool, Strict()] = False
