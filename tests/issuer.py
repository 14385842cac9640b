"""An issuer of the tests' own (OpenID Connect), which signs real tokens, and can be told to sign wrong ones."""

import json
import secrets
import time
from base64 import urlsafe_b64encode
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from hashlib import sha256
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import Any
from urllib.parse import parse_qs, parse_qsl, urlencode, urlsplit

from joserfc import jwt
from joserfc.jwk import ECKey, KeySet, RSAKey

CLIENT, SECRET = "treestroke", "known to the issuer and the service alone"
Signing = Callable[[dict[str, Any]], str]


@dataclass
class TestIssuer:
    """An issuer; who comes to it is signed in at once, as ``person``, unless ``refuses``."""

    __test__ = False

    person: dict[str, Any] = field(default_factory=lambda: {"sub": "ann", "name": "Ann Bauer"})
    claims: dict[str, Any] = field(default_factory=dict)
    """What its tokens say in place of the truth; None: nothing."""
    refuses = False
    sign: Signing | None = None
    """How it signs, if not by its key."""
    authorized: list[dict[str, str]] = field(default_factory=list)
    fetched: list[str] = field(default_factory=list)
    """Paths that were asked for."""
    host: str = "127.0.0.1"
    port: int = 0
    _codes: dict[str, dict[str, str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.key: RSAKey | ECKey = RSAKey.generate_key(2048, {"kid": "first"})

    @property
    def url(self) -> str:
        return f"http:{'//'}{self.host}:{self.port}"

    def rotate(self) -> None:
        """Sign by a new key from now on, of another kind."""
        self.key = ECKey.generate_key("P-256", {"kid": f"key-{secrets.token_hex(4)}"})

    def signed(self, claims: dict[str, Any]) -> str:
        algorithm = "RS256" if isinstance(self.key, RSAKey) else "ES256"
        return jwt.encode({"alg": algorithm, "kid": self.key.kid}, claims, self.key)

    def authorize(self, asked: dict[str, str]) -> str:
        """Sign somebody in; return where their browser goes from here."""
        self.authorized.append(asked)
        if self.refuses:
            return f"{asked['redirect_uri']}?{urlencode({'error': 'access_denied', 'state': asked['state']})}"
        code = secrets.token_urlsafe(16)
        self._codes[code] = asked
        return f"{asked['redirect_uri']}?{urlencode({'code': code, 'state': asked['state']})}"

    def redeem(self, form: dict[str, str]) -> tuple[int, dict[str, Any]]:
        """Answer a code, once, and only to who began with its verifier."""
        asked = self._codes.pop(form.get("code", ""), None)
        known = (form.get("client_id"), form.get("client_secret")) == (CLIENT, SECRET)
        if asked is None or not known or form.get("redirect_uri") != asked["redirect_uri"]:
            return 400, {"error": "invalid_grant"}
        challenge = urlsafe_b64encode(sha256(form["code_verifier"].encode()).digest()).rstrip(b"=").decode()
        if asked["code_challenge_method"] != "S256" or challenge != asked["code_challenge"]:
            return 400, {"error": "invalid_grant"}
        now = int(time.time())
        told = {"iss": self.url, "aud": CLIENT, "iat": now, "exp": now + 300, "nonce": asked["nonce"], **self.person}
        told = {name: value for name, value in {**told, **self.claims}.items() if value is not None}
        return 200, {"id_token": (self.sign or self.signed)(told), "token_type": "Bearer", "access_token": "unused"}

    def answer(self, path: str) -> dict[str, Any] | None:
        """Answer what is asked of it by GET."""
        if path == "/keys":
            return dict(KeySet([self.key]).as_dict(private=False))
        if path != "/.well-known/openid-configuration":
            return None
        places = {"authorization_endpoint": "authorize", "token_endpoint": "token", "jwks_uri": "keys"}
        methods = {"token_endpoint_auth_methods_supported": ["client_secret_post"]}
        return {"issuer": self.url, **methods, **{name: f"{self.url}/{at}" for name, at in places.items()}}


def _handler(issuer: TestIssuer) -> type[BaseHTTPRequestHandler]:
    class Answer(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            url = urlsplit(self.path)
            issuer.fetched.append(url.path)
            if url.path == "/authorize":
                self.send_response(HTTPStatus.FOUND)
                self.send_header("Location", issuer.authorize(dict(parse_qsl(url.query))))
                self.end_headers()
                return
            told = issuer.answer(url.path)
            self._tell(200 if told else 404, told or {})

        def do_POST(self) -> None:
            sent = parse_qs(self.rfile.read(int(self.headers["Content-Length"])).decode())
            self._tell(*issuer.redeem({name: values[0] for name, values in sent.items()}))

        def _tell(self, status: int, told: dict[str, Any]) -> None:
            self.send_response(status)
            self.send_header("Content-Type", "application/json")
            self.end_headers()
            self.wfile.write(json.dumps(told).encode())

        def log_message(self, *_: object) -> None:
            pass

    return Answer


@contextmanager
def issuing(host: str = "127.0.0.1") -> Iterator[TestIssuer]:
    """Run an issuer on this machine, by a name of it."""
    issuer = TestIssuer(host=host)
    server = ThreadingHTTPServer(("127.0.0.1", 0), _handler(issuer))
    issuer.port = server.server_port
    Thread(target=server.serve_forever, daemon=True).start()
    yield issuer
    server.shutdown()
    server.server_close()
