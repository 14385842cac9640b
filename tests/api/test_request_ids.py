import asyncio
import json
import socket
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from starlette.types import ASGIApp, Receive, Scope, Send
from tests.api.conftest import Service
from tests.running import serving

from treestroke.api.app import make_app
from treestroke.api.request_ids import HEADER, RequestIdMiddleware, identify, request_id
from treestroke.settings import Settings

CALLS = [
    ("GET", "/"),
    ("GET", "/livez"),
    ("GET", "/metrics"),
    ("HEAD", "/v1/models"),
    ("OPTIONS", "/v1/models"),
    ("GET", "/v1/models/x"),
    ("PUT", "/v1/models"),
    ("BREW", "/v1/models"),
    ("POST", "/v1/models"),
    ("GET", "/nothing"),
]


@pytest.mark.parametrize(("method", "path"), CALLS)
def test_every_response_has_an_id_of_its_own_and_a_problem_has_the_same(
    client: httpx.Client, method: str, path: str
) -> None:
    answers = [client.request(method, path) for _ in range(2)]
    assert len({answer.headers[HEADER] for answer in answers}) == 2
    for answer in answers:
        if answer.headers.get("content-type") == "application/problem+json":
            assert answer.json()["request_id"] == answer.headers[HEADER]


def test_what_is_refused_before_there_is_a_request_has_an_id_too(service: Service) -> None:
    for sent in (b"nonsense\r\n\r\n", b"GET /livez HTTP/1.1\r\nHost: x\r\n\r\n"):
        with socket.create_connection(("127.0.0.1", service.port), timeout=60) as line:
            line.sendall(sent)
            head, _, body = line.recv(10_000).partition(b"\r\n\r\n")
        assert f"x-request-id: {json.loads(body)['request_id']}" in head.decode().lower()


def answered(app: ASGIApp, path: str, **headers: str) -> httpx.Response:
    async def ask() -> httpx.Response:
        transport = httpx.ASGITransport(app, raise_app_exceptions=False, client=("10.0.0.1", 1))
        async with httpx.AsyncClient(transport=transport, base_url=f"http:{'//'}127.0.0.1") as client:
            return await client.get(path, headers=headers)

    return asyncio.run(ask())


def asked(given: str, proxies: list[str]) -> str:
    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": request_id().encode()})

    answer = answered(RequestIdMiddleware(app, proxies), "/", **{HEADER: given})
    assert answer.text == answer.headers[HEADER]
    return answer.text


@pytest.mark.parametrize(
    ("given", "proxies", "kept"),
    [
        ("of-the.proxy_1", ["10.0.0.1"], True),
        ("of-the.proxy_1", [], False),
        ("a" * 64, ["10.0.0.1"], True),
        ("a" * 65, ["10.0.0.1"], False),
        ("two words", ["10.0.0.1"], False),
        ("", ["10.0.0.1"], False),
    ],
)
def test_a_plain_id_of_a_trusted_proxy_is_kept(given: str, proxies: list[str], kept: bool) -> None:
    assert (asked(given, proxies) == given) == kept


def test_an_id_cannot_be_guessed() -> None:
    assert len({identify() for _ in range(100)}) == 100
    assert len(identify()) == 32


def test_an_error_that_nobody_expected_is_told_and_logged_by_its_id(tmp_path: Path) -> None:
    app = make_app(Settings(data=tmp_path))

    @app.get("/broken", name="live")
    def broken() -> None:
        raise ZeroDivisionError

    answer = answered(app, "/broken")
    assert (answer.status_code, answer.json()["code"]) == (500, "internal")
    assert answer.headers[HEADER] == answer.json()["request_id"]
    assert answer.headers[HEADER] in answer.json()["detail"]


@pytest.fixture
def broken(tmp_path: Path) -> Iterator[tuple[httpx.Client, Path]]:
    """A service whose files are gone."""
    with serving(tmp_path / "data", workers=0, tracers=1) as url, httpx.Client(base_url=url, timeout=60) as client:
        yield client, tmp_path / "data"


def test_lines_that_requests_cause_name_them(broken: tuple[httpx.Client, Path]) -> None:
    client, data = broken
    (data / "treestroke.sqlite3").rename(data / "elsewhere")
    answers = [client.get("/v1/models") for _ in range(5)]
    assert {answer.status_code for answer in answers} == {503}
    (data / "elsewhere").rename(data / "treestroke.sqlite3")
    log = data.parent / "data.log"
    first = next(json.loads(line) for line in log.read_text().splitlines() if "storage_failed" in line)
    assert first["request_id"] == answers[0].headers[HEADER]
