"""What comes before every route: whose request it is, how long it may be, and what the answer's headers say."""

import asyncio
import time
from collections.abc import Callable
from urllib.parse import urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from treestroke.api.errors import problem

HELD_BYTES = 400_000_000
"""Of the bodies of all requests together; whoever comes beyond it is to come again."""
PATIENCE_SECONDS = 30.0
SLOWEST_BYTES_PER_SECOND = 20_000
"""A body that comes more slowly, after the first half minute, is given up."""
# A GLB's textures are read from blob: addresses, by fetch as well as by image.
POLICY = (
    "default-src 'self'; img-src 'self' blob: data:; connect-src 'self' blob: data:; object-src 'none'; "
    "base-uri 'none'; frame-ancestors 'none'"
)
_HEADERS = {
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-resource-policy": "same-origin",
    "cross-origin-opener-policy": "same-origin",
    "content-security-policy": POLICY,
}


class Guard:
    """Refuses requests that name another host or come from another site, and sets the safe headers.

    A page elsewhere that a browser has open reaches 127.0.0.1 as its user does; it is told by its Origin, or, where a
    name of its own was pointed here, by the Host.
    """

    def __init__(self, app: ASGIApp, hosts: tuple[str, ...]) -> None:
        self._app, self._hosts = app, hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def safe(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
                headers.setdefault("cache-control", "no-store")
            await send(message)

        headers = Headers(scope=scope)
        host, origin = headers.get("host", ""), headers.get("origin")
        if _name(f"//{host}") not in self._hosts:
            await problem(
                403, "foreign_host", "this service answers on this machine only; open it as 127.0.0.1 or localhost"
            )(scope, receive, safe)
        elif origin is not None and not (origin.split("://")[-1] == host and _name(origin) in self._hosts):
            await problem(403, "foreign_origin", "this page is not of this service; open the service's own page")(
                scope, receive, safe
            )
        else:
            await self._app(scope, receive, safe)


class Limited:
    """Bounds a request's body, whatever its Content-Length says, and gives up on bodies that hardly come."""

    def __init__(
        self,
        app: ASGIApp,
        limit_of: Callable[[Scope], int],
        patience_s: float = PATIENCE_SECONDS,
        slowest: float = SLOWEST_BYTES_PER_SECOND,
        held: int = HELD_BYTES,
    ) -> None:
        self._app, self._limit_of = app, limit_of
        self._patience_s, self._slowest = patience_s, slowest
        self._free = held

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on with its body counted."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        limit = self._limit_of(scope)
        declared = Headers(scope=scope).get("content-length", "")
        if declared.isdecimal() and int(declared) > limit:
            await problem(413, "body_too_large", _too_large(limit))(scope, receive, send)
            return
        began, got, whole = time.monotonic(), 0, False

        async def counted() -> Message:
            nonlocal got, whole
            if whole:
                return await receive()  # what comes now is the news that the client has gone
            patience = began + self._patience_s + got / self._slowest - time.monotonic()
            try:
                message = await asyncio.wait_for(receive(), max(patience, 0.0))
            except TimeoutError:
                raise HTTPException(408, "the request's body comes too slowly; send it again") from None
            got += len(message.get("body", b""))
            self._free -= len(message.get("body", b""))
            whole = not message.get("more_body", False)
            if got > limit:
                raise HTTPException(413, _too_large(limit))
            if self._free < 0:
                raise HTTPException(503, "too much is being sent at the moment; try again", {"Retry-After": "1"})
            return message

        try:
            await self._app(scope, counted, send)
        finally:
            self._free += got


def _too_large(limit: int) -> str:
    return f"the request's body has more than {limit / 1e6:g} MB; make it smaller"


def _name(address: str) -> str | None:
    """Read the host's name, without its port, from an address."""
    try:
        return urlsplit(address).hostname
    except ValueError:
        return None
