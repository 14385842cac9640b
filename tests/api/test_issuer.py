"""The issuer where it is away, or not what it should be: nobody waits long for it, and it is rarely asked then."""

import asyncio
import socket
import time
from collections.abc import Iterator

import pytest
from tests.issuer import CLIENT, TestIssuer, issuing

from treestroke.api.issuer import Issuer, IssuerAway
from treestroke.api.oidc_flow import Flow, open_flow
from treestroke.settings import Settings

BACK = f"https:{'//'}trees.example/v1/session/oidc/callback"
SECRET = "a secret of the tests, long enough to sign cookies by"


@pytest.fixture
def issuer() -> Iterator[TestIssuer]:
    with issuing() as found:
        yield found


def ask(url: str, times: int = 1) -> list[str]:
    """Ask for the address to sign in at; give what came of it each time."""

    async def story() -> list[str]:
        issuer, answers = Issuer(Settings(oidc_issuer=url, oidc_client=CLIENT)), []
        for _ in range(times):
            try:
                answers.append(await issuer.sign_in_address(Flow.begin(), BACK))
            except IssuerAway as error:
                answers.append(str(error))
        await issuer.close()
        return answers

    return asyncio.run(story())


def test_its_addresses_and_keys_are_asked_for_once(issuer: TestIssuer) -> None:
    answers = ask(issuer.url, times=5)
    assert all(answer.startswith(f"{issuer.url}/authorize?") for answer in answers)
    assert issuer.fetched == ["/.well-known/openid-configuration", "/keys"]


def test_one_that_does_not_answer_is_given_up_and_then_left_alone_for_a_while() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        began = time.monotonic()
        answers = ask(f"http:{'//'}127.0.0.1:{silent.getsockname()[1]}", times=50)
        assert time.monotonic() - began < 60
    assert answers[-1] == "it was away a moment ago"


def test_one_that_is_gone_is_away() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    (answer,) = ask(f"http:{'//'}127.0.0.1:{port}")
    assert "openid-configuration" in answer


def test_one_that_calls_itself_otherwise_is_none(issuer: TestIssuer) -> None:
    (answer,) = ask(f"{issuer.url}/")
    assert answer.startswith(f"it calls itself {issuer.url}, not {issuer.url}/")


@pytest.mark.parametrize("wrong", [f"http:{'//'}id.example/token", "javascript:alert(1)", 7, None])
def test_one_whose_addresses_are_not_secret_is_none(
    issuer: TestIssuer, wrong: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = {**(issuer.answer("/.well-known/openid-configuration") or {}), "token_endpoint": wrong}
    monkeypatch.setattr(issuer, "answer", lambda path: told)
    (answer,) = ask(issuer.url)
    assert answer.startswith("its addresses are not all there, and https")


def test_a_flow_is_kept_in_a_cookie_for_ten_minutes(monkeypatch: pytest.MonkeyPatch) -> None:
    flow = Flow.begin("mdl_1")
    cookie = flow.sealed(SECRET)
    assert open_flow(cookie, SECRET) == flow
    assert open_flow(cookie, f"{SECRET} and another") is None
    assert open_flow("", SECRET) is open_flow("a.b.c", SECRET) is None
    now = time.time()
    monkeypatch.setattr(time, "time", lambda: now - 601)
    late = flow.sealed(SECRET)
    monkeypatch.undo()
    assert open_flow(late, SECRET) is None
