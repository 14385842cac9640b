"""The secret of a webhook, by which messages to it are signed: it follows from the service's own, and is not stored."""

import base64
import hmac
from datetime import datetime

from standardwebhooks import Webhook

from treestroke import __version__


def secret_of(service_secret: str, id: str, salt: str) -> str:
    """Return the secret of a webhook; with another salt it is another one."""
    digest = hmac.digest(service_secret.encode(), f"webhook {id} {salt}".encode(), "sha256")
    return f"whsec_{base64.b64encode(digest).decode()}"


def signed_headers(secret: str, id: str, body: str, now: datetime) -> dict[str, str]:
    """Return the headers of one attempt to send a message, as Standard Webhooks names them; ``now`` has a time zone."""
    return {
        "Content-Type": "application/json",
        "User-Agent": f"treestroke/{__version__}",
        "webhook-id": id,
        "webhook-timestamp": str(int(now.timestamp())),
        "webhook-signature": Webhook(secret).sign(id, now, body),
    }
