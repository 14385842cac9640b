"""Connections that are slow, silent or too many, on a real server with a small application."""

import asyncio
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from typing import Any

import pytest
import uvicorn
from starlette.types import Receive, Scope, Send
from tests.faults.processes import wait_for

from treestroke.api import connections
from treestroke.api.connections import Connection

GET = b"GET / HTTP/1.1\r\nHost: x\r\n"
PATIENCE_SECONDS = 120.0
"""Emergency exit of what is waited for."""
HEAD_SECONDS, LATE_SECONDS = 2.0, 2.5
"""A limit that no stall of a busy machine reaches, and what takes longer."""


released = threading.Event()
"""Set when the application may answer what is held."""


async def application(scope: Scope, receive: Receive, send: Send) -> None:
    """Answer at once, or as the path says: when the body is whole, after a while, or at length."""
    path, size = scope["path"], 2
    if path == "/upload":
        while (await receive()).get("more_body"):
            pass
    if path == "/late":
        await asyncio.sleep(LATE_SECONDS)
    while path == "/held" and not released.is_set():
        await asyncio.sleep(0.01)
    size = {"/large": 20_000_000, "/large/events": 20_000_000, "/medium": 1_000_000, "/small": 90_000}.get(path, size)
    await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"%d" % size)]})
    await send({"type": "http.response.body", "body": bytes(size)})


class Served:
    """The server, and lines to it."""

    def __init__(self, server: uvicorn.Server, port: int, lines: ExitStack) -> None:
        self._server, self._port, self._lines = server, port, lines

    @property
    def open(self) -> int:
        return len(self._server.server_state.connections)

    @property
    def answering(self) -> int:
        return sum(one.responding for one in list(self._server.server_state.connections))  # type: ignore[union-attr]

    @property
    def behind(self) -> int:
        return sum(not one.priority[0] for one in list(self._server.server_state.connections))  # type: ignore[union-attr]

    def line(self, said: bytes = b"") -> socket.socket:
        """Open a connection and say something."""
        line = self._lines.enter_context(socket.create_connection(("127.0.0.1", self._port), PATIENCE_SECONDS))
        line.sendall(said)
        return line

    def ask(self, path: bytes = b"/") -> bytes:
        line = self.line(b"GET " + path + b" HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")
        return rest(line)

    def slow_line(self, path: bytes) -> socket.socket:
        """Ask for what is longer than what this side takes of it without being read."""
        line = self._lines.enter_context(socket.socket())
        line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2304)
        line.connect(("127.0.0.1", self._port))
        line.sendall(GET.replace(b"/ ", path + b" ", 1) + b"\r\n")
        return line


def rest(line: socket.socket) -> bytes:
    """Give all that comes until the other side closes, however it does."""
    said = bytearray()
    with suppress(ConnectionResetError):
        while part := line.recv(65536):
            said += part
    return bytes(said)


def answer(line: socket.socket) -> bytes:
    """Give the one short answer that comes, of a connection that stays."""
    said = b""
    while not said.endswith(b"\r\n\r\n\0\0"):
        part = line.recv(65536)
        assert part, said
        said += part
    return said


@contextmanager
def serving(keep_alive_s: int = 30, **limits: Any) -> Iterator[Served]:
    config = uvicorn.Config(
        application,
        port=0,
        lifespan="off",
        log_config=None,
        ws="none",
        timeout_keep_alive=keep_alive_s,
        http=partial(Connection, **{"limit": 100, "head_s": PATIENCE_SECONDS, **limits}),  # type: ignore[arg-type]
    )
    server = uvicorn.Server(config)
    thread = threading.Thread(target=server.run)
    thread.start()
    wait_for(lambda: server.started, PATIENCE_SECONDS, "the server")
    listener = server.servers[0].sockets[0]
    listener.setsockopt(
        socket.SOL_SOCKET, socket.SO_SNDBUF, 16_384
    )  # connections have what it has: little is in the kernel
    try:
        with ExitStack() as lines:
            yield Served(server, listener.getsockname()[1], lines)
    finally:
        server.should_exit = True
        thread.join()


def test_a_silent_connection_is_closed_without_a_word() -> None:
    with serving(head_s=0.2) as served:
        assert rest(served.line()) == b""


@pytest.mark.parametrize("before", [b"", GET + b"\r\n"])
def test_a_head_that_comes_byte_by_byte_is_given_up(before: bytes) -> None:
    with serving(head_s=0.3) as served:
        line = served.line(before)
        if before:
            assert answer(line).startswith(b"HTTP/1.1 200 ")
        began = time.monotonic()
        line.settimeout(0.02)
        said = b""
        while not said and time.monotonic() - began < PATIENCE_SECONDS:
            line.sendall(b"G" if before else b"A")
            try:
                said = line.recv(65536)
            except TimeoutError:
                continue
        assert said.startswith(b"HTTP/1.1 408 ")
        assert b"application/problem+json" in said
        assert b"connection: close" in said.lower()


def test_a_connection_that_rests_between_requests_stays() -> None:
    with serving(head_s=HEAD_SECONDS) as served:
        line = served.line(GET + b"\r\n")
        for _ in range(2):
            assert answer(line).startswith(b"HTTP/1.1 200 ")
            time.sleep(LATE_SECONDS)
            line.sendall(GET + b"\r\n")
        assert answer(line).startswith(b"HTTP/1.1 200 ")


def test_an_answer_may_take_longer_than_a_head() -> None:
    with serving(head_s=HEAD_SECONDS) as served:
        assert served.ask(b"/late").startswith(b"HTTP/1.1 200 ")


def test_a_body_that_nobody_wants_does_not_hold_a_connection() -> None:
    with serving(head_s=HEAD_SECONDS) as served:
        line = served.line(b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 1000000\r\n\r\n")
        assert answer(line).startswith(b"HTTP/1.1 200 ")
        wait_for(lambda: not served.open, PATIENCE_SECONDS, "the connection's end")


@pytest.mark.parametrize("path", [b"/large", b"/small"])  # what the application waits for, and what it is done with
@pytest.mark.parametrize("keep_alive_s", [0, 30])
def test_a_client_that_reads_nothing_is_given_up(path: bytes, keep_alive_s: int) -> None:
    with serving(keep_alive_s, stalled_s=0.4, behind_s=0.1) as served:
        served.slow_line(path)
        wait_for(lambda: served.answering, PATIENCE_SECONDS, "the answer")
        wait_for(lambda: not served.open, PATIENCE_SECONDS, "the connection's end")
        assert served.ask().startswith(b"HTTP/1.1 200 ")


def test_a_stream_that_nobody_reads_is_given_up_sooner_than_a_download(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "STREAM_SHARE", 0.4 / PATIENCE_SECONDS)
    with serving(stalled_s=PATIENCE_SECONDS, behind_s=0.1) as served:
        served.slow_line(b"/large")
        served.slow_line(b"/large/events")
        wait_for(lambda: served.behind == 2, PATIENCE_SECONDS, "both being behind")
        wait_for(lambda: served.open == 1, PATIENCE_SECONDS, "the stream's end")
        assert served.ask().startswith(b"HTTP/1.1 200 ")


def test_a_client_that_reads_a_little_now_and_then_is_given_up() -> None:
    with serving(stalled_s=0.5, behind_s=0.1, min_rate=1_000_000) as served:
        line = served.slow_line(b"/medium")
        wait_for(lambda: served.open, PATIENCE_SECONDS, "the connection")
        got = 0
        with suppress(ConnectionResetError):
            while part := line.recv(2000):
                got += len(part)
                time.sleep(0.02)
        assert 0 < got < 1_000_000


def test_a_client_that_reads_slowly_and_fast_enough_gets_all() -> None:
    with serving(stalled_s=HEAD_SECONDS, behind_s=0.1, min_rate=1000) as served:
        line = served.line(GET.replace(b"/ ", b"/medium ", 1) + b"Connection: close\r\n\r\n")
        got = 0
        while part := line.recv(50_000):
            got += len(part)
            time.sleep(LATE_SECONDS / 20)
        assert got > 1_000_000


def test_who_does_not_read_makes_room_for_others() -> None:
    with serving(limit=2, behind_s=0.2) as served:
        for path in (b"/large", b"/small"):
            served.slow_line(path)
        wait_for(lambda: served.behind == 2, PATIENCE_SECONDS, "both being behind")
        answers = [served.line(GET.replace(b"/ ", b"/late ", 1) + b"\r\n") for _ in range(2)]
        assert all(answer(line).startswith(b"HTTP/1.1 200 ") for line in answers)


def test_silent_connections_make_room_the_oldest_first() -> None:
    with serving(limit=3) as served:
        silent = [served.line() for _ in range(3)]
        for _ in range(2):
            assert served.ask().startswith(b"HTTP/1.1 200 ")
        assert rest(silent[0]).startswith(b"HTTP/1.1 503 ")
        silent[2].sendall(GET + b"\r\n")
        assert answer(silent[2]).startswith(b"HTTP/1.1 200 ")


def test_an_upload_under_way_makes_room_only_where_nobody_is_silent() -> None:
    with serving(limit=2) as served:
        upload = served.line(b"POST /upload HTTP/1.1\r\nHost: x\r\nContent-Length: 2\r\n\r\n1")
        wait_for(lambda: served.answering, PATIENCE_SECONDS, "the upload")
        silent = served.line()
        assert served.ask().startswith(b"HTTP/1.1 200 ")
        assert rest(silent).startswith(b"HTTP/1.1 503 ")
        upload.sendall(b"2")
        assert answer(upload).startswith(b"HTTP/1.1 200 ")


def test_where_every_request_is_whole_one_more_is_told_to_come_again() -> None:
    released.clear()
    with serving(limit=2) as served:
        lines = [served.line(GET.replace(b"/ ", b"/held ", 1) + b"\r\n") for _ in range(2)]
        wait_for(lambda: served.answering == 2, PATIENCE_SECONDS, "both requests")
        refused = rest(served.line())
        released.set()
        assert refused.startswith(b"HTTP/1.1 503 ")
        assert b"retry-after: 1" in refused.lower()
        assert all(answer(line).startswith(b"HTTP/1.1 200 ") for line in lines)


def test_what_is_no_http_is_refused_as_a_problem() -> None:
    with serving() as served:
        said = rest(served.line(b"nonsense\r\n\r\n"))
    assert said.startswith(b"HTTP/1.1 400 ")
    assert b"application/problem+json" in said


CHUNKED = b"POST %s HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"


@pytest.mark.parametrize("path", [b"/", b"/upload"])
@pytest.mark.parametrize("chunk", [b"g\r\n", b"5\r\nhello\r\nXYZ\r\n", b"5\r\nhelloXX"])
def test_a_chunk_that_is_none_is_refused_once_and_without_an_error(
    path: bytes, chunk: bytes, caplog: pytest.LogCaptureFixture
) -> None:
    with serving() as served:
        said = rest(served.line(CHUNKED % path + chunk))
    assert said.startswith(b"HTTP/1.1 400 ")
    assert said.count(b"HTTP/1.1 ") == 1
    assert b"application/problem+json" in said
    assert [record for record in caplog.records if record.levelname == "ERROR"] == []


def test_a_client_that_is_refused_while_it_sends_can_send_the_rest_and_read_why() -> None:
    with serving() as served:
        line = served.line(CHUNKED % b"/upload" + b"XYZ\r\n")
        for _ in range(20):
            line.sendall(bytes(100_000))
        said = b""
        while part := line.recv(65536):
            said += part
        assert said.startswith(b"HTTP/1.1 400 ")
        line.close()
        wait_for(lambda: not served.open, PATIENCE_SECONDS, "the connection's end")


def test_a_refused_client_does_not_keep_its_connection() -> None:
    with serving() as served:
        assert rest(served.line(b"nonsense\r\n\r\n")).startswith(b"HTTP/1.1 400 ")
        wait_for(lambda: not served.open, PATIENCE_SECONDS, "the connection's end")
