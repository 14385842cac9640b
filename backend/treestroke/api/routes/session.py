"""Signing in and out: the session of a browser."""

from http import HTTPStatus

from fastapi import APIRouter, Request, Response
from fastapi.concurrency import run_in_threadpool

from treestroke.account_schemas import SessionInfo, Team
from treestroke.api.account_views import member_view, scope_names
from treestroke.api.deps import AllResources, JsonBody, PrincipalOf, SettingsOf, address_of, body_of
from treestroke.api.errors import BODY, Refusal, documented
from treestroke.api.identity import COOKIE, COOKIE_FLAGS, begin_session
from treestroke.api.sign_ins import Failures
from treestroke.service.accounts import Accounts, Unauthenticated, read_sign_in
from treestroke.service.members import get_team
from treestroke.service.photos import Resources
from treestroke.service.principals import LOCAL_PERSON, Principal

router = APIRouter(prefix="/v1/session", tags=["session"])


@router.post("", responses=documented(*BODY, "unauthenticated", "rate_limited"), openapi_extra=body_of("SignIn"))
async def sign_in(request: Request, resources: AllResources, body: JsonBody, response: Response) -> SessionInfo:
    """Sign in by a key: the answer sets the cookie of a new session, which no script can read."""
    key = read_sign_in(body)
    if not request.app.state.settings.hosted:
        return _answer(resources, LOCAL_PERSON)
    failed: Failures = request.app.state.failed_sign_ins
    await failed.check(address_of(request))
    try:
        return await run_in_threadpool(_sign_in, request, resources, key, response)
    except Unauthenticated as error:
        await failed.count(address_of(request))
        raise Refusal("unauthenticated", str(error)) from None


def _sign_in(request: Request, resources: Resources, key: str, response: Response) -> SessionInfo:
    accounts: Accounts = request.app.state.accounts
    token, who = accounts.sign_in(key)
    begin_session(request, response, token)
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
        response.delete_cookie(COOKIE, **COOKIE_FLAGS)


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
