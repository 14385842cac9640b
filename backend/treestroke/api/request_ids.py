"""Each request has an id: in its response, in problems, and in every line that is logged while it is handled."""

import re
import secrets
from collections.abc import Container

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.contextvars import bind_contextvars, get_contextvars

from treestroke.logs import REQUEST

HEADER = "X-Request-Id"
_PLAIN = re.compile(r"[A-Za-z0-9._-]{1,64}")
_BYTES = 16


def request_id() -> str:
    """Return the id of the request that is handled; "" outside of any."""
    return str(get_contextvars().get(REQUEST, ""))


def identify(given: str = "") -> str:
    """Give the request that is handled from now on an id, and return it: a new one, or a ``given`` one that is plain.

    It is never taken back, since the server logs errors after the application has ended: each request has a task of
    its own, and one that is refused before there is a task begins with a call of this.
    """
    id = given if _PLAIN.fullmatch(given) else secrets.token_hex(_BYTES)
    bind_contextvars(**{REQUEST: id})
    return id


class RequestIdMiddleware:
    """Gives each request an id; that of a proxy which is trusted is kept, so that both have it in their logs.

    It is outside of all others, also of the one that answers where nobody expected an error.
    """

    def __init__(self, app: ASGIApp, proxies: Container[str | None]) -> None:
        self._app, self._proxies = app, proxies

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Forward a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        sender = (scope.get("client") or (None,))[0]
        id = identify(Headers(scope=scope).get(HEADER, "") if sender in self._proxies else "")

        async def send_with_id(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message)[HEADER] = id
            await send(message)

        await self._app(scope, receive, send_with_id)
