"""What one attempt to send a message does, against a receiver that behaves in every way."""

import socket
import threading
import time
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler

import pytest
from tests.receiver import NAME, Receiver, answering, receiving

from treestroke.service.public_addresses import is_public
from treestroke.service.webhook_calls import Caller, CallFailed, NotPublic, read_url

HTTPS = f"https:{'//'}"
SOON = 1.5
"""Seconds after which a receiver that says nothing is given up, so that tests end."""


@pytest.fixture(scope="module")
def running() -> Iterator[Receiver]:
    with receiving() as receiver:
        yield receiver


@pytest.fixture
def receiver(running: Receiver) -> Receiver:
    running.behave = answering(200)
    running.arrived.clear()
    return running


def fails(receiver: Receiver, **changed: object) -> str:
    """Send a message that is not taken, and say why."""
    with pytest.raises(CallFailed) as failed:
        receiver.caller(**changed).post(receiver.url, {}, b"{}")
    return str(failed.value)


def writing(piece: bytes, seconds: float = 0.1) -> Callable[[BaseHTTPRequestHandler], None]:
    """Answer by the same piece over and over, for as long as somebody listens."""

    def behave(request: BaseHTTPRequestHandler) -> None:
        request.wfile.write(b"HTTP/1.1 200 OK\r\n")
        while True:
            request.wfile.write(piece)
            time.sleep(seconds)

    return behave


def test_a_message_arrives_as_it_was_sent(receiver: Receiver) -> None:
    assert receiver.caller().post(receiver.url, {"webhook-id": "msg_1"}, b'{"type": "ping"}') == 200
    (message,) = receiver.arrived
    assert (message.path, message.id, message.body) == ("/hook?of=trees", "msg_1", '{"type": "ping"}')
    assert message.headers["host"] == f"{NAME}:{receiver.port}"


@pytest.mark.parametrize("status", [204, 301, 302, 307, 308, 410, 500])
def test_the_status_is_told_and_no_redirect_is_followed(receiver: Receiver, status: int) -> None:
    receiver.behave = answering(status)
    assert receiver.caller().post(receiver.url, {}, b"{}") == status
    assert len(receiver.arrived) == 1


def test_a_receiver_that_says_nothing_is_given_up(receiver: Receiver) -> None:
    over = threading.Event()
    receiver.behave = lambda _: over.wait(60) and None
    try:
        assert fails(receiver, seconds=SOON) == "no answer within 1.5 s"
    finally:
        over.set()


def test_a_receiver_that_drips_is_given_up_in_the_same_time(receiver: Receiver) -> None:
    receiver.behave = writing(b"X-Drip: 1\r\n")
    assert fails(receiver, seconds=SOON) == "no answer within 1.5 s"


def test_a_head_without_end_is_not_read_to_its_end(receiver: Receiver) -> None:
    receiver.behave = writing(b"X-Flood: " + b"x" * 9000 + b"\r\n", 0)
    assert "longer than 64 kB" in fails(receiver)


def test_of_a_large_answer_the_head_alone_is_read(receiver: Receiver) -> None:
    def behave(request: BaseHTTPRequestHandler) -> None:
        request.send_response(200)
        request.send_header("Content-Length", str(10**12))
        request.end_headers()

    receiver.behave = behave
    assert receiver.caller().post(receiver.url, {}, b"{}") == 200


def test_a_receiver_that_hangs_up_has_not_taken_the_message(receiver: Receiver) -> None:
    receiver.behave = lambda request: request.connection.shutdown(socket.SHUT_RDWR)
    assert fails(receiver).startswith("no answer: ")


def test_nobody_listens() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    caller = Caller(allowed=lambda _: True)
    with pytest.raises(CallFailed, match="no answer: "):
        caller.post(f"{HTTPS}127.0.0.1:{port}/", {}, b"")


def test_the_certificate_must_be_the_names(receiver: Receiver) -> None:
    other = receiver.url.replace(NAME, "other.example")
    with pytest.raises(CallFailed, match="its certificate is not valid"):
        receiver.caller().post(other, {}, b"{}")
    assert receiver.arrived == []


def test_an_authority_that_nobody_trusts_is_refused(receiver: Receiver) -> None:
    with pytest.raises(CallFailed, match="its certificate is not valid"):
        Caller(lambda _: True, lambda *_: ["127.0.0.1"]).post(receiver.url, {}, b"{}")


def test_proxies_of_the_environment_are_not_used(receiver: Receiver, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("https_proxy", "HTTPS_PROXY", "all_proxy"):
        monkeypatch.setenv(name, "http://127.0.0.1:1")
    assert receiver.caller().post(receiver.url, {}, b"{}") == 200


def test_the_next_address_is_tried_where_one_does_not_listen(receiver: Receiver) -> None:
    assert receiver.caller(resolve=lambda *_: ["127.0.0.2", "127.0.0.1"]).post(receiver.url, {}, b"{}") == 200


@pytest.mark.parametrize("address", ["127.0.0.1", "169.254.169.254", "100.64.0.1", "::ffff:127.0.0.1", "10.0.0.1"])
def test_no_name_leads_to_an_address_that_is_not_public(receiver: Receiver, address: str) -> None:
    """One public address beside it helps nothing."""
    caller = receiver.caller(allowed=is_public, resolve=lambda *_: ["8.8.8.8", address])
    with pytest.raises(NotPublic, match="not public"):
        caller.post(receiver.url, {}, b"{}")
    assert receiver.arrived == []


def test_the_address_that_was_checked_is_the_one_that_is_called(receiver: Receiver) -> None:
    """A name whose owner answers with another address each time is asked once."""
    answers = iter([["127.0.0.1"], ["127.0.0.9"]])
    asked: list[str] = []

    def allowed(address: str) -> bool:
        asked.append(address)
        return address == "127.0.0.1"

    caller = receiver.caller(allowed=allowed, resolve=lambda *_: next(answers))
    assert caller.post(receiver.url, {}, b"{}") == 200
    assert asked == ["127.0.0.1"]
    with pytest.raises(NotPublic):
        caller.post(receiver.url, {}, b"{}")
    assert len(receiver.arrived) == 1


@pytest.mark.parametrize("host", ["2130706433", "0x7f.1", "127.1", "localhost", "[::1]", "[::ffff:7f00:1]"])
def test_no_way_to_write_this_machine_is_public(host: str) -> None:
    caller = Caller()
    with pytest.raises((NotPublic, CallFailed)):
        caller.addresses(read_url(f"{HTTPS}{host}/"))


@pytest.mark.parametrize("host", ["nowhere.invalid", "a..b", "a" * 64 + ".example"])
def test_a_name_that_is_not_known(host: str) -> None:
    with pytest.raises(CallFailed, match="is not known"):
        Caller().addresses(read_url(f"{HTTPS}{host}/"))


def test_what_a_url_leads_to() -> None:
    place = read_url(f"{HTTPS}Hooks.example:8443/a/b?c=d")
    assert (place.host, place.port, place.target) == ("hooks.example", 8443, "/a/b?c=d")
    assert read_url(f"{HTTPS}hooks.example").target == "/"
    assert read_url(f"{HTTPS}[2606:4700::1]/").host == "2606:4700::1"


@pytest.mark.parametrize(
    "url",
    [
        *("", "https:", f"http:{'//'}hooks.example/", f"ftp:{'//'}hooks.example/", "//hooks.example/", "hooks.example"),
        *(f"{HTTPS}", f"{HTTPS}/x", f"{HTTPS}h.example:x/", f"{HTTPS}h.example:99999/", f"{HTTPS}h.example/a b"),
        *(f"{HTTPS}h.example/\r\nX: 1", f"{HTTPS}h.example/\t", f"{HTTPS}bäume.example/", f"{HTTPS}h.example\\@e/"),
        *(f"{HTTPS}ann@h.example/", f"{HTTPS}ann:pw@h.example/", f"{HTTPS}h.example/#here", f"{HTTPS}[::1"),
    ],
)
def test_what_is_no_url_of_a_webhook(url: str) -> None:
    with pytest.raises(ValueError, match="it must"):
        read_url(url)
