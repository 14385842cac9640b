"""Who sends a request: found by a key in the header Authorization, or by the cookie of a browser that has signed in."""

from typing import Any

from fastapi import Request
from fastapi.concurrency import run_in_threadpool

from treestroke.api.errors import Refusal
from treestroke.api.middleware import READING_METHODS, own_origin
from treestroke.api.request_ids import request_id
from treestroke.api.rules import RULES, check
from treestroke.service.accounts import Accounts, Unauthenticated
from treestroke.service.principals import LOCAL_PERSON, Principal
from treestroke.store.audit import ORIGIN, Origin

COOKIE = "__Host-treestroke"
"""Browsers take a cookie of such a name only from this very host, over TLS, and for all of its paths."""
SECURITY_SCHEMES: dict[str, Any] = {
    "key": {"type": "http", "scheme": "bearer", "description": "a key of a member, ts_..."},
    "session": {"type": "apiKey", "in": "cookie", "name": COOKIE, "description": "a browser that has signed in"},
}
"""How one is known, for the API's document."""


async def admit(request: Request) -> None:
    """Find who sends a request, and check that they may; in a service without keys it is its only person.

    Raises
    ------
    Refusal
        Nobody is known by what came with the request, or they may not do this.
    """
    ORIGIN.set(Origin(request.client.host if request.client else "", request_id()))
    rule, hosted = RULES[request.scope["route"].name], request.app.state.settings.hosted
    request.state.principal = None if hosted else LOCAL_PERSON
    if rule is None or not hosted:
        return
    request.state.principal = await run_in_threadpool(_identified, request)
    check(rule, request.state.principal)


def _identified(request: Request) -> Principal:
    accounts: Accounts = request.app.state.accounts
    try:
        given = request.headers.get("authorization")
        if given is not None:
            scheme, _, key = given.partition(" ")
            if scheme.lower() != "bearer":
                raise Unauthenticated("send the key as `Authorization: Bearer ts_...`")
            return accounts.by_key(key.strip())
        token = request.cookies.get(COOKIE)
        if token is None:
            raise Unauthenticated("sign in, or send a key as `Authorization: Bearer ts_...`")
        who = accounts.by_session(token)
    except Unauthenticated as error:
        raise Refusal("unauthenticated", str(error)) from None
    # Browsers add the cookie to whatever is sent here; only the service's own page may write by it.
    if request.method not in READING_METHODS and request.headers.get("origin") != own_origin(request.scope):
        raise Refusal("foreign_origin", "a signed-in browser writes from the service's own page alone; open that")
    return who
