"""Connections: how many may be open, how long they may be silent, and which make room for others."""

import asyncio
import resource
from operator import attrgetter
from typing import Any

import h11
import structlog
from fastapi.responses import JSONResponse
from uvicorn.protocols.http.h11_impl import STATUS_PHRASES, H11Protocol

from treestroke.api.errors import problem

MOST = 1000
FEWEST = 8
ACCEPTED = 8
"""Connections that are taken from the listening socket at once."""
HEAD_SECONDS = 10.0
LINGER_SECONDS = 1.0
"""For so long what a refused client still sends is thrown away: a reset in the middle of it would hide the answer."""
STALLED_SECONDS = 120.0
"""A client that reads nothing of its answer, or is behind the slowest rate, for so long has gone, or means harm."""
SLOWEST_READ_BYTES_PER_SECOND = 20_000
BEHIND_SECONDS = 5.0
"""A client that is so far behind the slowest rate makes room before all others."""
_LOOKS = 0.25
"""How often it is looked whether a client reads, as a part of the seconds that it may be behind."""
_OWN_FILES = 30 + 2 * ACCEPTED
"""Descriptors of the process itself: log, loop, listening socket, tracers' tracker, and what is about to be closed."""
_DATABASE_FILES = 15 * 3
"""Of SQLAlchemy's pool at its largest: database, WAL and its index."""
_TRACER_FILES = 4
_CONNECTION_FILES = 2
"""Its socket, and a file that is being sent or received."""
log = structlog.get_logger()


def max_connections(tracers: int) -> int:
    """Say how many connections may be open, and raise this process's limit of descriptors as far as that is of use."""
    own = _OWN_FILES + _DATABASE_FILES + _TRACER_FILES * tracers
    wanted = own + _CONNECTION_FILES * MOST
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        soft = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    free = wanted if soft == resource.RLIM_INFINITY else soft
    return max(min((free - own) // _CONNECTION_FILES, MOST), FEWEST)


class _CountedHTTP(h11.Connection):
    """HTTP that knows how many bytes it has given to be sent."""

    said = 0

    def send_with_data_passthrough(self, event: h11.Event) -> list[bytes] | None:
        """Write an event, and count its bytes."""
        parts = super().send_with_data_passthrough(event)
        self.said += sum(map(len, parts or ()))
        return parts


class Connection(H11Protocol):
    """A connection that ends where a request's head does not come in time, or where nobody reads the answer.

    What the client may be behind in reading is counted in seconds: each passes, and what it reads gives some back, but
    never more than ``stalled_s`` altogether. So neither silence nor a few bytes now and then hold a connection, in
    whatever state it is, also where it only waits for its last bytes to go.

    Where ``most`` are open already, one makes room: of those that are ``behind_s`` behind in reading, or else of all,
    the one that has sent no whole request for the longest time.
    """

    def __init__(
        self,
        *,
        most: int,
        head_s: float = HEAD_SECONDS,
        stalled_s: float = STALLED_SECONDS,
        slowest: float = SLOWEST_READ_BYTES_PER_SECOND,
        behind_s: float = BEHIND_SECONDS,
        **given: Any,
    ) -> None:
        super().__init__(**given)
        self.conn: _CountedHTTP = _CountedHTTP(h11.SERVER)
        self._most, self._head_s = most, head_s
        self._stalled_s, self._slowest, self._behind_s = stalled_s, slowest, behind_s
        self._since = self.loop.time()
        self._due: asyncio.TimerHandle | None = None
        self._look: asyncio.TimerHandle | None = None
        self._taken, self._behind = 0, 0.0
        self._refused: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to wait for a request."""
        super().connection_made(transport)
        self._expect_head()
        self._look_later()
        if len(self.connections) > self._most:
            min(self.connections, key=attrgetter("worth")).make_room()  # type: ignore[union-attr]

    def connection_lost(self, exc: Exception | None) -> None:
        """End what waits."""
        super().connection_lost(exc)
        for timer in (self._due, self._look, self._refused):
            if timer is not None:
                timer.cancel()

    def data_received(self, data: bytes) -> None:
        """Take what came, unless the client was refused."""
        if self._refused is None:
            super().data_received(data)

    def handle_events(self) -> None:
        """Take what came, and see whether it is a whole head."""
        super().handle_events()
        self._expect_head()

    def on_response_complete(self) -> None:
        """Wait for the next request, or for the rest of one that was answered before it was whole."""
        self._since = self.loop.time()
        super().on_response_complete()
        self._expect_head()

    def send_400_response(self, msg: str) -> None:  # noqa: ARG002 - uvicorn's words
        """Refuse what is no HTTP."""
        log.warning("request_invalid", peer=self.client and self.client[0])
        self._refuse(problem("bad_request", "this is no valid HTTP request; send it anew"), LINGER_SECONDS)

    @property
    def answering(self) -> bool:
        """Whether a request is under way, or its answer on its way."""
        if self.cycle is None or self._refused is not None:
            return False
        return not self.cycle.response_complete or self.transport.get_write_buffer_size() > 0

    @property
    def worth(self) -> tuple[bool, bool, bool, float]:
        """What it would cost to close this one: least where nobody reads, then for what is silent for longest."""
        reads = self._behind < self._behind_s
        return reads, self.answering and not self.cycle.more_body, self.answering, self._since

    def make_room(self) -> None:
        """Close, so that another connection can be open."""
        self.connections.discard(self)
        if self._due is not None:
            busy = "too many connections are open at the moment; try again"
            self._refuse(problem("overloaded", busy))
        else:
            self.transport.abort()

    def _expect_head(self) -> None:
        """Let the head of a request be due, unless one is being answered or nothing has come of the next one."""
        resting = self.cycle is not None and self.conn.their_state is h11.IDLE and not self.conn.trailing_data[0]
        if self.answering or resting:
            if self._due is not None:
                self._due.cancel()
            self._due = None
        elif self._due is None:
            self._due = self.loop.call_later(self._head_s, self._give_up)

    def _look_later(self) -> None:
        self._look = self.loop.call_later(self._behind_s * _LOOKS, self._look_after_reader)

    def _look_after_reader(self) -> None:
        """Count how far behind the client is in reading, and end a connection where it is too far."""
        unread = self.transport.get_write_buffer_size()
        taken = self.conn.said - unread
        caught_up = (taken - self._taken) / self._slowest
        self._behind = max(self._behind + self._behind_s * _LOOKS - caught_up, 0.0) if unread else 0.0
        self._taken = taken
        if self._behind >= self._stalled_s:
            self.transport.abort()
        else:
            self._expect_head()
            self._look_later()

    def _give_up(self) -> None:
        if self.conn.trailing_data[0]:
            slow = "the request's head comes too slowly; send it again"
            self._refuse(problem("request_too_slow", slow), LINGER_SECONDS)
        else:
            self.transport.close()

    def _refuse(self, answer: JSONResponse, linger_s: float = 0.0) -> None:
        """Answer instead of the application, where no other answer has begun, and close."""
        if self.conn.our_state not in (h11.IDLE, h11.SEND_RESPONSE):
            self.transport.close()
            return
        head = h11.Response(
            status_code=answer.status_code,
            headers=[*answer.raw_headers, (b"connection", b"close")],
            reason=STATUS_PHRASES[answer.status_code],
        )
        for event in (head, h11.Data(data=bytes(answer.body)), h11.EndOfMessage()):
            self.transport.write(self.conn.send(event) or b"")
        if self.cycle is not None:  # the application has nobody to answer any more
            self.cycle.disconnected = True
            self.cycle.message_event.set()
        if linger_s:
            self.transport.write_eof()
            self.flow.resume_reading()
            self._refused = self.loop.call_later(linger_s, self.transport.close)
        else:
            self.transport.close()
