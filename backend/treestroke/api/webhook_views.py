"""Webhooks and the messages to them as the API shows them."""

from treestroke.service.webhooks import Told
from treestroke.store.times import iso_time
from treestroke.store.webhook_tables import DeliveryRow
from treestroke.webhook_schemas import DeliveryInfo, WebhookInfo, WebhookSecret


def webhook_view(told: Told) -> WebhookInfo:
    """Return a webhook as the API shows it."""
    row = told.row
    return WebhookInfo(
        id=row.id,
        url=row.url,
        events=row.events,  # type: ignore[arg-type]
        enabled=row.enabled,
        disabled_reason=row.disabled_reason,  # type: ignore[arg-type]
        created=iso_time(row.created),
        last_delivery=None if told.last is None else delivery_view(told.last),
    )


def webhook_with_secret(told: Told) -> WebhookSecret:
    """Return a webhook that was just made or changed, with its secret where that is new."""
    return WebhookSecret(**webhook_view(told).model_dump(), secret=told.secret)


def delivery_view(row: DeliveryRow) -> DeliveryInfo:
    """Return a message to a webhook as the API shows it."""
    return DeliveryInfo(
        id=row.id,
        event=row.event,  # type: ignore[arg-type]
        state=row.state,  # type: ignore[arg-type]
        attempts=row.attempts,
        status=row.last_status,
        error=row.last_error,
        seconds=row.last_seconds,
        created=iso_time(row.created),
        last_attempt=None if row.last_attempt is None else iso_time(row.last_attempt),
        next_attempt=iso_time(row.due) if row.state == "waiting" and row.due else None,
    )
