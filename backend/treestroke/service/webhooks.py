"""Webhooks: addresses that a team's owners have told about its jobs; listed, made, changed and removed."""

import secrets
import time
from collections.abc import Sequence
from dataclasses import dataclass

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session

from treestroke.codec.refusals import checked
from treestroke.core.errors import TreestrokeError
from treestroke.service.deliveries import disable
from treestroke.service.model_request import read_body
from treestroke.service.photos import NotFound
from treestroke.service.webhook_calls import Caller, CallFailed, NotPublic, read_url
from treestroke.service.webhook_secrets import secret_of
from treestroke.store.audit import record
from treestroke.store.database import Database
from treestroke.store.queries import new_id
from treestroke.store.usage import lock_team
from treestroke.store.webhook_tables import DeliveryRow, WebhookRow
from treestroke.wire_webhooks import WebhookChange, WebhookRequest

MOST_WEBHOOKS = 10
_SALT_BYTES = 16


class TooManyWebhooks(Exception):
    """A team has as many webhooks as it may."""


@dataclass(frozen=True)
class Told:
    """A webhook with the newest message to it, and with its secret where that was just made."""

    row: WebhookRow
    last: DeliveryRow | None = None
    secret: str | None = None


def list_webhooks(database: Database) -> Sequence[Told]:
    """Return the webhooks of a team, the first one first."""
    with database.reading() as session:
        return [_told(session, row) for row in session.scalars(select(WebhookRow).order_by(WebhookRow.number))]


def make_webhook(database: Database, service_secret: str, caller: Caller, body: bytes) -> Told:
    """Make a webhook by the body of a request.

    Raises
    ------
    TreestrokeError
        It is not such a request, or its address may not be called.
    TooManyWebhooks
        The team has as many as it may.
    """
    wanted = checked(WebhookRequest, read_body(body), TreestrokeError)
    check_address(caller, wanted.url)
    row = WebhookRow(
        id=new_id("hook"), url=wanted.url, events=_unique(wanted.events), salt=_salt(), created=time.time()
    )
    with database.writing() as session:
        lock_team(session)
        if (session.scalar(select(func.count()).select_from(WebhookRow)) or 0) >= MOST_WEBHOOKS:
            raise TooManyWebhooks
        session.add(row)
        record(session, "webhook.made", row.id, url=row.url)
    return Told(row, secret=secret_of(service_secret, row.id, row.salt))


def change_webhook(database: Database, service_secret: str, caller: Caller, id: str, body: bytes) -> Told:
    """Change a webhook by the body of a request; what is enabled again begins without failures.

    Raises
    ------
    NotFound, TreestrokeError
        There is no such webhook; it is not such a request, or its address may not be called.
    """
    wanted = checked(WebhookChange, read_body(body), TreestrokeError)
    if wanted.url is not None:
        check_address(caller, wanted.url)
    with database.writing() as session:
        row = session.scalars(select(WebhookRow).where(WebhookRow.id == id).with_for_update(key_share=True)).first()
        if row is None:
            raise NotFound("webhook")
        _apply(session, row, wanted)
        record(session, "webhook.changed", id, url=row.url)
        told = _told(session, row)
    return Told(row, told.last, secret_of(service_secret, id, row.salt) if wanted.rotate else None)


def remove_webhook(database: Database, id: str) -> None:
    """Remove a webhook with all messages to it.

    Raises
    ------
    NotFound
        There is no such webhook.
    """
    with database.writing() as session:
        url = session.scalars(delete(WebhookRow).where(WebhookRow.id == id).returning(WebhookRow.url)).first()
        if url is None:
            raise NotFound("webhook")
        record(session, "webhook.removed", id, url=url)


def check_address(caller: Caller, url: str) -> None:
    """Check that a webhook's address may be called, as far as that is known now; it is checked again at each attempt.

    Raises
    ------
    TreestrokeError
        It is not an address that is called.
    """
    try:
        caller.addresses(read_url(url))
    except CallFailed:
        return  # the name may be made known later; the log of deliveries says that it is not
    except (ValueError, NotPublic) as error:
        fault = f"{error}; name a public host" if isinstance(error, NotPublic) else str(error)
        raise TreestrokeError.at(("url",), fault, "webhook_address") from None


def _apply(session: Session, row: WebhookRow, wanted: WebhookChange) -> None:
    if wanted.url is not None:
        row.url = wanted.url
    if wanted.events is not None:
        row.events = _unique(wanted.events)
    if wanted.rotate:
        row.salt = _salt()
    if wanted.enabled:
        row.enabled, row.disabled_reason, row.failures = True, None, 0
    elif wanted.enabled is not None and row.enabled:
        disable(session, row, None)


def _told(session: Session, row: WebhookRow) -> Told:
    newest = select(DeliveryRow).where(DeliveryRow.webhook == row.id).order_by(DeliveryRow.number.desc()).limit(1)
    return Told(row, session.scalars(newest).first())


def _unique(events: Sequence[str]) -> list[str]:
    return list(dict.fromkeys(events))


def _salt() -> str:
    return secrets.token_hex(_SALT_BYTES)
