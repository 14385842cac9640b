"""Signing in and out: the session of a browser."""

from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, Request, Response

from treestroke.account_schemas import SessionInfo, Team
from treestroke.api.account_views import member_view, scope_names
from treestroke.api.deps import AllResources, JsonBody, PrincipalOf, SettingsOf, body_of
from treestroke.api.errors import BODY, Refusal, documented
from treestroke.api.identity import COOKIE
from treestroke.api.sign_ins import FailedSignIns
from treestroke.service.accounts import SESSION_SECONDS, Accounts, Unauthenticated, read_sign_in
from treestroke.service.members import get_team
from treestroke.service.photos import Resources
from treestroke.service.principals import LOCAL_PERSON, Principal

router = APIRouter(prefix="/v1/session", tags=["session"])
_COOKIE: dict[str, Any] = {"path": "/", "secure": True, "httponly": True, "samesite": "strict"}


@router.post("", responses=documented(*BODY, "unauthenticated", "rate_limited"), openapi_extra=body_of("SignIn"))
def sign_in(request: Request, resources: AllResources, body: JsonBody, response: Response) -> SessionInfo:
    """Sign in by a key: the answer sets the cookie of a new session, which no script can read."""
    key = read_sign_in(body)
    if not request.app.state.settings.hosted:
        return _answer(resources, LOCAL_PERSON)
    accounts: Accounts = request.app.state.accounts
    failed: FailedSignIns = request.app.state.failed_sign_ins
    address = request.client.host if request.client else ""
    failed.check(address)
    try:
        token, who = accounts.sign_in(key)
    except Unauthenticated as error:
        failed.count(address)
        raise Refusal("unauthenticated", str(error)) from None
    if before := request.cookies.get(COOKIE):
        accounts.sign_out(before)
    response.set_cookie(COOKIE, token, max_age=int(SESSION_SECONDS), **_COOKIE)
    return _answer(resources, who)


@router.get("")
def get_session(resources: AllResources, principal: PrincipalOf) -> SessionInfo:
    """Tell who is signed in; a service without keys has one person, who always is."""
    return _answer(resources, principal)


@router.delete("", status_code=HTTPStatus.NO_CONTENT, responses=documented("storage_full"))
def sign_out(request: Request, settings: SettingsOf, response: Response) -> None:
    """End the session of this browser."""
    token = request.cookies.get(COOKIE)
    if settings.hosted and token is not None:
        accounts: Accounts = request.app.state.accounts
        accounts.sign_out(token)
        response.delete_cookie(COOKIE, **_COOKIE)


def _answer(resources: Resources, who: Principal) -> SessionInfo:
    local = who == LOCAL_PERSON
    team = who.team if local else get_team(resources.database.of(who.scope), who).name
    return SessionInfo(
        hosted=not local,
        member=member_view(who),
        team=Team(id=who.team, name=team),
        scopes=scope_names(who.scopes),
        read_only=who.read_only,
        expires=who.expires,
    )
