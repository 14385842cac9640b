"""What the service sends of webhooks in its responses, for its documents and its clients."""

from typing import Literal, get_args

from pydantic import Field

from treestroke.wire_strokes import Wire

JobEvent = Literal["model.succeeded", "model.failed", "model.canceled", "capture.solved", "capture.failed"]
JOB_EVENTS: tuple[JobEvent, ...] = get_args(JobEvent)
"""What a webhook may be told of jobs."""
PING: Literal["ping"] = "ping"
DeliveryState = Literal["waiting", "delivered", "failed", "blocked", "canceled"]


class DeliveryInfo(Wire):
    """A message to a webhook, and what became of it."""

    id: str = Field(description="the header webhook-id of all attempts")
    event: JobEvent | Literal["ping"]
    state: DeliveryState
    attempts: int = Field(description="how often it was sent")
    status: int | None = Field(description="HTTP status of the last answer")
    error: str | None = Field(description="why the last attempt failed")
    seconds: float | None = Field(description="how long the last attempt took")
    created: str
    last_attempt: str | None
    next_attempt: str | None = Field(description="when it is sent again; null where it is not, or is about to be")


class DeliveryList(Wire):
    """A page of the messages to a webhook, newest first."""

    deliveries: list[DeliveryInfo]
    next: str | None


class WebhookInfo(Wire):
    """An address that is told about the team's jobs."""

    id: str
    url: str
    events: list[JobEvent]
    enabled: bool
    disabled_reason: Literal["gone", "failing"] | None = Field(
        description="why the service disabled it: it answered 410, or five messages in a row were given up"
    )
    created: str
    last_delivery: DeliveryInfo | None = Field(description="the newest message to it")


class WebhookSecret(WebhookInfo):
    """A webhook with its secret, which is shown where it was just made and nowhere else."""

    secret: str | None = Field(description="whsec_..., by which messages are signed; null where it was not made anew")


class WebhookList(Wire):
    """The webhooks of a team, the first one first."""

    webhooks: list[WebhookInfo]
