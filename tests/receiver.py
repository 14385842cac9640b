"""A receiver of webhooks: an HTTPS server on 127.0.0.1 with a certificate of the tests' own authority."""

import ssl
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import trustme

from treestroke.service.webhook_calls import Caller

NAME = "hooks.example"
Behave = Callable[[BaseHTTPRequestHandler], None]


@dataclass(frozen=True)
class Message:
    """A request that arrived."""

    path: str
    headers: dict[str, str]
    body: str

    @property
    def id(self) -> str:
        return self.headers["webhook-id"]


@dataclass
class Receiver:
    """A receiver: where it is, what arrived, and how it behaves, which a test may change."""

    port: int
    authority: trustme.CA
    behave: Behave
    arrived: list[Message] = field(default_factory=list)

    @property
    def url(self) -> str:
        return f"https:{'//'}{NAME}:{self.port}/hook?of=trees"

    @property
    def trust(self) -> ssl.SSLContext:
        """What trusts the receiver's certificate, among the usual ones."""
        trust = ssl.create_default_context()
        self.authority.configure_trust(trust)
        return trust

    def caller(self, **changed: object) -> Caller:
        """Give a caller that may call this machine, and finds the receiver by its name."""
        usual = {"allowed": lambda _: True, "resolve": lambda *_: ["127.0.0.1"], "trust": self.trust, "seconds": 60.0}
        return Caller(**{**usual, **changed})  # type: ignore[arg-type]


def answering(*statuses: int) -> Behave:
    """Answer by one status after another, and by the last one for ever."""
    left = list(statuses)

    def behave(request: BaseHTTPRequestHandler) -> None:
        request.send_response(left.pop(0) if len(left) > 1 else left[0])
        request.send_header("Location", f"https:{'//'}127.0.0.1:1/elsewhere")
        request.send_header("Content-Length", "0")
        request.end_headers()

    return behave


@contextmanager
def receiving(name: str = NAME) -> Iterator[Receiver]:
    """Run a receiver whose certificate is for a name."""
    authority, own = trustme.CA(), ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    authority.issue_cert(name).configure_cert(own)

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"])).decode()
            receiver.arrived.append(Message(self.path, {k.lower(): v for k, v in self.headers.items()}, body))
            receiver.behave(self)

        def log_message(self, *_: object) -> None:
            pass

    class Server(ThreadingHTTPServer):
        def handle_error(self, *_: object) -> None:
            """A sender that gave up is none of the receiver's errors."""

    server = Server(("127.0.0.1", 0), Handler)
    server.socket = own.wrap_socket(server.socket, server_side=True, do_handshake_on_connect=False)
    receiver = Receiver(server.server_address[1], authority, answering(200))
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True)
    thread.start()
    try:
        yield receiver
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
