"""The tables of webhooks and of the messages to them. Of a webhook's secret only the salt is kept."""

from sqlalchemy import ForeignKey, Index, Integer, String, Text, true
from sqlalchemy.orm import Mapped, mapped_column

from treestroke.store.scope import Authored, Owned
from treestroke.store.tables import NUMBER, Aged, Table


class WebhookRow(Authored, Table):
    """An address that a team has told about its jobs."""

    __tablename__ = "webhooks"

    number: Mapped[int] = mapped_column(NUMBER, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    url: Mapped[str] = mapped_column(String(2000))
    events: Mapped[list[str]]
    """Names of the events that it is told."""
    salt: Mapped[str] = mapped_column(String(40))
    """From which, and from the service's secret, that of the webhook follows."""
    enabled: Mapped[bool] = mapped_column(insert_default=True, server_default=true())
    disabled_reason: Mapped[str | None] = mapped_column(String(12))
    """Why the service disabled it; None where an owner did."""
    failures: Mapped[int] = mapped_column(Integer, insert_default=0, server_default="0")
    """Messages in a row that were given up."""
    created: Mapped[float]


class DeliveryRow(Owned, Aged, Table):
    """A message to one webhook, and what became of it: waiting, delivered, failed, blocked or canceled.

    Unlike other times, ``due`` decides, by the database's clock: where that jumps, an attempt is made sooner or later
    than it would have been. 0 is at once.
    """

    __tablename__ = "deliveries"

    number: Mapped[int] = mapped_column(NUMBER, primary_key=True, autoincrement=True)
    id: Mapped[str] = mapped_column(String(40), unique=True)
    webhook: Mapped[str] = mapped_column(ForeignKey("webhooks.id", ondelete="CASCADE"))
    event: Mapped[str] = mapped_column(String(40))
    body: Mapped[str] = mapped_column(Text)
    """The JSON that is sent, as things were when the message was written."""
    state: Mapped[str] = mapped_column(String(12), insert_default="waiting")
    attempts: Mapped[int] = mapped_column(insert_default=0)
    """Attempts begun: the fence, since an outcome is recorded for the last of them alone."""
    due: Mapped[float] = mapped_column(insert_default=0.0)
    created: Mapped[float]
    last_attempt: Mapped[float | None]
    last_status: Mapped[int | None]
    last_error: Mapped[str | None] = mapped_column(String(200))
    last_seconds: Mapped[float | None]


Index("ix_webhooks_team", WebhookRow.team, WebhookRow.number)
Index("ix_deliveries_due", DeliveryRow.state, DeliveryRow.due)
Index("ix_deliveries_webhook", DeliveryRow.webhook, DeliveryRow.number)
Index("ix_deliveries_seen", DeliveryRow.seen)
