"""One attempt to send a message to a webhook: over TLS, to an address that was checked, in a bounded time.

A name is resolved once. All of its addresses are checked, and one of them is connected to, so that no later answer of
the name's owner leads elsewhere. Redirects are not followed, proxies not used; of the answer only the head is read.
"""

import io
import re
import socket
import ssl
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from http.client import HTTPException, HTTPResponse, HTTPSConnection
from typing import Any, cast
from urllib.parse import urlsplit

from treestroke.service.public_addresses import is_public

SECONDS = 15.0
MOST_BYTES = 65_536
_TRIED = 3
"""Addresses of a name that are tried one after another."""
_URL = re.compile(r"https://[!#-;=?-\[\]_a-z~]+", re.IGNORECASE)
Resolve = Callable[[str, int], Sequence[str]]
"""Returns the addresses of a host's name; an OSError or UnicodeError where it has none."""


class NotPublic(Exception):
    """An address of the host is not one that is called."""


class CallFailed(Exception):
    """There was no answer; the message says why, in a few words."""


@dataclass(frozen=True)
class Place:
    """Where a URL leads."""

    host: str
    port: int
    target: str
    """Path and query."""


def read_url(url: str) -> Place:
    """Return where a webhook's URL leads.

    Raises
    ------
    ValueError
        It is no such URL; the message says what it has to be.
    """
    wrong = ValueError("it must be https://HOST/PATH, in ASCII; correct it")
    try:
        parts = urlsplit(url)
        port = parts.port or 443
    except ValueError:
        raise wrong from None
    if not _URL.fullmatch(url) or not parts.hostname:
        raise wrong
    if parts.username is not None or parts.password is not None:
        raise ValueError("it must not hold a user or a password; leave them out, messages are signed")
    if parts.fragment:
        raise ValueError("it must not hold a fragment (#...); leave it out")
    return Place(parts.hostname, port, (parts.path or "/") + (f"?{parts.query}" if parts.query else ""))


def resolved(host: str, port: int) -> Sequence[str]:
    """Return the addresses of a host's name, in the order of the system's preference.

    Raises
    ------
    OSError, UnicodeError
        The name is not known.
    """
    found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    return list(dict.fromkeys(str(address[0]) for *_, address in found))


class Caller:
    """Sends messages. Only ``allowed`` addresses are called: public ones, in service."""

    def __init__(
        self,
        allowed: Callable[[str], bool] = is_public,
        resolve: Resolve = resolved,
        trust: ssl.SSLContext | None = None,
        seconds: float = SECONDS,
    ) -> None:
        self._allowed, self._resolve, self._seconds = allowed, resolve, seconds
        self._given = trust

    @cached_property
    def _trust(self) -> ssl.SSLContext:
        """What tells who a receiver is; by default the certificates that are usually trusted, not the environment's."""
        from httpx import create_ssl_context

        return self._given or create_ssl_context(trust_env=False)

    def addresses(self, place: Place) -> Sequence[str]:
        """Return the addresses of a host, all of which may be called.

        Raises
        ------
        NotPublic
            One of them may not.
        CallFailed
            The name is not known.
        """
        try:
            found = self._resolve(place.host, place.port)
        except (OSError, UnicodeError):
            raise CallFailed(f"the name {place.host} is not known") from None
        if refused := [address for address in found if not self._allowed(address)]:
            raise NotPublic(f"the host has the address {refused[0]}, which is not public")
        return found

    def post(self, url: str, headers: Mapping[str, str], body: bytes) -> int:
        """Send a message and return the HTTP status of the answer.

        Raises
        ------
        NotPublic
            As `addresses`.
        CallFailed
            There was no answer in time.
        """
        deadline, place = time.monotonic() + self._seconds, read_url(url)
        addresses = self.addresses(place)
        try:
            with self._connected(place, addresses, deadline) as connection:
                return self._ask(place, connection, deadline, headers, body)
        except TimeoutError:
            raise CallFailed(f"no answer within {self._seconds:g} s") from None
        except ssl.SSLCertVerificationError as error:
            raise CallFailed(f"its certificate is not valid: {error.verify_message}") from None
        except (OSError, HTTPException, ValueError) as error:
            raise CallFailed(f"no answer: {error or type(error).__name__}") from None

    def _connected(self, place: Place, addresses: Sequence[str], deadline: float) -> ssl.SSLSocket:
        """Connect to the first of some addresses that listens, and check by the name who it is."""
        failed: OSError = OSError("the name has no address")
        for address in addresses[:_TRIED]:
            try:
                plain = socket.create_connection((address, place.port), timeout=_left(deadline))
            except OSError as error:
                failed = error
                continue
            with plain:  # which TLS takes over
                plain.settimeout(_left(deadline))
                return self._trust.wrap_socket(plain, server_hostname=place.host)
        raise failed

    def _ask(
        self, place: Place, connection: ssl.SSLSocket, deadline: float, headers: Mapping[str, str], body: bytes
    ) -> int:
        client = HTTPSConnection(place.host, place.port, context=self._trust)
        client.sock = connection
        connection.settimeout(_left(deadline))
        client.request("POST", place.target, body, {**headers, "Connection": "close"})
        answer = HTTPResponse(cast("Any", _Answer(connection, deadline)), method="POST")
        answer.begin()
        return answer.status


class _Answer(io.RawIOBase):
    """What a receiver answers, within a time and a number of bytes; `HTTPResponse` takes it for a socket."""

    def __init__(self, connection: ssl.SSLSocket, deadline: float) -> None:
        self._connection, self._deadline, self._room = connection, deadline, MOST_BYTES

    def makefile(self, _: str) -> io.BufferedReader:
        """Return a file that is read from."""
        return io.BufferedReader(self)

    def readable(self) -> bool:
        """Tell that it is read from."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Read what has arrived.

        Raises
        ------
        TimeoutError
            Nothing arrived in time.
        HTTPException
            The answer's head is too long.
        """
        room = memoryview(buffer)[: self._room]
        if not room:
            raise HTTPException(f"its head is longer than {MOST_BYTES // 1024} kB")
        self._connection.settimeout(_left(self._deadline))
        read = self._connection.recv_into(room)
        self._room -= read
        return read


def _left(deadline: float) -> float:
    """Return the seconds that are left.

    Raises
    ------
    TimeoutError
        There are none.
    """
    left = deadline - time.monotonic()
    if left <= 0:
        raise TimeoutError
    return left
