"""Responses of a service as its client reads them: problems, values and streams of events."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeVar

import httpx
from pydantic import BaseModel, ValidationError

from treestroke.schemas import Fault, Problem

Answer = TypeVar("Answer", bound=BaseModel)
_LONGEST_PAUSE_S = 10.0


class ServiceError(Exception):
    """The service refused a request, or did not respond.

    Attributes
    ----------
    status
        HTTP status; 0 where no response came.
    code, detail
        What is wrong, for programs (``unreachable`` where no response came) and for people.
    errors
        The fields that are at fault.
    """

    def __init__(self, status: int, code: str, detail: str, errors: tuple[Fault, ...] = ()) -> None:
        super().__init__(f"{detail} ({code})")
        self.status, self.code, self.detail, self.errors = status, code, detail, errors


class RetryableError(ServiceError):
    """A failure that may pass: the request can be sent again."""

    def __init__(
        self, status: int, code: str, detail: str, errors: tuple[Fault, ...] = (), pause_s: float = 0.0
    ) -> None:
        super().__init__(status, code, detail, errors)
        self.pause_s = pause_s


@dataclass(frozen=True)
class Event:
    """One event of a stream; most have no id."""

    kind: str
    id: str
    text: str


def checked(response: httpx.Response) -> httpx.Response:
    """Return the response; raise on failure.

    Raises
    ------
    RetryableError
        The service is busy (503).
    ServiceError
        It refused the request for another reason.
    """
    if response.is_success:
        return response
    try:
        problem = Problem.model_validate_json(response.content, extra="ignore")
    except ValidationError:
        raise ServiceError(response.status_code, "unknown_answer", response.reason_phrase) from None
    status, errors = response.status_code, tuple(problem.errors)
    if status != 503:
        raise ServiceError(status, problem.code, problem.detail, errors)
    header = response.headers.get("Retry-After", "")
    pause_s = min(float(header), _LONGEST_PAUSE_S) if header.isdecimal() else 0.0
    raise RetryableError(status, problem.code, problem.detail, errors, pause_s)


def read(kind: type[Answer], content: bytes | str) -> Answer:
    """Return a response's JSON as a model; keys that a newer service added are left out.

    Raises
    ------
    ServiceError
        The response is not as the model describes it.
    """
    try:
        return kind.model_validate_json(content, extra="ignore")
    except ValidationError as error:
        raise ServiceError(
            200, "unknown_answer", f"the response is not a {kind.__name__}; is the address that of treestroke?"
        ) from error


def unreachable(address: object, error: httpx.TransportError) -> ServiceError:
    """Return the error for a request that got no response."""
    why = str(error) or type(error).__name__
    return ServiceError(0, "unreachable", f"{address} does not answer ({why}); start it by `treestroke serve`")


def events_of(chunks: Iterator[bytes]) -> Iterator[Event]:
    """Yield the events of a text/event-stream; comments, which are pings, are skipped."""
    fields: dict[str, str] = {}
    for line in _lines(chunks):
        name, _, value = line.partition(":")
        if name:
            fields[name] = value.removeprefix(" ")
        elif not line:
            if "data" in fields:
                yield Event(fields.get("event", ""), fields.get("id", ""), fields["data"])
            fields = {}


def _lines(chunks: Iterator[bytes]) -> Iterator[str]:
    rest = b""
    for chunk in chunks:
        *whole, rest = (rest + chunk).split(b"\n")
        for line in whole:
            yield line.removesuffix(b"\r").decode()
