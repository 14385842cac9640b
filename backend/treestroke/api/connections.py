"""Connections: how many may be open, how long they may be silent, and which are closed to make room."""

import asyncio
import resource
from operator import attrgetter
from typing import Any

import h11
import structlog
from uvicorn.protocols.http.h11_impl import STATUS_PHRASES, H11Protocol

from treestroke.api.errors import problem
from treestroke.api.issuer import ISSUER_CONNECTIONS
from treestroke.api.request_ids import identify
from treestroke.api.shared_redis import CONNECTIONS as REDIS_CONNECTIONS

MAX_CONNECTIONS = 1000
MIN_CONNECTIONS = 8
ACCEPTED_AT_ONCE = 8
"""Connections that are accepted from the listening socket at once."""
HEAD_SECONDS = 10.0
"""Time in which a request's head must arrive."""
LINGER_SECONDS = 1.0
"""Time in which what a refused client still sends is read and ignored: a reset would lose the response."""
STALLED_SECONDS = 120.0
"""A connection is closed when its client is this far behind `MIN_READ_BYTES_PER_SECOND`."""
STREAM_SHARE = 0.5
"""A stream of events is closed in this share of that time: its reader misses nothing by following it anew."""
STREAMS = "/events"
"""How the paths of streams end."""
MIN_READ_BYTES_PER_SECOND = 20_000
BEHIND_SECONDS = 5.0
"""A connection whose client is this far behind is closed before others when room is needed."""
_CHECK_SHARE = 0.25
"""Time between two checks of a client's reading, as a share of the seconds that it may be behind."""
_PROCESS_FILES = 30 + 2 * ACCEPTED_AT_ONCE + REDIS_CONNECTIONS + ISSUER_CONNECTIONS
"""Descriptors of the process itself: log, event loop, listening socket, resource tracker, connections being closed."""
_DATABASE_FILES = 15 * 3
"""Descriptors of SQLAlchemy's pool at its largest: database, WAL and WAL index of each connection."""
_TRACER_FILES = 4
_CONNECTION_FILES = 2
"""Descriptors of a connection: its socket, and a file that is being sent or received."""
log = structlog.get_logger()


def max_connections(tracers: int) -> int:
    """Return how many connections may be open, after raising this process's limit of descriptors if that helps."""
    reserved = _PROCESS_FILES + _DATABASE_FILES + _TRACER_FILES * tracers
    wanted = reserved + _CONNECTION_FILES * MAX_CONNECTIONS
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        soft = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    limit = wanted if soft == resource.RLIM_INFINITY else soft
    return max(min((limit - reserved) // _CONNECTION_FILES, MAX_CONNECTIONS), MIN_CONNECTIONS)


class _CountedHTTP(h11.Connection):
    """HTTP protocol state that counts the bytes it has written."""

    bytes_written = 0

    def send_with_data_passthrough(self, event: h11.Event) -> list[bytes] | None:
        """Return an event's bytes, and count them."""
        parts = super().send_with_data_passthrough(event)
        self.bytes_written += sum(map(len, parts or ()))
        return parts


class Connection(H11Protocol):
    """A connection that is closed if a request's head does not arrive in time, or if the client stops reading.

    How far a client is behind in reading is counted in seconds: each second adds one, and what it reads takes some
    off again. At ``stalled_s``, or half of it for a stream of events, the connection is closed. So neither silence nor
    a few bytes now and then keep a connection open, in whatever state it is, including one that only waits for its last
    bytes to be sent.

    When more than ``limit`` are open, one is closed: of those that are ``behind_s`` behind in reading, or else of
    all, the one that has sent no complete request for the longest time.
    """

    def __init__(
        self,
        *,
        limit: int,
        head_s: float = HEAD_SECONDS,
        stalled_s: float = STALLED_SECONDS,
        min_rate: float = MIN_READ_BYTES_PER_SECOND,
        behind_s: float = BEHIND_SECONDS,
        **of_uvicorn: Any,
    ) -> None:
        super().__init__(**of_uvicorn)
        self.conn: _CountedHTTP = _CountedHTTP(h11.SERVER)
        self._limit, self._head_s = limit, head_s
        self._stalled_s, self._min_rate, self._behind_limit_s = stalled_s, min_rate, behind_s
        self._since = self.loop.time()
        self._head_timer: asyncio.TimerHandle | None = None
        self._read_timer: asyncio.TimerHandle | None = None
        self._close_timer: asyncio.TimerHandle | None = None
        """Runs once the client is refused."""
        self._bytes_read, self._behind_s = 0, 0.0

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Start to wait for a request, and make room if too many connections are open."""
        super().connection_made(transport)
        self._expect_head()
        self._check_reading_later()
        if len(self.connections) > self._limit:
            min(self.connections, key=attrgetter("priority")).make_room()  # type: ignore[union-attr]

    def connection_lost(self, exc: Exception | None) -> None:
        """Cancel all timers."""
        super().connection_lost(exc)
        for timer in (self._head_timer, self._read_timer, self._close_timer):
            if timer is not None:
                timer.cancel()

    def data_received(self, data: bytes) -> None:
        """Handle received bytes, unless the client was refused."""
        if self._close_timer is None:
            super().data_received(data)

    def handle_events(self) -> None:
        """Handle what the received bytes contain, then wait for the rest of a head."""
        super().handle_events()
        self._expect_head()

    def on_response_complete(self) -> None:
        """Wait for the next request, or for the rest of one that was answered before it was complete."""
        self._since = self.loop.time()
        super().on_response_complete()
        self._expect_head()

    def send_400_response(self, msg: str) -> None:  # noqa: ARG002 - uvicorn's text
        """Refuse bytes that are not HTTP."""
        self._refuse("bad_request", "this is not a valid HTTP request; send it again", LINGER_SECONDS)
        log.warning("request_invalid", peer=self.client and self.client[0])

    @property
    def responding(self) -> bool:
        """Whether a request is being handled, or its response is being sent."""
        if self.cycle is None or self._close_timer is not None:
            return False
        return not self.cycle.response_complete or self.transport.get_write_buffer_size() > 0

    @property
    def _streams(self) -> bool:
        return self.cycle is not None and self.cycle.scope["path"].endswith(STREAMS)

    @property
    def priority(self) -> tuple[bool, bool, bool, float]:
        """Sort key for closing connections: first clients that do not read, then those silent for the longest time."""
        reads = self._behind_s < self._behind_limit_s
        return reads, self.responding and not self.cycle.more_body, self.responding, self._since

    def make_room(self) -> None:
        """Close, so that another connection can be open."""
        self.connections.discard(self)
        if self._head_timer is not None:
            self._refuse("overloaded", "too many connections are open at the moment; try again")
        else:
            self.transport.abort()

    def _expect_head(self) -> None:
        """Start the timer for a request's head, or stop it while a response is sent or no new request has begun."""
        idle = self.cycle is not None and self.conn.their_state is h11.IDLE and not self.conn.trailing_data[0]
        if self.responding or idle:
            if self._head_timer is not None:
                self._head_timer.cancel()
            self._head_timer = None
        elif self._head_timer is None:
            self._head_timer = self.loop.call_later(self._head_s, self._head_late)

    def _check_reading_later(self) -> None:
        pause_s = self._behind_limit_s * _CHECK_SHARE
        self._read_timer = self.loop.call_later(pause_s, self._check_reading, pause_s)

    def _check_reading(self, elapsed_s: float) -> None:
        """Update how far the client is behind in reading, and close the connection if it is too far."""
        unread = self.transport.get_write_buffer_size()
        bytes_read = self.conn.bytes_written - unread
        caught_up_s = (bytes_read - self._bytes_read) / self._min_rate
        self._behind_s = max(self._behind_s + elapsed_s - caught_up_s, 0.0) if unread else 0.0
        self._bytes_read = bytes_read
        if self._behind_s >= self._stalled_s * (STREAM_SHARE if self._streams else 1.0):
            self.transport.abort()
        else:
            self._expect_head()
            self._check_reading_later()

    def _head_late(self) -> None:
        if self.conn.trailing_data[0]:
            self._refuse("request_too_slow", "the request's head arrives too slowly; send it again", LINGER_SECONDS)
        else:
            self.transport.close()

    def _refuse(self, code: str, detail: str, linger_s: float = 0.0) -> None:
        """Respond instead of the application, unless it has begun to respond, and close the connection."""
        identify()
        response = problem(code, detail)
        if self.conn.our_state not in (h11.IDLE, h11.SEND_RESPONSE):
            self.transport.close()
            return
        head = h11.Response(
            status_code=response.status_code,
            headers=[*response.raw_headers, (b"connection", b"close")],
            reason=STATUS_PHRASES[response.status_code],
        )
        for event in (head, h11.Data(data=bytes(response.body)), h11.EndOfMessage()):
            self.transport.write(self.conn.send(event) or b"")
        if self.cycle is not None:  # tells the application that its client has gone
            self.cycle.disconnected = True
            self.cycle.message_event.set()
        if linger_s:
            self.transport.write_eof()
            self.flow.resume_reading()
            self._close_timer = self.loop.call_later(linger_s, self.transport.close)
        else:
            self.transport.close()
