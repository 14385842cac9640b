"""Rates: how many requests of each kind a person, or an address without a key, may send in a while."""

from collections.abc import AsyncIterator

from fastapi import Request
from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from treestroke.api.deps import AskerOf, address_of
from treestroke.api.errors import Refusal
from treestroke.api.request_counts import Rate, RequestCounts

TRACES, MODELS, UPLOADS = Rate("traces", 10, 1), Rate("models", 60, 60), Rate("uploads", 60, 60)
CALLS = Rate("calls", 50, 1)
ALL = (TRACES, MODELS, UPLOADS, CALLS)
RATES: dict[str, Rate | None] = {
    "live": None,
    "ready": None,
    "trace_photo": TRACES,
    "trace_capture": TRACES,
    "trace_clip": TRACES,
    "trace_sketches": TRACES,
    "ask_for_model": MODELS,
    "ask_for_siblings": MODELS,
    "solve_capture": MODELS,
    "add_photo": UPLOADS,
    "add_capture_photo": UPLOADS,
    "add_clip": UPLOADS,
}
"""Rate of each operation, by its name; the others have `CALLS`, and None counts nothing."""

UPLOADS_AT_ONCE = 6
"""Uploads of one person at a time: what arrives is held in memory, of which this process has enough for all."""


def asker_id(request: Request, asker: AskerOf) -> str:
    """Return by what requests are counted: who asks, or without a key the address."""
    return asker.id if asker is not None else f"at {address_of(request)}"


async def limit_rate(request: Request, asker: AskerOf) -> None:
    """Count a request, by its operation and who asks.

    Raises
    ------
    RateLimited
        It is one too many.
    """
    rate = RATES.get(request.scope["route"].name, CALLS)
    if rate is not None:
        counts: RequestCounts = request.app.state.counts
        request.state.standing = await counts.take(rate, asker_id(request, asker))


async def limit_uploads(request: Request, asker: AskerOf) -> AsyncIterator[None]:
    """Hold one of the places that a person has for uploads until theirs is answered.

    Raises
    ------
    Refusal
        All are taken.
    """
    if RATES.get(request.scope["route"].name) is not UPLOADS:
        yield
        return
    who, taken = asker_id(request, asker), request.app.state.uploads
    if taken[who] >= UPLOADS_AT_ONCE:
        detail = f"at most {UPLOADS_AT_ONCE} uploads of one person are taken at once; send this one again in a second"
        raise Refusal("rate_limited", detail, headers={"Retry-After": "1"})
    taken[who] += 1
    try:
        yield
    finally:
        taken[who] -= 1
        if not taken[who]:
            del taken[who]


class RateHeadersMiddleware:
    """Tells in each response that was counted how many requests are left."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Forward a request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        state = scope.setdefault("state", {})

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start" and "standing" in state:
                MutableHeaders(scope=message).update(state["standing"].headers)
            await send(message)

        await self._app(scope, receive, send_with_headers)
