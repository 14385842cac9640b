"""Signing in at an issuer (OpenID Connect): there, and back to the page."""

import hmac
from http import HTTPStatus
from typing import Annotated
from urllib.parse import urlencode

import structlog
from fastapi import APIRouter, Depends, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import RedirectResponse
from sqlalchemy.exc import SQLAlchemyError
from starlette.exceptions import HTTPException

from treestroke.account_schemas import SignInIssuer, SignInWays
from treestroke.api.deps import SettingsOf, address_of
from treestroke.api.errors import Refusal, documented
from treestroke.api.identity import begin_session
from treestroke.api.issuer import Issuer, IssuerAway, NotVouched
from treestroke.api.middleware import own_origin
from treestroke.api.oidc_flow import FLOW_COOKIE, FLOW_FLAGS, FLOW_SECONDS, Flow, open_flow
from treestroke.api.sign_ins import Failures
from treestroke.service.accounts import Accounts
from treestroke.service.joining import NotMember, Vouched, join
from treestroke.settings import Settings

router = APIRouter(prefix="/v1", tags=["session"])
_BACK = "/v1/session/oidc/callback"
_MODEL = "^mdl_[0-9a-f]{24}$"
log = structlog.get_logger()


def _issuer(request: Request) -> Issuer:
    issuer: Issuer | None = request.app.state.issuer
    if issuer is None:
        raise HTTPException(HTTPStatus.NOT_FOUND)
    return issuer


IssuerOf = Annotated[Issuer, Depends(_issuer)]


@router.get("/sign-in")
async def ways_to_sign_in(request: Request) -> SignInWays:
    """Tell how one may sign in beside by a key: at an issuer, by its name, or not."""
    issuer: Issuer | None = request.app.state.issuer
    return SignInWays(oidc=SignInIssuer(name=issuer.name) if issuer else None)


@router.get(
    "/session/oidc",
    status_code=HTTPStatus.SEE_OTHER,
    response_class=RedirectResponse,
    responses=documented("not_found", "invalid"),
)
async def begin_oidc(
    request: Request,
    settings: SettingsOf,
    issuer: IssuerOf,
    model: Annotated[str | None, Query(pattern=_MODEL, description="the one to show afterwards")] = None,
) -> RedirectResponse:
    """Send a browser to the issuer, to sign in there."""
    flow = Flow.begin(model or "")
    try:
        address = await issuer.sign_in_address(flow, _back(request))
    except IssuerAway as error:
        log.error("issuer_away", why=str(error))
        return _to_page(failed="issuer_unavailable")
    response = RedirectResponse(address, HTTPStatus.SEE_OTHER)
    response.set_cookie(FLOW_COOKIE, flow.sealed(settings.secret), max_age=FLOW_SECONDS, **FLOW_FLAGS)
    return response


@router.get(
    "/session/oidc/callback",
    status_code=HTTPStatus.SEE_OTHER,
    response_class=RedirectResponse,
    responses=documented("not_found"),
)
async def finish_oidc(
    request: Request, settings: SettingsOf, issuer: IssuerOf, state: str = "", code: str = ""
) -> RedirectResponse:
    """Take a browser back from the issuer, begin its session and show the page, which is told what went wrong."""
    failed: Failures = request.app.state.failed_sign_ins
    address = address_of(request)
    flow = open_flow(request.cookies.get(FLOW_COOKIE, ""), settings.secret)
    if flow is None or not hmac.compare_digest(state.encode(), flow.state.encode()):
        response = _to_page(failed="sign_in_over")
    elif not code:
        response = _to_page(failed="sign_in_refused")
    else:
        try:
            await failed.check(address)
            response = await _signed_in(request, await issuer.redeem(code, flow, _back(request)), flow.model)
        except NotVouched as error:
            log.warning("sign_in_not_vouched", why=str(error))
            await failed.count(address)
            response = _to_page(failed="sign_in_invalid")
        except (IssuerAway, SQLAlchemyError) as error:
            log.error("issuer_away", why=str(error))
            response = _to_page(failed="issuer_unavailable")
        except NotMember:
            response = _to_page(failed="not_member")
        except Refusal as error:
            response = _to_page(failed=error.code)
    response.delete_cookie(FLOW_COOKIE, **FLOW_FLAGS)
    return response


async def _signed_in(request: Request, person: Vouched, model: str) -> RedirectResponse:
    response = _to_page(model)
    await run_in_threadpool(_begin, request, person, response)
    return response


def _begin(request: Request, person: Vouched, response: RedirectResponse) -> None:
    accounts: Accounts = request.app.state.accounts
    settings: Settings = request.app.state.settings
    who = join(accounts.database, person, settings.oidc_team, settings.oidc_role)
    token, _ = accounts.begin(who, key=None)
    begin_session(request, response, token)


def _back(request: Request) -> str:
    """Return where the issuer sends the browser back to, by the name of the service that was asked for."""
    return f"{own_origin(request.scope)}{_BACK}"


def _to_page(model: str = "", failed: str = "") -> RedirectResponse:
    """Return to the page, and to nothing else, whatever was asked for."""
    address = f"/?{urlencode({'sign-in': failed})}" if failed else f"/#{model}" if model else "/"
    return RedirectResponse(address, HTTPStatus.SEE_OTHER)
