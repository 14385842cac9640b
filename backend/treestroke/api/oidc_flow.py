"""What a browser keeps while its person is at the issuer to sign in: a cookie that nobody can make or change."""

import hmac
import secrets
import time
from base64 import urlsafe_b64encode
from dataclasses import asdict, dataclass
from hashlib import sha256
from typing import Any

FLOW_COOKIE = "__Host-treestroke-oidc"
FLOW_FLAGS: dict[str, Any] = {"path": "/", "secure": True, "httponly": True, "samesite": "lax"}
"""Lax: the browser comes back from another site, and then has to send it."""
FLOW_SECONDS = 600
"""Time for signing in at the issuer."""
_ALGORITHM = "HS256"


@dataclass(frozen=True)
class Flow:
    """One attempt to sign in: what ties the issuer's answer, its token and its code to this browser."""

    state: str
    nonce: str
    verifier: str
    model: str = ""
    """The model that the page shows afterwards; empty: none."""

    @classmethod
    def begin(cls, model: str = "") -> "Flow":
        """Return a new one."""
        return cls(secrets.token_urlsafe(32), secrets.token_urlsafe(32), secrets.token_urlsafe(32), model)

    @property
    def challenge(self) -> str:
        """What the issuer is told of the verifier (PKCE, RFC 7636, S256)."""
        return urlsafe_b64encode(sha256(self.verifier.encode()).digest()).rstrip(b"=").decode()

    def sealed(self, secret: str) -> str:
        """Return it as a cookie's value, signed by the service's secret."""
        from joserfc import jwt
        from joserfc.jwk import OctKey

        claims = {**asdict(self), "exp": int(time.time()) + FLOW_SECONDS}
        return jwt.encode({"alg": _ALGORITHM}, claims, OctKey.import_key(_key(secret)))


def open_flow(cookie: str, secret: str) -> Flow | None:
    """Return what a cookie holds; None where the service did not write it, or its time is over."""
    from joserfc import jwt
    from joserfc.errors import JoseError
    from joserfc.jwk import OctKey

    try:
        claims = jwt.decode(cookie, OctKey.import_key(_key(secret)), [_ALGORITHM]).claims
        jwt.JWTClaimsRegistry(exp={"essential": True}).validate(claims)
    except (JoseError, ValueError):
        return None
    del claims["exp"]
    return Flow(**claims)


def _key(secret: str) -> bytes:
    """Return a key for these cookies alone."""
    return hmac.digest(secret.encode(), b"oidc flow", "sha256")
