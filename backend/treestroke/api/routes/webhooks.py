"""Webhooks, and the messages to them."""

from http import HTTPStatus

from fastapi import APIRouter, Depends

from treestroke.api.deps import (
    Cursor,
    DeliveryId,
    JsonBody,
    Limit,
    ResourcesOf,
    SettingsOf,
    WebhookCallerOf,
    WebhookId,
    WebhookSenderOf,
    body_of,
    hosted_only,
)
from treestroke.api.errors import BODY, documented
from treestroke.api.webhook_views import delivery_view, webhook_view, webhook_with_secret
from treestroke.service import deliveries, webhooks
from treestroke.webhook_schemas import DeliveryInfo, DeliveryList, WebhookList, WebhookSecret

router = APIRouter(prefix="/v1", tags=["webhooks"], dependencies=[Depends(hosted_only)])


@router.get("/webhooks", responses=documented("not_hosted"))
def list_webhooks(resources: ResourcesOf) -> WebhookList:
    """List the team's webhooks, the first one first, each with the newest message to it."""
    return WebhookList(webhooks=[webhook_view(told) for told in webhooks.list_webhooks(resources.database)])


@router.post(
    "/webhooks",
    status_code=HTTPStatus.CREATED,
    responses=documented(*BODY, "not_hosted", "webhook_address", "too_many_webhooks", "storage_full"),
    openapi_extra=body_of("WebhookRequest"),
)
def make_webhook(
    resources: ResourcesOf, settings: SettingsOf, caller: WebhookCallerOf, body: JsonBody
) -> WebhookSecret:
    """Make a webhook. The answer alone holds its secret."""
    return webhook_with_secret(webhooks.make_webhook(resources.database, settings.secret, caller, body))


@router.patch(
    "/webhooks/{id}",
    responses=documented(*BODY, "not_hosted", "webhook_not_found", "webhook_address", "storage_full"),
    openapi_extra=body_of("WebhookChange"),
)
def change_webhook(
    resources: ResourcesOf, settings: SettingsOf, caller: WebhookCallerOf, id: WebhookId, body: JsonBody
) -> WebhookSecret:
    """Change a webhook's address or events, disable it, enable it again, or give it a new secret by `rotate`."""
    return webhook_with_secret(webhooks.change_webhook(resources.database, settings.secret, caller, id, body))


@router.delete(
    "/webhooks/{id}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=documented("not_hosted", "webhook_not_found", "storage_full"),
)
def remove_webhook(resources: ResourcesOf, id: WebhookId) -> None:
    """Remove a webhook with all messages to it."""
    webhooks.remove_webhook(resources.database, id)


@router.post(
    "/webhooks/{id}/ping",
    status_code=HTTPStatus.ACCEPTED,
    responses=documented("not_hosted", "webhook_not_found", "webhook_disabled", "storage_full"),
)
def ping_webhook(resources: ResourcesOf, sender: WebhookSenderOf, id: WebhookId) -> DeliveryInfo:
    """Send a message that tells nothing, once; the list of deliveries says what became of it."""
    row = deliveries.ping(resources.database, id)
    sender.notify()
    return delivery_view(row)


@router.get("/webhooks/{id}/deliveries", responses=documented("not_hosted", "webhook_not_found", "invalid"))
def list_deliveries(resources: ResourcesOf, id: WebhookId, cursor: Cursor = None, limit: Limit = 20) -> DeliveryList:
    """List the messages to a webhook, newest first."""
    rows, next_cursor = deliveries.list_deliveries(resources.database, id, cursor, limit)
    return DeliveryList(deliveries=[delivery_view(row) for row in rows], next=next_cursor)


@router.post(
    "/deliveries/{id}/resend",
    status_code=HTTPStatus.ACCEPTED,
    responses=documented("not_hosted", "delivery_not_found", "webhook_disabled", "storage_full"),
)
def resend_delivery(resources: ResourcesOf, sender: WebhookSenderOf, id: DeliveryId) -> DeliveryInfo:
    """Send a message again at once, by the same id."""
    row = deliveries.resend(resources.database, id)
    sender.notify()
    return delivery_view(row)
