"""The connection of a client: requests that are repeated, pages, files, and streams of events that are resumed."""

import hashlib
import math
import os
import secrets
import time
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import closing, suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Generic, NamedTuple, Self, TypeVar
from urllib.parse import quote

import httpx

from treestroke.capture_schemas import CapturePage, CaptureState
from treestroke.clip_schemas import ClipInfo, ClipPage
from treestroke.request_bodies import plain_options
from treestroke.responses import Event, RetryableError, checked, events_of, read, unreachable
from treestroke.schemas import ModelInfo, ModelPage, PhotoInfo, PhotoPage

Done = TypeVar("Done")
Page = TypeVar("Page", ModelPage, PhotoPage, CapturePage, ClipPage)
State = TypeVar("State", ModelInfo, CaptureState)

_KEY = "TREESTROKE_KEY"
"""Variable of the key of those who give none."""
_PAUSES_S = (0.2, 0.4, 0.8, 1.6, 3.2)
"""Pauses between tries; a service that restarts is back within them."""
_SILENCE_S = 20.0
"""An event stream without even a ping for this long is broken."""
_POLL_S = 0.5


class Followed(NamedTuple, Generic[State]):
    """What is followed: what it is read as, where it is, and the statuses in which it is over."""

    kind: type[State]
    path: str
    ends: tuple[str, ...]


class Connection:
    """What calls of a service have in common; `client.Client` documents its parameters."""

    def __init__(self, address: str = "http://127.0.0.1:8000", timeout: float = 60.0, key: str | None = None) -> None:
        self._timeout = timeout
        key = key or os.environ.get(_KEY)
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        # Nothing of the machine's proxies and passwords comes between the key and the service.
        self._http = httpx.Client(base_url=address, timeout=timeout, headers=headers, trust_env=False)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Close the connection."""
        self._http.close()

    def _ask(self, method: str, path: str, **request: Any) -> httpx.Response:
        # A deletion that was cut off may have happened; sent again it would fail.
        return self._repeat(lambda: checked(self._http.request(method, path, **request)), harmless=method != "DELETE")

    def _ask_for_tree(
        self, inputs: Mapping[str, Any], settings: Mapping[str, Any] | None, seed: int, options: Mapping[str, Any]
    ) -> ModelInfo:
        headers = {"Idempotency-Key": options.get("idempotency_key") or secrets.token_hex(16)}
        body = {**inputs, **plain_options(options), "settings": dict(settings or {}), "seed": seed}
        return read(ModelInfo, self._ask("POST", "/v1/models", json=body, headers=headers).content)

    def _pages(self, kind: type[Page], path: str) -> Iterator[Page]:
        cursor: dict[str, str] = {}
        while True:
            page = read(kind, self._ask("GET", path, params=cursor).content)
            yield page
            if page.next is None:
                return
            cursor = {"cursor": page.next}

    def _follow(
        self,
        followed: Followed[State],
        timeout: float | None,
        on_progress: Callable[[State], None] | None,
        on_other: Callable[[Event], None] | None = None,
    ) -> State:
        """Follow something until it is over, and return its last state; events that hold no state go to ``on_other``.

        A stream of events that breaks is resumed; where none arrives, the state is polled.

        Raises
        ------
        TimeoutError
            It took longer than ``timeout`` seconds.
        ServiceError
            It is not there, or the service cannot be reached.
        """
        deadline = math.inf if timeout is None else time.monotonic() + timeout
        last, shown = "", None
        while True:
            with closing(self._events(followed.path, last, min(_left(deadline), _SILENCE_S))) as events:
                for event in events:
                    last = event.id or last
                    if event.kind not in ("snapshot", "progress", *followed.ends):
                        if on_other is not None:
                            on_other(event)
                    else:
                        shown = _tell(read(followed.kind, event.text), shown, on_progress)
                    if shown is not None and event.kind in followed.ends:
                        return shown
                    _left(deadline)
            shown = _tell(read(followed.kind, self._ask("GET", followed.path).content), shown, on_progress)
            if shown.status in followed.ends:
                return shown
            time.sleep(min(_POLL_S, _left(deadline)))

    def _download(self, path: str, place: Path) -> None:
        """Download a file, whole or not at all, checked against its SHA-256."""
        temporary = place.with_name(f".treestroke-{secrets.token_hex(8)}")
        try:
            self._repeat(lambda: self._fetch(path, temporary))
            temporary.replace(place)
        finally:
            temporary.unlink(missing_ok=True)

    def _repeat(self, attempt: Callable[[], Done], harmless: bool = True) -> Done:
        """Make an attempt; repeat it after a pause if the service was busy or a ``harmless`` attempt was cut off."""
        for pause in (*_PAUSES_S, None):
            try:
                return attempt()
            except RetryableError as error:
                if pause is None:
                    raise
                pause = max(pause, error.pause_s)
            except httpx.TransportError as error:
                cut_off = harmless and isinstance(error, httpx.NetworkError | httpx.RemoteProtocolError)
                if pause is None or not (cut_off or isinstance(error, httpx.ConnectError)):
                    raise unreachable(self._http.base_url, error) from error
            time.sleep(pause)
        raise AssertionError("the last attempt returns or raises")

    def _fetch(self, path: str, place: Path) -> None:
        digest = hashlib.sha256()
        with self._http.stream("GET", path) as response, place.open("wb") as file:
            if not response.is_success:
                response.read()
            for chunk in checked(response).iter_bytes():
                digest.update(chunk)
                file.write(chunk)
            file.flush()
            os.fsync(file.fileno())
        if response.headers.get("ETag") != f'"{digest.hexdigest()}"':
            raise RetryableError(response.status_code, "damaged", "the file arrived damaged; download it again")

    def _events(self, path: str, last: str, seconds: float) -> Generator[Event]:
        """Yield the events of what is followed until they end, however that is; silence for ``seconds`` ends them."""
        headers = {"Last-Event-ID": last} if last else {}
        timeout = httpx.Timeout(self._timeout, read=seconds)
        with (
            suppress(httpx.TransportError),
            self._http.stream("GET", f"{path}/events", headers=headers, timeout=timeout) as answer,
        ):
            if answer.is_success:
                yield from events_of(answer.iter_bytes())


def id_of(info: PhotoInfo | ModelInfo | CaptureState | ClipInfo | str) -> str:
    """Return an id as it stands in a path."""
    return quote(info if isinstance(info, str) else info.id, safe="")


def _left(deadline: float) -> float:
    """Return the seconds until a deadline.

    Raises
    ------
    TimeoutError
        It has passed.
    """
    left = deadline - time.monotonic()
    if left <= 0:
        raise TimeoutError("it is not finished yet; wait for it again, or cancel it")
    return left


def _tell(state: State, shown: State | None, on_progress: Callable[[State], None] | None) -> State:
    if on_progress is not None and state != shown:
        on_progress(state)
    return state
