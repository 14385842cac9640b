"""ASGI middleware before every route: hosts, origins and security headers; methods; size and pace of bodies."""

import asyncio
import math
import re
from collections.abc import Callable, Collection
from functools import partial
from http import HTTPStatus
from operator import attrgetter
from urllib.parse import urlsplit

from fastapi import Response
from fastapi.responses import JSONResponse
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from treestroke.api.errors import Refusal, allowed_methods, nothing_there, problem

HELD_BYTES = 400_000_000
"""Bytes of all bodies together. Beyond them slow bodies are dropped; if there are none, new bytes are refused."""
PATIENCE_SECONDS = 15.0
"""A request is refused when its body is this far behind `MIN_BYTES_PER_SECOND`, however fast it was before."""
MIN_BYTES_PER_SECOND = 20_000
# The page reads a GLB's textures from blob: addresses, by fetch and as images.
CONTENT_SECURITY_POLICY = (
    "default-src 'self'; img-src 'self' blob: data:; connect-src 'self' blob: data:; object-src 'none'; "
    "base-uri 'none'; frame-ancestors 'none'"
)
_STREAMED = re.compile(r"/v1/(?:clips|uploads/[^/]+)")
READING_METHODS = ("GET", "HEAD", "OPTIONS")
_KNOWN_METHODS = ("GET", "POST", "PUT", "PATCH", "DELETE", "TRACE")
_OWN_SITES = ("same-origin", "none")
"""Values of Sec-Fetch-Site for requests by the service's own page, or by its user."""
_HEADERS = {
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-resource-policy": "same-origin",
    "cross-origin-opener-policy": "same-origin",
    "content-security-policy": CONTENT_SECURITY_POLICY,
}


_THIS_MACHINE = "this service responds on this machine only; open it as 127.0.0.1 or localhost"
_OTHER_NAME = "this service does not answer to this name; open it by its own, or add this one to TREESTROKE_HOSTS"
_TLS_SECONDS = 365 * 86_400
"""How long browsers are to come by TLS alone."""


class SecurityMiddleware:
    """Refuses requests that are ambiguous, name another host or come from another site; sets security headers.

    Any page that is open in the user's browser can send requests to 127.0.0.1. Such a page is recognized by Origin,
    or by Host if it made a host name of its own point here (DNS rebinding). A ``hosted`` service is asked by TLS: its
    own page is that of the same scheme, and browsers are told to come by TLS again.
    """

    def __init__(self, app: ASGIApp, hosts: Collection[str], hosted: bool = False) -> None:
        self._app, self._hosts, self._hosted = app, hosts, hosted

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Forward a request, or refuse it."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
                headers.setdefault("cache-control", "no-store")
                if self._hosted and scope["scheme"] == "https":
                    headers["strict-transport-security"] = f"max-age={_TLS_SECONDS}"
            await send(message)

        await (self._refusal(scope, Headers(scope=scope)) or self._app)(scope, receive, send_with_headers)

    def _refusal(self, scope: Scope, headers: Headers) -> JSONResponse | None:
        host, origin = headers.get("host", ""), headers.get("origin")
        if "transfer-encoding" in headers and ("content-length" in headers or scope["http_version"] == "1.0"):
            detail = "the request gives the length of its body twice; send Content-Length or Transfer-Encoding"
            return problem("bad_request", detail, headers={"Connection": "close"})
        if _host_name(f"//{host}") not in self._hosts:
            return problem("foreign_host", _OTHER_NAME if self._hosted else _THIS_MACHINE)
        own = origin == own_origin(scope) if self._hosted else (origin or "").split("://")[-1] == host
        foreign = origin is not None and not (own and _host_name(origin) in self._hosts)
        # A form may be sent without Origin; browsers then add Sec-Fetch-Site, "same-site" for another port of the host.
        if foreign or (
            scope["method"] not in READING_METHODS and headers.get("sec-fetch-site", "none") not in _OWN_SITES
        ):
            return problem("foreign_origin", "this page does not belong to the service; open the service's own page")
        return None


class MethodMiddleware:
    """Responds to HEAD as to GET without the body, and to OPTIONS with the methods that a path has.

    Unknown methods are refused here, before the metrics count them: each would be a time series of its own.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Forward a request, or respond to it."""
        if scope["type"] != "http" or scope["method"] in _KNOWN_METHODS:
            await self._app(scope, receive, send)
        elif scope["method"] == "HEAD":
            await self._app(_as_get(scope), receive, partial(_send_head, send))
        else:
            allowed = allowed_methods(scope["app"], scope["path"])
            if scope["method"] == "OPTIONS" and allowed:
                response = Response(status_code=HTTPStatus.NO_CONTENT, headers={"Allow": ", ".join(allowed)})
            else:
                response = nothing_there(scope["method"], allowed)
            await response(scope, receive, send)


class _Body:
    """A request's body while it is received: how many bytes have arrived, and how long it may still be waited for."""

    def __init__(self, receive: Receive, patience_s: float, min_rate: float) -> None:
        self._receive, self._patience_s, self._min_rate = receive, patience_s, min_rate
        self._left_s = patience_s
        self._wait: asyncio.Timeout | None = None
        self._dropped = False
        self.received, self.complete = 0, False

    async def receive_piece(self) -> Message:
        """Return the next piece; each byte adds to the time that is left, up to the time at the start."""
        clock = asyncio.get_running_loop().time
        began = clock()
        try:
            async with asyncio.timeout(self._left_s) as self._wait:
                message = await self._receive()
                if self._dropped:  # while a piece arrived
                    raise TimeoutError
        except TimeoutError:
            raise Refusal("body_too_slow", "the request's body arrives too slowly; send it again") from None
        finally:
            self._wait = None
        size = len(message.get("body", b""))
        left_s = self._left_s - (clock() - began) + size / self._min_rate
        self._left_s = min(left_s, self._patience_s)
        self.received += size
        self.complete = not message.get("more_body", False)
        return message

    @property
    def deadline(self) -> float:
        """When the wait for this body ends, by the loop's clock in seconds; infinity while nobody waits for it."""
        return (self._wait and self._wait.when()) or math.inf

    def drop(self) -> None:
        """End the wait for this body at once."""
        self._dropped = True
        if self._wait is not None:
            self._wait.reschedule(0.0)


class BodyLimitMiddleware:
    """Limits the size of a request's body, whatever Content-Length says, and refuses bodies that arrive too slowly.

    Bodies that are streamed to disk do not count among the bytes that are held.
    """

    def __init__(
        self,
        app: ASGIApp,
        limit_of: Callable[[Scope], int],
        patience_s: float = PATIENCE_SECONDS,
        min_rate: float = MIN_BYTES_PER_SECOND,
        held_bytes: int = HELD_BYTES,
    ) -> None:
        self._app, self._limit_of = app, limit_of
        self._patience_s, self._min_rate, self._free = patience_s, min_rate, held_bytes
        self._bodies: set[_Body] = set()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Forward a request with the bytes of its body counted."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        limit = self._limit_of(scope)
        declared = Headers(scope=scope).get("content-length", "")
        if declared.isdecimal() and int(declared) > limit:
            await problem("body_too_large", _too_large(limit))(scope, receive, send)
            return
        body, streamed = _Body(receive, self._patience_s, self._min_rate), is_streamed(scope)

        async def counted() -> Message:
            if body.complete:
                return await receive()  # what follows a body is the message that the client has disconnected
            message = await body.receive_piece()
            if not streamed:
                self._free -= len(message.get("body", b""))
            if body.received > limit:
                raise Refusal("body_too_large", _too_large(limit))
            self._make_room()
            if self._free < 0 and not streamed:
                raise Refusal("overloaded", "too many bytes are being sent at the moment; try again")
            return message

        if not streamed:
            self._bodies.add(body)
        try:
            await self._app(scope, counted, send)
        finally:
            self._release(body)

    def _make_room(self) -> None:
        """Drop bodies that have used up half of their patience while all bodies together are too large."""
        late = asyncio.get_running_loop().time() + self._patience_s / 2
        while (
            self._free < 0
            and self._bodies
            and (slowest := min(self._bodies, key=attrgetter("deadline"))).deadline < late
        ):
            slowest.drop()
            self._release(slowest)

    def _release(self, body: _Body) -> None:
        """Free a body's bytes, once."""
        if body in self._bodies:
            self._bodies.remove(body)
            self._free += body.received


def is_streamed(scope: Scope) -> bool:
    """Tell whether a request's body goes to disk as it arrives, so that none of it is held in memory: clips do."""
    return scope["method"] in ("POST", "PATCH") and _STREAMED.fullmatch(scope["path"]) is not None


def _as_get(scope: Scope) -> Scope:
    """Return the request as GET, without Range, which is defined for GET alone."""
    headers = [(name, value) for name, value in scope["headers"] if name != b"range"]
    return {**scope, "method": "GET", "headers": headers}


async def _send_head(send: Send, message: Message) -> None:
    """Send the head of a response and no body."""
    if message["type"] == "http.response.start":
        await send(message)
        await send({"type": "http.response.body"})


def _too_large(limit: int) -> str:
    return f"the request's body has more than {limit / 1e6:g} MB; make it smaller"


def own_origin(scope: Scope) -> str:
    """Return what browsers send as Origin from the service's own page: scheme and host as they were asked for."""
    return f"{scope['scheme']}://{Headers(scope=scope).get('host', '')}"


def _host_name(address: str) -> str | None:
    """Return the host of an address, without its port; None if the address is malformed."""
    try:
        return urlsplit(address).hostname
    except ValueError:
        return None
