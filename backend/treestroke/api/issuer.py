"""The issuer that people sign in at (OpenID Connect): where it is asked, its keys, and what it says of somebody."""

import asyncio
import math
import re
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from urllib.parse import quote_plus, urlencode, urlsplit

import httpx

from treestroke.api.oidc_flow import Flow
from treestroke.service.joining import Vouched
from treestroke.settings import Settings, is_secure
from treestroke.wire_requests import NAME_PATTERN

if TYPE_CHECKING:
    from joserfc.jwk import KeySet

ISSUER_CONNECTIONS = 4
ALGORITHMS = ("RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512")
"""How a token may be signed: never by a shared secret, which the public key could be taken for, nor not at all."""
_SKEW_SECONDS = 60
"""How much the issuer's clock may differ."""
_KEPT_SECONDS = 3600.0
"""How long its addresses and keys are kept."""
_RETRY_SECONDS = 5.0
"""How soon it is asked again after it was away, or for a key that it has not named."""
_PATIENCE_SECONDS = 5.0
_SUBJECT_LENGTH = 255
_NAMES = ("name", "preferred_username", "email")


class IssuerAway(Exception):
    """The issuer does not answer, or not as an issuer does."""


class NotVouched(Exception):
    """The issuer refused the code, or its token is not to be believed."""


@dataclass(frozen=True)
class _Metadata:
    """What an issuer says of itself, and when it did."""

    authorization: str
    token: str
    basic: bool
    """Whether it takes a client's secret by the header Authorization."""
    keys_at: str
    keys: "KeySet"
    since: float


class Issuer:
    """The issuer of a service; it is asked when somebody signs in, and holds up nobody else while it is away."""

    def __init__(self, settings: Settings) -> None:
        self._issuer, self._client = settings.oidc_issuer, settings.oidc_client
        self._secret = settings.oidc_client_secret
        limits = httpx.Limits(max_connections=ISSUER_CONNECTIONS)
        self._http = httpx.AsyncClient(limits=limits, timeout=_PATIENCE_SECONDS)
        self._asking = asyncio.Lock()
        self._known: _Metadata | None = None
        self._failed = self._asked_for_key = -math.inf

    @property
    def name(self) -> str:
        """What people know it by: its host."""
        return urlsplit(self._issuer).hostname or ""

    async def close(self) -> None:
        """Close the connections."""
        await self._http.aclose()

    async def sign_in_address(self, flow: Flow, back: str) -> str:
        """Return where a browser signs in, from where it comes ``back``.

        Raises
        ------
        IssuerAway
            Nobody knows where.
        """
        asked = {
            "response_type": "code",
            "client_id": self._client,
            "redirect_uri": back,
            "scope": "openid profile email",
            "state": flow.state,
            "nonce": flow.nonce,
            "code_challenge": flow.challenge,
            "code_challenge_method": "S256",
        }
        address = (await self._metadata()).authorization
        return f"{address}{'&' if urlsplit(address).query else '?'}{urlencode(asked)}"

    async def redeem(self, code: str, flow: Flow, back: str) -> Vouched:
        """Return for whom the issuer vouches by a code.

        Raises
        ------
        NotVouched
            It does not, or its token is not to be believed.
        IssuerAway
            It does not answer.
        """
        known = await self._metadata()
        form = {"grant_type": "authorization_code", "code": code, "redirect_uri": back, "code_verifier": flow.verifier}
        auth = None
        if self._secret and known.basic:
            auth = httpx.BasicAuth(quote_plus(self._client), quote_plus(self._secret))
        else:
            form |= {"client_id": self._client} | ({"client_secret": self._secret} if self._secret else {})
        answer = await self._ask("POST", known.token, data=form, auth=auth)
        told = _read(answer)
        if answer.is_server_error:
            raise IssuerAway(f"{known.token} answered {answer.status_code}")
        if not answer.is_success or not isinstance(told.get("id_token"), str):
            raise NotVouched(f"{known.token} answered {answer.status_code} {told.get('error', '')}")
        claims = await self._claims(known, told["id_token"], flow.nonce)
        return Vouched(self._issuer, claims["sub"], _name_of(claims))

    async def _claims(self, known: _Metadata, token: str, nonce: str) -> dict[str, Any]:
        """Return what a token says, once it is known to be the issuer's, for this service and this attempt."""
        from joserfc import jwt
        from joserfc.errors import InvalidKeyIdError, JoseError

        try:
            try:
                claims = jwt.decode(token, known.keys, ALGORITHMS).claims
            except InvalidKeyIdError:
                claims = jwt.decode(token, await self._newer_keys(known), ALGORITHMS).claims
            several = isinstance(claims.get("aud"), list) and len(claims["aud"]) > 1
            jwt.JWTClaimsRegistry(
                leeway=_SKEW_SECONDS,
                iss={"essential": True, "value": self._issuer},
                aud={"essential": True, "value": self._client},
                azp={"essential": several, "value": self._client},
                sub={"essential": True},
                exp={"essential": True},
                iat={"essential": True},
                nonce={"essential": True, "value": nonce},
            ).validate(claims)
        except (JoseError, ValueError, TypeError) as error:
            raise NotVouched(str(error)) from error
        if len(claims["sub"]) > _SUBJECT_LENGTH:
            raise NotVouched("the token's sub is too long")
        return claims

    async def _newer_keys(self, known: _Metadata) -> "KeySet":
        """Return the issuer's keys as they are now: it may have a new one; somebody may also have made one up."""
        async with self._asking:
            if self._known is known and time.monotonic() - self._asked_for_key >= _RETRY_SECONDS:
                self._asked_for_key = time.monotonic()
                self._known = await self._fetch()
            return (self._known or known).keys

    async def _metadata(self) -> _Metadata:
        async with self._asking:
            now, known = time.monotonic(), self._known
            stale = known is None or now - known.since >= _KEPT_SECONDS
            if stale and now - self._failed >= _RETRY_SECONDS:
                try:
                    self._known = await self._fetch()
                except IssuerAway:
                    self._failed = time.monotonic()
                    if known is None:
                        raise
            if self._known is None:
                raise IssuerAway("it was away a moment ago")
            return self._known

    async def _fetch(self) -> _Metadata:
        """Ask the issuer for its addresses and keys (OpenID Connect Discovery 1.0)."""
        from joserfc.errors import JoseError
        from joserfc.jwk import KeySet

        said = _read(await self._ask("GET", f"{self._issuer.rstrip('/')}/.well-known/openid-configuration"))
        if said.get("issuer") != self._issuer:
            raise IssuerAway(f"it calls itself {said.get('issuer')}, not {self._issuer}; set TREESTROKE_OIDC_ISSUER")
        addresses = [said.get(name) for name in ("authorization_endpoint", "token_endpoint", "jwks_uri")]
        if not all(isinstance(address, str) and is_secure(address) for address in addresses):
            raise IssuerAway(f"its addresses are not all there, and https: {addresses}")
        authorization, token, keys_at = map(str, addresses)
        try:
            keys = KeySet.import_key_set(_read(await self._ask("GET", keys_at)))  # type: ignore[arg-type]
        except (JoseError, ValueError, KeyError, TypeError) as error:
            raise IssuerAway(f"its keys cannot be read: {error}") from error
        basic = "client_secret_basic" in said.get("token_endpoint_auth_methods_supported", ["client_secret_basic"])
        return _Metadata(authorization, token, basic, keys_at, keys, time.monotonic())

    async def _ask(self, method: str, address: str, **request: Any) -> httpx.Response:
        try:
            async with asyncio.timeout(_PATIENCE_SECONDS):
                return await self._http.request(method, address, **request)
        except (httpx.HTTPError, httpx.InvalidURL, TimeoutError) as error:
            raise IssuerAway(f"{address}: {error or type(error).__name__}") from error


def _read(answer: httpx.Response) -> dict[str, Any]:
    """Return an answer's JSON object; empty where it is none."""
    try:
        told = answer.json()
    except ValueError:
        return {}
    return told if isinstance(told, dict) else {}


def _name_of(claims: dict[str, Any]) -> str:
    """Return how the issuer calls somebody, as far as that can be written; at worst by what it knows them by."""
    names = (str(claims.get(name) or "").strip() for name in (*_NAMES, "sub"))
    return next((name for name in names if name and re.fullmatch(NAME_PATTERN, name)), "?")
