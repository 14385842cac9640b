"""What comes before every route: whose request it is, how long it may be, and what the answer's headers say."""

import asyncio
import math
import time
from collections.abc import Callable
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
"""Of the bodies of all requests together; beyond it those that hardly come make room, or who comes is to come again."""
PATIENCE_SECONDS = 15.0
"""A body that says nothing, or is behind the slowest rate, for so long is given up, however fast it came before."""
SLOWEST_BYTES_PER_SECOND = 20_000
# A GLB's textures are read from blob: addresses, by fetch as well as by image.
POLICY = (
    "default-src 'self'; img-src 'self' blob: data:; connect-src 'self' blob: data:; object-src 'none'; "
    "base-uri 'none'; frame-ancestors 'none'"
)
_READS = ("GET", "HEAD", "OPTIONS")
_PASSED = ("GET", "POST", "PUT", "PATCH", "DELETE", "TRACE")
_OWN_SITES = ("same-origin", "none")
"""What a browser says of a request by the service's own page, or by its user."""
_HEADERS = {
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-resource-policy": "same-origin",
    "cross-origin-opener-policy": "same-origin",
    "content-security-policy": POLICY,
}


class SecurityMiddleware:
    """Refuses what is ambiguous, names another host or comes from another site, and sets the safe headers.

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

        await (self._refusal(scope, Headers(scope=scope)) or self._app)(scope, receive, safe)

    def _refusal(self, scope: Scope, headers: Headers) -> JSONResponse | None:
        host, origin = headers.get("host", ""), headers.get("origin")
        if "transfer-encoding" in headers and ("content-length" in headers or scope["http_version"] == "1.0"):
            twice = "the request says twice how long its body is; send Content-Length or Transfer-Encoding"
            return problem("bad_request", twice, headers={"Connection": "close"})
        if _name(f"//{host}") not in self._hosts:
            here = "this service answers on this machine only; open it as 127.0.0.1 or localhost"
            return problem("foreign_host", here)
        foreign = origin is not None and not (origin.split("://")[-1] == host and _name(origin) in self._hosts)
        # A form may be sent without an origin; browsers add where it came from. Another port of a host is "same-site".
        if foreign or (scope["method"] not in _READS and headers.get("sec-fetch-site", "none") not in _OWN_SITES):
            return problem("foreign_origin", "this page is not of this service; open the service's own page")
        return None


class MethodMiddleware:
    """Answers HEAD as GET without its body, and OPTIONS by what may be asked.

    Any other method that nobody knows is refused here, before it is counted: each would be a series of its own.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or answer it."""
        if scope["type"] != "http" or scope["method"] in _PASSED:
            await self._app(scope, receive, send)
        elif scope["method"] == "HEAD":
            await self._app(_as_get(scope), receive, partial(_send_head, send))
        else:
            allowed = allowed_methods(scope["app"], scope["path"])
            told = Response(status_code=HTTPStatus.NO_CONTENT, headers={"Allow": ", ".join(allowed)})
            asked = scope["method"] == "OPTIONS" and allowed
            await (told if asked else nothing_there(scope["method"], allowed))(scope, receive, send)


class _Body:
    """A request's body on its way: how much of it came, and how long it may still keep its reader waiting."""

    def __init__(self, receive: Receive, patience_s: float, slowest: float) -> None:
        self._receive, self._patience_s, self._slowest = receive, patience_s, slowest
        self._left_s = patience_s
        self._wait: asyncio.Timeout | None = None
        self._given_up = False
        self.got, self.whole = 0, False

    async def piece(self) -> Message:
        """Give the next piece; what comes in good time gives back patience, but never more than there was at first."""
        began = time.monotonic()
        try:
            async with asyncio.timeout(self._left_s) as self._wait:
                message = await self._receive()
                if self._given_up:  # and something came in the same moment
                    raise TimeoutError
        except TimeoutError:
            raise Refusal("body_too_slow", "the request's body comes too slowly; send it again") from None
        finally:
            self._wait = None
        size = len(message.get("body", b""))
        left_s = self._left_s - (time.monotonic() - began) + size / self._slowest
        self._left_s = min(left_s, self._patience_s)
        self.got += size
        self.whole = not message.get("more_body", False)
        return message

    @property
    def due(self) -> float:
        """When this body is given up, by the loop's clock; never while nobody waits for it."""
        return (self._wait and self._wait.when()) or math.inf

    def give_up(self) -> None:
        """End the wait for it at once."""
        self._given_up = True
        if self._wait is not None:
            self._wait.reschedule(0.0)


class BodyLimitMiddleware:
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
        self._patience_s, self._slowest, self._free = patience_s, slowest, held
        self._bodies: set[_Body] = set()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on with its body counted."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        limit = self._limit_of(scope)
        declared = Headers(scope=scope).get("content-length", "")
        if declared.isdecimal() and int(declared) > limit:
            await problem("body_too_large", _too_large(limit))(scope, receive, send)
            return
        body = _Body(receive, self._patience_s, self._slowest)

        async def counted() -> Message:
            if body.whole:
                return await receive()  # what comes now is the news that the client has gone
            message = await body.piece()
            self._free -= len(message.get("body", b""))
            if body.got > limit:
                raise Refusal("body_too_large", _too_large(limit))
            self._make_room()
            if self._free < 0:
                raise Refusal("overloaded", "too much is being sent at the moment; try again")
            return message

        self._bodies.add(body)
        try:
            await self._app(scope, counted, send)
        finally:
            self._forget(body)

    def _make_room(self) -> None:
        """Where all bodies together are too much, end those that have used up half of their patience."""
        late = asyncio.get_running_loop().time() + self._patience_s / 2
        while self._free < 0 and (slowest := min(self._bodies, key=attrgetter("due"))).due < late:
            slowest.give_up()
            self._forget(slowest)

    def _forget(self, body: _Body) -> None:
        """Let what a body holds be free, once."""
        if body in self._bodies:
            self._bodies.remove(body)
            self._free += body.got


def _as_get(scope: Scope) -> Scope:
    """Ask for what GET would answer with; a part can be asked for by GET alone."""
    headers = [(name, value) for name, value in scope["headers"] if name != b"range"]
    return {**scope, "method": "GET", "headers": headers}


async def _send_head(send: Send, message: Message) -> None:
    """Send the head of an answer and end it there: the application is told that the client has gone."""
    if message["type"] == "http.response.start":
        await send(message)
        await send({"type": "http.response.body"})


def _too_large(limit: int) -> str:
    return f"the request's body has more than {limit / 1e6:g} MB; make it smaller"


def _name(address: str) -> str | None:
    """Read the host's name, without its port, from an address."""
    try:
        return urlsplit(address).hostname
    except ValueError:
        return None
