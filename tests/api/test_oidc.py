"""Signing in at an issuer, as a browser comes back from it."""

import hmac
import json
import time
from base64 import urlsafe_b64encode
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from http.cookies import SimpleCookie
from typing import Any
from urllib.parse import parse_qs, urlsplit

import httpx
import pytest
from joserfc import jwt
from joserfc.jwk import RSAKey
from tests.hosted import ORIGIN, Hosted, hosting
from tests.issuer import CLIENT, SECRET, TestIssuer, issuing
from tests.postgres import PostgresServer

from treestroke.api.identity import COOKIE
from treestroke.api.oidc_flow import FLOW_COOKIE, Flow

TEAM = "Oaks"


@pytest.fixture(scope="module")
def issuer() -> Iterator[TestIssuer]:
    with issuing() as found:
        yield found


@pytest.fixture(scope="module")
def hosted(issuer: TestIssuer, tmp_path_factory: pytest.TempPathFactory, postgres: PostgresServer) -> Iterator[Hosted]:
    settings = {"oidc_issuer": issuer.url, "oidc_client": CLIENT, "oidc_client_secret": SECRET, "oidc_team": TEAM}
    with hosting(tmp_path_factory.mktemp("oidc") / "data", postgres.fresh_with_tables(), **settings) as service:
        service.key("owner", team=TEAM)
        yield service


@pytest.fixture(autouse=True)
def _honest(issuer: TestIssuer) -> None:
    """Have the issuer tell the truth at the beginning of each test."""
    issuer.person, issuer.claims = {"sub": "ann", "name": "Ann Bauer"}, {}
    issuer.sign, issuer.refuses = None, False


class Browser:
    """Somebody's browser: it keeps cookies as the service sets them, and goes where it is sent."""

    def __init__(self, hosted: Hosted, address: str = "203.0.113.7") -> None:
        self._client, self._address = hosted.client, address
        self.cookies: dict[str, str] = {}

    def get(self, path: str, **cookies: str) -> httpx.Response:
        kept = "; ".join(f"{name}={value}" for name, value in {**self.cookies, **cookies}.items())
        answer = self._client.get(path, headers={"Cookie": kept, "X-Forwarded-For": self._address})
        for header in answer.headers.get_list("Set-Cookie"):
            for name, cookie in SimpleCookie(header).items():
                if cookie["max-age"] == "0":
                    self.cookies.pop(name, None)
                else:
                    self.cookies[name] = cookie.value
        return answer

    def go_to_issuer(self, query: str = "") -> str:
        """Begin to sign in; return the path by which the issuer sends the browser back."""
        answer = self.get(f"/v1/session/oidc{query}")
        assert answer.status_code == 303, answer.text
        back = httpx.get(answer.headers["Location"]).headers["Location"]
        assert back.startswith(f"{ORIGIN}/v1/session/oidc/callback?")
        return back.removeprefix(ORIGIN)

    def sign_in(self) -> str:
        """Sign in; return where the browser is sent at the end."""
        return str(self.get(self.go_to_issuer()).headers["Location"])

    def who(self) -> dict[str, Any]:
        answer = self.get("/v1/session")
        assert answer.status_code == 200, answer.text
        return dict(answer.json())


def failed(code: str) -> str:
    return f"/?sign-in={code}"


def address(number: int = 0) -> str:
    """Give an address of this test's own: what fails is counted by address."""
    return f"198.51.100.{number}"


def test_the_page_is_told_at_whom_one_may_sign_in(hosted: Hosted) -> None:
    assert hosted.client.get("/v1/sign-in").json() == {"oidc": {"name": "127.0.0.1"}}


def test_who_is_new_joins_the_team_and_is_the_same_member_ever_after(hosted: Hosted, issuer: TestIssuer) -> None:
    browser = Browser(hosted)
    assert browser.sign_in() == "/"
    told = browser.who()
    assert (told["member"]["name"], told["member"]["role"], told["team"]["name"]) == ("Ann Bauer", "member", TEAM)
    assert told["expires"] - time.time() == pytest.approx(7 * 86_400, abs=600)
    assert FLOW_COOKIE not in browser.cookies
    issuer.person = {"sub": "ann", "name": "Ann Meier"}
    again = Browser(hosted)
    again.sign_in()
    assert again.who()["member"] == told["member"]
    issuer.person = {"sub": "ben", "email": "ben@trees.example"}
    again.sign_in()
    assert again.who()["member"]["name"] == "ben@trees.example"


def test_the_issuer_is_asked_with_a_challenge_and_the_cookie_is_the_browser_s_alone(
    hosted: Hosted, issuer: TestIssuer
) -> None:
    answer = hosted.client.get("/v1/session/oidc")
    asked = {name: values[0] for name, values in parse_qs(urlsplit(answer.headers["Location"]).query).items()}
    assert asked["redirect_uri"] == f"{ORIGIN}/v1/session/oidc/callback"
    assert (asked["response_type"], asked["code_challenge_method"], asked["client_id"]) == ("code", "S256", CLIENT)
    name, *flags = (part.strip() for part in answer.headers["Set-Cookie"].split(";"))
    assert name.startswith(f"{FLOW_COOKIE}=")
    assert {"HttpOnly", "Secure", "SameSite=lax", "Path=/", "Max-Age=600"} == set(flags)
    assert asked["state"] != asked["nonce"] != asked["code_challenge"]


def test_the_model_that_was_to_be_seen_is_seen_afterwards_and_nothing_else(hosted: Hosted) -> None:
    browser, model = Browser(hosted), f"mdl_{'0' * 24}"
    back = browser.go_to_issuer(f"?model={model}")
    assert browser.get(back).headers["Location"] == f"/#{model}"
    for elsewhere in (f"{'//'}evil.example", f"https:{'//'}evil.example", f"{model}/../x", f"{model}%0d%0aX: y"):
        assert browser.get(f"/v1/session/oidc?model={elsewhere}").status_code == 422


def test_a_session_given_before_does_not_outlive_signing_in(hosted: Hosted) -> None:
    browser = Browser(hosted)
    browser.sign_in()
    before = browser.cookies[COOKIE]
    browser.sign_in()
    assert browser.cookies[COOKIE] != before
    assert hosted.client.get("/v1/session", headers={"Cookie": f"{COOKIE}={before}"}).status_code == 401


def test_an_answer_is_taken_once_and_by_the_browser_that_asked(hosted: Hosted) -> None:
    browser, other = Browser(hosted, address(1)), Browser(hosted, address(1))
    back = browser.go_to_issuer()
    flow = browser.cookies[FLOW_COOKIE]
    assert other.get(back).headers["Location"] == failed("sign_in_over")  # no cookie
    other.go_to_issuer()
    assert other.get(back).headers["Location"] == failed("sign_in_over")  # another one's state
    assert browser.get(back, **{FLOW_COOKIE: f"{flow[:-2]}AA"}).headers["Location"] == failed("sign_in_over")
    assert browser.get(back, **{FLOW_COOKIE: flow}).headers["Location"] == "/"
    assert browser.get(back).headers["Location"] == failed("sign_in_over")  # it is used up
    assert browser.get(back, **{FLOW_COOKIE: flow}).headers["Location"] == failed("sign_in_invalid")  # and its code is


def test_a_cookie_of_another_secret_is_none(hosted: Hosted) -> None:
    browser = Browser(hosted, address(2))
    back = browser.go_to_issuer()
    state = parse_qs(urlsplit(back).query)["state"][0]
    forged = Flow(state, "nonce", "verifier").sealed("another secret, as long as one has to be, and made up")
    assert browser.get(back, **{FLOW_COOKIE: forged}).headers["Location"] == failed("sign_in_over")


WRONG_CLAIMS = {
    "nonce": {"nonce": "another attempt's"},
    "no nonce": {"nonce": None},
    "audience": {"aud": "another service"},
    "for another beside us": {"aud": [CLIENT, "another service"]},
    "issuer": {"iss": f"https:{'//'}evil.example"},
    "expired": {"exp": 1_700_000_000},
    "no end": {"exp": None},
    "from the future": {"iat": 2**33},
    "nobody": {"sub": None},
    "no text": {"sub": 7},
    "long": {"sub": "x" * 256},
}


@pytest.mark.parametrize("wrong", WRONG_CLAIMS)
def test_a_token_that_says_something_wrong_signs_nobody_in(hosted: Hosted, issuer: TestIssuer, wrong: str) -> None:
    issuer.claims = WRONG_CLAIMS[wrong]
    browser = Browser(hosted, address(10 + list(WRONG_CLAIMS).index(wrong)))
    assert browser.sign_in() == failed("sign_in_invalid")
    assert COOKIE not in browser.cookies


def test_a_clock_that_differs_by_less_than_a_minute_is_no_fault(hosted: Hosted, issuer: TestIssuer) -> None:
    issuer.claims = {"exp": int(time.time()) - 30, "iat": int(time.time()) + 30}
    assert Browser(hosted).sign_in() == "/"


def by_hand(algorithm: str, claims: dict[str, Any], secret: bytes) -> str:
    """Sign as no library lets one: not at all, or by a public key as if it were a secret."""
    parts = ({"alg": algorithm, "typ": "JWT"}, claims)
    signed = ".".join(urlsafe_b64encode(json.dumps(part).encode()).rstrip(b"=").decode() for part in parts)
    signature = hmac.digest(secret, signed.encode(), "sha256") if secret else b""
    return f"{signed}.{urlsafe_b64encode(signature).rstrip(b'=').decode()}"


WRONG_SIGNATURES: dict[str, Callable[[TestIssuer, dict[str, Any]], str]] = {
    "none": lambda _, claims: by_hand("none", claims, b""),
    "HS256 by the public key": lambda issuer, claims: by_hand("HS256", claims, issuer.key.as_pem(private=False)),
    "by a key of somebody else": lambda issuer, claims: jwt.encode(
        {"alg": "RS256", "kid": issuer.key.kid}, claims, RSAKey.generate_key(2048)
    ),
    "nonsense": lambda _, __: "a.b.c",
}


@pytest.mark.parametrize("wrong", WRONG_SIGNATURES)
def test_a_token_that_is_signed_wrong_signs_nobody_in(hosted: Hosted, issuer: TestIssuer, wrong: str) -> None:
    issuer.sign = partial(WRONG_SIGNATURES[wrong], issuer)
    assert Browser(hosted, address(30)).sign_in() == failed("sign_in_invalid")


def test_a_new_key_of_the_issuer_is_looked_up_and_one_made_up_not_over_and_over(
    hosted: Hosted, issuer: TestIssuer
) -> None:
    assert Browser(hosted).sign_in() == "/"
    before = issuer.fetched.count("/keys")
    assert Browser(hosted).sign_in() == "/"
    assert issuer.fetched.count("/keys") == before
    issuer.rotate()
    assert Browser(hosted).sign_in() == "/"
    assert issuer.fetched.count("/keys") == before + 1
    issuer.sign = lambda claims: jwt.encode({"alg": "RS256", "kid": "made up"}, claims, RSAKey.generate_key(2048))
    began = time.monotonic()
    for _ in range(4):
        assert Browser(hosted, address(40)).sign_in() == failed("sign_in_invalid")
    assert issuer.fetched.count("/keys") <= before + 2 + (time.monotonic() - began) // 5


def test_who_does_not_want_to_is_told_so(hosted: Hosted, issuer: TestIssuer) -> None:
    issuer.refuses = True
    assert Browser(hosted).sign_in() == failed("sign_in_refused")


def test_a_member_who_is_removed_is_signed_out_and_does_not_come_back(hosted: Hosted, issuer: TestIssuer) -> None:
    issuer.person = {"sub": "cleo", "name": "Cleo"}
    browser, owner = Browser(hosted), hosted.key("owner", team=TEAM)
    browser.sign_in()
    assert hosted.ask(owner, "DELETE", f"/v1/members/{browser.who()['member']['id']}").status_code == 204
    assert browser.get("/v1/session").status_code == 401
    assert browser.sign_in() == failed("not_member")


def test_whose_sign_in_fails_too_often_waits(hosted: Hosted, issuer: TestIssuer) -> None:
    issuer.claims = {"nonce": "wrong"}
    browser = Browser(hosted, address(50))
    ends = [browser.sign_in() for _ in range(20)]
    assert ends[0] == failed("sign_in_invalid")
    assert ends[-1] == failed("rate_limited")
    issuer.claims = {}
    assert Browser(hosted, address(51)).sign_in() == "/"


def test_two_browsers_of_somebody_new_become_one_member(hosted: Hosted, issuer: TestIssuer) -> None:
    issuer.person = {"sub": "dora", "name": "Dora"}
    browsers = [Browser(hosted) for _ in range(8)]
    backs = [browser.go_to_issuer() for browser in browsers]
    with ThreadPoolExecutor(8) as pool:
        ends = list(pool.map(lambda one: one[0].get(one[1]).headers["Location"], zip(browsers, backs, strict=True)))
    assert ends == ["/"] * 8
    assert len({browser.who()["member"]["id"] for browser in browsers}) == 1
