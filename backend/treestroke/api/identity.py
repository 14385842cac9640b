"""Who sends a request: found by a key in the header Authorization, or by the cookie of a browser that has signed in."""

from typing import Any

from fastapi import Request, Response
from fastapi.concurrency import run_in_threadpool

from treestroke.api.deps import address_of
from treestroke.api.errors import Refusal
from treestroke.api.middleware import READING_METHODS, own_origin
from treestroke.api.request_ids import request_id
from treestroke.api.rules import RULES, check
from treestroke.api.sign_ins import Failures
from treestroke.service.accounts import SESSION_SECONDS, Accounts, Unauthenticated
from treestroke.service.principals import LOCAL_PERSON, Principal
from treestroke.store.audit import ORIGIN, Origin

COOKIE = "__Host-treestroke"
"""Browsers take a cookie of such a name only from this very host, over TLS, and for all of its paths."""
COOKIE_FLAGS: dict[str, Any] = {"path": "/", "secure": True, "httponly": True, "samesite": "strict"}
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
    ORIGIN.set(Origin(address_of(request), request_id()))
    rule, hosted = RULES[request.scope["route"].name], request.app.state.settings.hosted
    request.state.principal = None if hosted else LOCAL_PERSON
    if rule is None or not hosted:
        return
    request.state.principal = await _identified(request)
    check(rule, request.state.principal)


async def _identified(request: Request) -> Principal:
    """Return whose key or session a request has; a wrong key is counted, and a valid one is always answered."""
    given = request.headers.get("authorization")
    try:
        if given is None:
            return await run_in_threadpool(_by_session, request)
        return await run_in_threadpool(_by_key, request, given)
    except Unauthenticated as error:
        if given is not None:
            failed: Failures = request.app.state.failed_keys
            await failed.check(address_of(request))
            await failed.count(address_of(request))
        raise Refusal("unauthenticated", str(error)) from None


def _by_key(request: Request, given: str) -> Principal:
    accounts: Accounts = request.app.state.accounts
    scheme, _, key = given.partition(" ")
    if scheme.lower() != "bearer":
        raise Unauthenticated("send the key as `Authorization: Bearer ts_...`")
    return accounts.by_key(key.strip())


def _by_session(request: Request) -> Principal:
    accounts: Accounts = request.app.state.accounts
    token = request.cookies.get(COOKIE)
    if token is None:
        raise Unauthenticated("sign in, or send a key as `Authorization: Bearer ts_...`")
    who = accounts.by_session(token)
    # Browsers add the cookie to whatever is sent here; only the service's own page may write by it.
    if request.method not in READING_METHODS and request.headers.get("origin") != own_origin(request.scope):
        raise Refusal("foreign_origin", "a signed-in browser writes from the service's own page alone; open that")
    return who


def begin_session(request: Request, response: Response, token: str) -> None:
    """Give a browser the cookie of a new session; the one that it had before ends."""
    accounts: Accounts = request.app.state.accounts
    if before := request.cookies.get(COOKIE):
        accounts.sign_out(before)
    response.set_cookie(COOKIE, token, max_age=int(SESSION_SECONDS), **COOKIE_FLAGS)
