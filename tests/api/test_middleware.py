import asyncio
import json
import socket
from collections.abc import AsyncIterator, Iterator
from contextlib import suppress
from typing import Any

import httpx
import pytest
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.types import Message, Receive, Scope, Send
from tests.api import drawn, jumping_clock
from tests.api.conftest import Service
from tests.promises import kept

from treestroke.api.middleware import BodyLimitMiddleware

PATIENCE_SECONDS = 10.0
CALLS = [
    ("GET", "/"),
    ("GET", "/livez"),
    ("GET", "/metrics"),
    ("GET", "/openapi.json"),
    ("GET", "/v1/models"),
    ("POST", "/v1/models"),
    ("POST", "/v1/photos"),
    ("PATCH", "/v1/models/x"),
    ("DELETE", "/v1/models/x"),
    ("PUT", "/v1/models/x"),
    ("OPTIONS", "/v1/models"),
    ("GET", "/nothing"),
]
WRITES = [
    ("POST", "/v1/models", 400),
    ("PATCH", "/v1/models/x", 400),
    ("DELETE", "/v1/photos/x", 404),
    ("PUT", "/v1/models/x", 405),
]


@pytest.mark.parametrize(("method", "path"), CALLS)
@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1.evil.example", "localhost.evil", "10.0.0.1", "", "[::2]", "[", "evil:80"]
)
def test_a_foreign_host_is_refused_on_every_call(client: httpx.Client, method: str, path: str, host: str) -> None:
    answer = client.request(method, path, headers={"Host": host})
    assert (answer.status_code, answer.json()["code"]) == (403, "foreign_host")
    assert answer.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize(("method", "path"), CALLS)
@pytest.mark.parametrize(
    "origin", ["null", "https:HOSTevil.example", "http:HOST127.0.0.1:1", "http:HOSTlocalhost", "", "file:HOST", "x"]
)
def test_a_foreign_origin_is_refused_on_every_call(client: httpx.Client, method: str, path: str, origin: str) -> None:
    answer = client.request(method, path, headers={"Origin": origin.replace("HOST", "//")})
    assert (answer.status_code, answer.json()["code"]) == (403, "foreign_origin")


def test_a_page_of_another_port_of_this_machine_is_foreign(service: Service) -> None:
    other = f"http:{'//'}127.0.0.1:{service.port + 1}"
    assert service.client.get("/livez", headers={"Origin": other}).status_code == 403


@pytest.mark.parametrize("name", ["127.0.0.1", "localhost", "[::1]"])
def test_its_own_page_is_answered(service: Service, name: str) -> None:
    host = f"{name}:{service.port}"
    for origin in ({}, {"Origin": f"http:{'//'}{host}"}):
        assert service.client.get("/livez", headers={"Host": host, **origin}).status_code == 200


@pytest.mark.parametrize("site", ["cross-site", "same-site", "nonsense"])
def test_what_another_page_writes_is_refused_even_without_its_origin(service: Service, site: str) -> None:
    before, headers = service.stored(), {"Sec-Fetch-Site": site}
    for method, path, _ in WRITES:
        answer = service.client.request(method, path, headers=headers)
        assert (answer.status_code, answer.json()["code"]) == (403, "foreign_origin"), path
    assert service.client.post("/v1/photos", files={"file": drawn.encoded()}, headers=headers).status_code == 403
    assert service.client.get("/", headers=headers).status_code == service.client.get("/").status_code
    assert service.stored() == before


@pytest.mark.parametrize("site", ["same-origin", "none"])
def test_its_own_page_and_its_user_may_write(client: httpx.Client, site: str) -> None:
    for method, path, status in WRITES:
        assert client.request(method, path, headers={"Sec-Fetch-Site": site}).status_code == status, path


def test_nothing_is_done_for_a_foreign_page(service: Service) -> None:
    before = service.stored()
    foreign = {"Origin": "null"}
    assert service.client.post("/v1/photos", content=drawn.encoded(), headers=foreign).status_code == 403
    assert service.client.post("/v1/models", **drawn.form(drawn.encoded()), headers=foreign).status_code == 403
    assert service.stored() == before


def test_no_answer_opens_the_service_to_other_pages(client: httpx.Client) -> None:
    for path in ("/livez", "/v1/models", "/openapi.json"):
        assert not [name for name in client.get(path).headers if name.startswith("access-control")]


@pytest.mark.parametrize("path", ["/v1/photos", "/v1/models"])
@pytest.mark.parametrize("chunked", [False, True])
def test_a_body_that_is_too_large_is_refused(service: Service, path: str, chunked: bool) -> None:
    before = service.stored()
    size = 30_000_000 if path == "/v1/photos" else 90_000_000
    content: Any = _chunks(size) if chunked else bytes(size)
    kind = "image/jpeg" if path == "/v1/photos" else "application/json"
    answer = service.client.post(path, content=content, headers={"Content-Type": kind})
    assert (answer.status_code, answer.json()["code"]) == (413, "body_too_large")
    assert answer.headers["content-type"] == "application/problem+json"
    assert service.stored() == before


def _chunks(size: int) -> Iterator[bytes]:
    for _ in range(0, size, 100_000):
        yield bytes(100_000)


def test_a_form_with_a_photo_that_is_too_large_is_refused(service: Service) -> None:
    before = service.stored()
    for answer in (
        service.client.post("/v1/photos", files={"file": bytes(25_000_001)}),
        service.client.post("/v1/models", **drawn.form(bytes(25_000_001))),
    ):
        assert (answer.status_code, answer.json()["code"]) == (413, "body_too_large")
    assert service.stored() == before


@pytest.mark.parametrize(("method", "path"), [("PATCH", "/v1/models/x"), ("POST", "/v1/models/x/cancel")])
def test_other_bodies_are_short(client: httpx.Client, method: str, path: str) -> None:
    assert client.request(method, path, content=bytes(100_001)).status_code == 413


def _spoken(service: Service, request: bytes, then: bytes = b"", close: bool = False) -> bytes:
    """Speak to the service byte by byte; give all that it answers until it or we close."""
    with socket.create_connection(("127.0.0.1", service.port), timeout=10) as line:
        line.sendall(request)
        if then:
            line.sendall(then)
        if close:
            line.shutdown(socket.SHUT_WR)
        answer = b""
        while part := line.recv(65536):
            answer += part
            if b"\r\n\r\n" in answer and b"}" in answer:
                break
    return answer


def _head(service: Service, path: str, *headers: str, method: str = "POST") -> bytes:
    lines = [f"{method} {path} HTTP/1.1", f"Host: 127.0.0.1:{service.port}", *headers]
    return ("\r\n".join(lines) + "\r\n\r\n").encode()


def test_a_length_that_says_too_much_is_refused_before_the_body_comes(service: Service) -> None:
    answer = _spoken(service, _head(service, "/v1/photos", "Content-Type: image/png", f"Content-Length: {10**12}"))
    assert answer.startswith(b"HTTP/1.1 413 ")
    assert b"application/problem+json" in answer


def test_a_body_that_is_shorter_than_it_says_leaves_nothing(service: Service) -> None:
    before = service.stored()
    head = _head(service, "/v1/photos", "Content-Type: image/png", "Content-Length: 100000")
    _spoken(service, head, drawn.encoded()[:5000], close=True)
    assert service.client.get("/livez").status_code == 200
    assert service.stored() == before


def test_a_body_that_is_longer_than_it_says_is_cut_there(service: Service) -> None:
    content = drawn.encoded()
    head = _head(service, "/v1/photos", "Content-Type: image/png", f"Content-Length: {len(content) - 100}")
    assert b"photo_unreadable" in _spoken(service, head, content)


@pytest.mark.parametrize("length", ["-1", "1e3", "x", "1, 2", "99999999999999999999999"])
def test_a_length_that_is_none_is_refused(service: Service, length: str) -> None:
    head = _head(service, "/v1/photos", "Content-Type: image/png", f"Content-Length: {length}")
    assert _spoken(service, head, close=True)[:12] in (b"HTTP/1.1 400", b"HTTP/1.1 413")


SMUGGLED = b"GET /v1/smuggled HTTP/1.1\r\nHost: x\r\n\r\n"


@pytest.mark.parametrize(
    "headers",
    [
        ["Content-Length: 5", "Transfer-Encoding: chunked"],
        ["Transfer-Encoding: chunked", "Content-Length: 0"],
        ["Content-Length: 5", "Content-Length: 6"],
        ["Content-Length: 5, 6"],
        ["Content-Length: +5"],
        ["Content-Length: 0x5"],
        ["Transfer-Encoding: chunked", "Transfer-Encoding: chunked"],
        ["Transfer-Encoding: chunked, identity"],
        ["Transfer-Encoding: xchunked"],
        ["Transfer-Encoding : chunked"],
        ["Transfer-Encoding\t: chunked"],
        ["X: 1\rTransfer-Encoding: chunked", "Content-Length: 5"],
        ["Host: 127.0.0.1"],
    ],
)
def test_a_request_whose_end_is_ambiguous_is_refused_and_nothing_after_it_is_read(
    service: Service, headers: list[str]
) -> None:
    head = _head(service, "/v1/photos", "Content-Type: image/png", *headers)
    said = _said(service, head + b"0\r\n\r\n" + SMUGGLED)
    assert said.startswith(b"HTTP/1.1 400 ")
    assert said.count(b"HTTP/1.1 ") == 1
    assert b"application/problem+json" in said


def test_a_chunked_body_of_an_old_client_is_refused(service: Service) -> None:
    head = _head(service, "/v1/photos", "Transfer-Encoding: chunked").replace(b"HTTP/1.1", b"HTTP/1.0")
    assert _said(service, head + b"0\r\n\r\n").startswith(b"HTTP/1.1 400 ")


@pytest.mark.parametrize("size", [b"0x1", b"+1", b"-1", b" 1", b"1\n", b"", b"1;a\nb", b"g"])
def test_a_chunk_of_no_size_is_refused(service: Service, size: bytes) -> None:
    head = _head(service, "/v1/models", "Content-Type: application/json", "Transfer-Encoding: chunked")
    said = _said(service, head + size + b"\r\n1\r\n0\r\n\r\n" + SMUGGLED)
    assert said.startswith(b"HTTP/1.1 400 ")
    assert said.count(b"HTTP/1.1 ") == 1


def _said(service: Service, request: bytes) -> bytes:
    """Send a request; give all that comes until the service closes."""
    said = b""
    with socket.create_connection(("127.0.0.1", service.port), timeout=10) as line, suppress(ConnectionResetError):
        line.sendall(request)
        while part := line.recv(65536):
            said += part
    return said


def test_slow_bodies_hold_nobody_up(service: Service) -> None:
    head = _head(service, "/v1/photos", "Content-Type: image/png", "Content-Length: 100000")
    lines = [socket.create_connection(("127.0.0.1", service.port), timeout=5) for _ in range(50)]
    try:
        for line in lines:
            line.sendall(head + b"1")
        with kept(2.0):
            assert service.client.get("/v1/models").status_code == 200
            assert service.client.post("/v1/photos", content=drawn.encoded()).status_code == 201
    finally:
        for line in lines:
            line.close()


async def _speak(
    bodies: AsyncIterator[bytes], limit: int = 1000, patience_s: float = 0.2, slowest: float = 1000.0
) -> tuple[int, bytes]:
    """Send a body through `Limited` alone; give the status that it comes to and what arrived."""
    got = b""

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        nonlocal got
        got = await Request(scope, receive).body()

    async def receive() -> Message:
        try:
            return {"type": "http.request", "body": await anext(bodies), "more_body": True}
        except StopAsyncIteration:
            return {"type": "http.request", "body": b"", "more_body": False}

    scope: Scope = {"type": "http", "method": "POST", "path": "/", "headers": []}
    try:
        await BodyLimitMiddleware(app, lambda _: limit, patience_s, slowest)(scope, receive, _unsent)
    except HTTPException as error:
        return error.status_code, got
    return 200, got


def test_all_bodies_together_are_bounded() -> None:
    outcomes: list[int] = []
    limited = BodyLimitMiddleware(_read_whole, lambda _: 1000, held_bytes=1500)

    async def come() -> None:
        bodies = _pieces(10, 100, 0.01)

        async def receive() -> Message:
            try:
                return {"type": "http.request", "body": await anext(bodies), "more_body": True}
            except StopAsyncIteration:
                return {"type": "http.request", "body": b"", "more_body": False}

        try:
            await limited({"type": "http", "method": "POST", "path": "/", "headers": []}, receive, _unsent)
            outcomes.append(200)
        except HTTPException as error:
            outcomes.append(error.status_code)

    async def crowd() -> None:
        await asyncio.gather(come(), come())
        await come()  # what was held is free again

    jumping_clock.run(crowd())
    assert sorted(outcomes[:2]) == [200, 503]
    assert outcomes[2] == 200


def test_a_body_that_came_fast_and_fell_silent_is_given_up_as_soon_as_any_other() -> None:
    async def bodies() -> AsyncIterator[bytes]:
        yield bytes(900)  # 90 s at the slowest rate
        await asyncio.sleep(PATIENCE_SECONDS)

    async def speak() -> tuple[int, bytes]:
        return await asyncio.wait_for(_speak(bodies(), slowest=10.0), PATIENCE_SECONDS / 2)

    assert jumping_clock.run(speak())[0] == 408


def test_silent_halves_of_bodies_make_room_for_one_that_comes() -> None:
    outcomes: dict[str, int] = {}
    limited = BodyLimitMiddleware(_read_whole, lambda _: 1000, patience_s=1.5, min_rate=1000.0, held_bytes=2100)

    async def come(name: str, *pieces: bytes) -> None:
        left = list(pieces)

        async def receive() -> Message:
            if not left:
                await asyncio.sleep(PATIENCE_SECONDS)
            piece = left.pop(0)
            return {"type": "http.request", "body": piece, "more_body": piece[-1:] != b"."}

        try:
            await limited({"type": "http", "method": "POST", "path": "/", "headers": []}, receive, _unsent)
            outcomes[name] = 200
        except HTTPException as error:
            outcomes[name] = error.status_code

    async def crowd() -> None:
        first = asyncio.create_task(come("first", bytes(900)))
        await asyncio.sleep(0.1)
        second = asyncio.create_task(come("second", bytes(900)))
        await asyncio.sleep(0)
        await come("early", bytes(800), b".")
        await asyncio.sleep(0.9)
        await come("whole", bytes(800), b".")
        await first
        assert not second.done()
        await second

    jumping_clock.run(crowd())
    assert outcomes == {"early": 503, "whole": 200, "first": 408, "second": 408}


async def _read_whole(scope: Scope, receive: Receive, send: Send) -> None:
    await Request(scope, receive).body()


async def _unsent(message: Message) -> None:
    raise AssertionError(message)


async def _pieces(count: int, size: int, pause_s: float) -> AsyncIterator[bytes]:
    for _ in range(count):
        await asyncio.sleep(pause_s)
        yield bytes(size)


@pytest.mark.parametrize(
    ("pieces", "wanted"),
    [
        ((3, 100, 0.0), (200, bytes(300))),
        ((1000, 1, 0.0), (200, bytes(1000))),
        ((1001, 1, 0.0), (413, b"")),
        ((1, 5000, 0.0), (413, b"")),
        ((100, 1, 0.02), (408, b"")),  # a byte now and then
        ((1, 1, 10.0), (408, b"")),  # nothing at all
        ((10, 100, 0.05), (200, bytes(1000))),  # slow, and fast enough
    ],
)
def test_a_body_is_counted_and_given_up_where_it_hardly_comes(
    pieces: tuple[int, int, float], wanted: tuple[int, bytes]
) -> None:
    async def speak() -> tuple[tuple[int, bytes], float]:
        return await _speak(_pieces(*pieces)), asyncio.get_running_loop().time()

    outcome, took_s = jumping_clock.run(speak())
    assert outcome == wanted
    assert took_s < 2


def test_a_problem_says_what_to_do(client: httpx.Client) -> None:
    told = client.post("/v1/photos", content=bytes(30_000_000), headers={"Content-Type": "image/png"}).json()
    assert json.dumps(told["detail"]) == '"the request\'s body has more than 25.1 MB; make it smaller"'
