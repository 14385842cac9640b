"""A client of the service: photos up, traces and trees down. It needs none of the modelling packages."""

import base64
import hashlib
import json
import math
import os
import secrets
import time
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import closing, suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar
from urllib.parse import quote

import httpx
from pydantic import BaseModel, ValidationError

from treestroke.schemas import Fault, GrownSkeleton, Model, ModelPage, Photo, Problem, Strokes, TraceAnswer

StrokesLike = Strokes | Mapping[str, Any] | str | os.PathLike[str]
"""Strokes, the same as a plain mapping, or the path of their JSON file."""
Answer = TypeVar("Answer", bound=BaseModel)
Done = TypeVar("Done")

_PAUSES_S = (0.2, 0.4, 0.8, 1.6, 3.2)
"""Between tries; a service that restarts is back within them."""
_LONGEST_PAUSE_S = 10.0
_SILENCE_S = 20.0
"""An event stream that does not even ping for so long is broken."""
_POLL_S = 0.5
_ENDS = ("succeeded", "failed", "canceled")


class ServiceError(Exception):
    """The service refuses a request, or does not answer.

    Attributes
    ----------
    status
        HTTP status; 0 where no answer came.
    code, detail
        What is wrong, for programs (``unreachable`` where no answer came) and for people.
    errors
        The fields that are at fault.
    """

    def __init__(self, status: int, code: str, detail: str, errors: tuple[Fault, ...] = ()) -> None:
        super().__init__(f"{detail} ({code})")
        self.status, self.code, self.detail, self.errors = status, code, detail, errors


class _Again(ServiceError):
    """What may come right by itself."""

    def __init__(
        self, status: int, code: str, detail: str, errors: tuple[Fault, ...] = (), pause_s: float = 0.0
    ) -> None:
        super().__init__(status, code, detail, errors)
        self.pause_s = pause_s


@dataclass(frozen=True)
class _Event:
    """One event of a stream; most have no id."""

    kind: str
    id: str
    text: str


class Client:
    """A connection to one service; threads may share it.

    A request that the service is too busy for, or that a broken connection cut off, is sent again, as long as that can
    do no harm, for some seconds.

    Parameters
    ----------
    address
        Where `treestroke serve` listens.
    timeout
        Seconds that the service may take for one answer.
    """

    def __init__(self, address: str = "http://127.0.0.1:8000", timeout: float = 60.0) -> None:
        # The service answers on its own machine only: no proxy leads there.
        self._timeout = timeout
        self._http = httpx.Client(base_url=address, timeout=timeout, trust_env=False)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Close the connection."""
        self._http.close()

    def upload(self, photo: str | os.PathLike[str] | bytes) -> Photo:
        """Upload a photo: a path, or encoded bytes (JPEG, PNG or WebP).

        Raises
        ------
        ServiceError
            It cannot be used.
        OSError
            The file cannot be read.
        """
        content = _content(photo)
        headers = {"Content-Type": "application/octet-stream"}
        return _read(Photo, self._ask("POST", "/v1/photos", content=content, headers=headers).content)

    def photo(self, photo: Photo | str) -> Photo:
        """Look a photo up."""
        return _read(Photo, self._ask("GET", f"/v1/photos/{_id(photo)}").content)

    def delete_photo(self, photo: Photo | str) -> None:
        """Delete a photo; models that were made of it keep their own copy."""
        self._ask("DELETE", f"/v1/photos/{_id(photo)}")

    def trace(
        self, photo: Photo | str, strokes: StrokesLike, rev: int | None = None, grow: bool = False
    ) -> TraceAnswer:
        """Find foliage and visible branches; with ``grow`` the whole tree's skeleton too. ``rev`` comes back.

        Raises
        ------
        ServiceError
            There is no such photo, or a stroke cannot be used.
        """
        body = {**_plain(strokes), "grow": grow} | ({} if rev is None else {"rev": rev})
        return _read(TraceAnswer, self._ask("POST", f"/v1/photos/{_id(photo)}/trace", json=body).content)

    def grow(
        self,
        photo: Photo | str,
        strokes: StrokesLike,
        settings: Mapping[str, Any] | None = None,
        seed: int = 0,
        name: str = "",
        idempotency_key: str | None = None,
        leaf: str | os.PathLike[str] | bytes | None = None,
    ) -> Model:
        """Ask for a tree; `wait` for it. The request may be cut off and sent again: it makes one model.

        Parameters
        ----------
        leaf
            A path or the bytes of a PNG of a leaf cut out, that the tree is to bear.
        idempotency_key
            The same key with the same request gives the same model, for a day, from another process too; a new key by
            default.

        Raises
        ------
        ServiceError
            There is no such photo, or a stroke or a setting cannot be used.
        """
        body = {
            "photo": _id(photo),
            "strokes": _plain(strokes),
            "settings": dict(settings or {}),
            "seed": seed,
            "name": name,
        }
        if leaf is not None:
            body["leaf"] = base64.b64encode(_content(leaf)).decode()
        headers = {"Idempotency-Key": idempotency_key or secrets.token_hex(16)}
        return _read(Model, self._ask("POST", "/v1/models", json=body, headers=headers).content)

    def model(self, model: Model | str) -> Model:
        """Look a model up."""
        return _read(Model, self._ask("GET", f"/v1/models/{_id(model)}").content)

    def models(self) -> Iterator[Model]:
        """Give all models, newest first, page by page as they are taken."""
        cursor: dict[str, str] = {}
        while True:
            page = _read(ModelPage, self._ask("GET", "/v1/models", params=cursor).content)
            yield from page.models
            if page.next is None:
                return
            cursor = {"cursor": page.next}

    def wait(
        self,
        model: Model | str,
        timeout: float | None = None,
        on_progress: Callable[[Model], None] | None = None,
        on_preview: Callable[[GrownSkeleton], None] | None = None,
    ) -> Model:
        """Follow a model until it has succeeded, failed or been canceled, and give it.

        A stream of events that breaks is taken up again where it broke; where none comes through, the model is looked
        up now and then.

        Parameters
        ----------
        timeout
            Seconds; without end by default.
        on_progress
            Is called with the model, at once and whenever it has got on.
        on_preview
            Is called with the grown skeleton when growth ends, unless the stream of events does not come through.

        Raises
        ------
        TimeoutError
            It took longer than ``timeout``; the model goes on.
        ServiceError
            There is no such model, or the service stays away.
        """
        deadline = math.inf if timeout is None else time.monotonic() + timeout
        last, shown = "", None
        while True:
            with closing(self._events(_id(model), last, min(_left(deadline), _SILENCE_S))) as events:
                for event in events:
                    last = event.id or last
                    if event.kind != "preview":
                        shown = _tell(_read(Model, event.text), shown, on_progress)
                    elif on_preview is not None:
                        on_preview(_read(GrownSkeleton, event.text))
                    if shown is not None and event.kind in _ENDS:
                        return shown
                    _left(deadline)
            shown = _tell(self.model(model), shown, on_progress)
            if shown.status in _ENDS:
                return shown
            time.sleep(min(_POLL_S, _left(deadline)))

    def download(self, model: Model | str, path: str | os.PathLike[str], file: str = "tree.glb") -> Path:
        """Download one of a model's files, whole or not at all, checked against its SHA-256; give its path.

        Raises
        ------
        ServiceError
            There is no such model or file, or it did not arrive undamaged.
        OSError
            It cannot be written.
        """
        place = Path(path)
        beside = place.with_name(f".treestroke-{secrets.token_hex(8)}")
        try:
            self._repeat(lambda: self._fetch(f"/v1/models/{_id(model)}/{quote(file, safe='')}", beside))
            beside.replace(place)
        finally:
            beside.unlink(missing_ok=True)
        return place

    def rename(self, model: Model | str, name: str) -> Model:
        """Name a model."""
        return _read(Model, self._ask("PATCH", f"/v1/models/{_id(model)}", json={"name": name}).content)

    def cancel(self, model: Model | str) -> Model:
        """Stop a model that is not finished; a finished one stays as it is."""
        return _read(Model, self._ask("POST", f"/v1/models/{_id(model)}/cancel").content)

    def delete(self, model: Model | str) -> None:
        """Delete a model; for 24 hours `restore` takes it back."""
        self._ask("DELETE", f"/v1/models/{_id(model)}")

    def restore(self, model: Model | str) -> Model:
        """Take a model's deletion back."""
        return _read(Model, self._ask("POST", f"/v1/models/{_id(model)}/restore").content)

    def _ask(self, method: str, path: str, **request: Any) -> httpx.Response:
        # A deletion that was cut off may have happened; sent again it would find nothing.
        return self._repeat(lambda: _checked(self._http.request(method, path, **request)), harmless=method != "DELETE")

    def _repeat(self, attempt: Callable[[], Done], harmless: bool = True) -> Done:
        """Make an attempt, and again after a pause where the service is busy or a ``harmless`` one was cut off."""
        for pause in (*_PAUSES_S, None):
            try:
                return attempt()
            except _Again as again:
                if pause is None:
                    raise
                pause = max(pause, again.pause_s)
            except httpx.TransportError as error:
                cut_off = harmless and isinstance(error, httpx.NetworkError | httpx.RemoteProtocolError)
                if pause is None or not (cut_off or isinstance(error, httpx.ConnectError)):
                    raise _unreachable(self._http.base_url, error) from error
            time.sleep(pause)
        raise AssertionError("the last attempt returns or raises")

    def _fetch(self, path: str, place: Path) -> None:
        digest = hashlib.sha256()
        with self._http.stream("GET", path) as response, place.open("wb") as file:
            if not response.is_success:
                response.read()
            for chunk in _checked(response).iter_bytes():
                digest.update(chunk)
                file.write(chunk)
            file.flush()
            os.fsync(file.fileno())
        if response.headers.get("ETag") != f'"{digest.hexdigest()}"':
            raise _Again(response.status_code, "damaged", "the file arrived damaged; download it again")

    def _events(self, id: str, last: str, seconds: float) -> Generator[_Event]:
        """Give a model's events until the stream ends, however it ends; silence for ``seconds`` ends it too."""
        headers = {"Last-Event-ID": last} if last else {}
        timeout = httpx.Timeout(self._timeout, read=seconds)
        path = f"/v1/models/{id}/events"
        with suppress(httpx.TransportError), self._http.stream("GET", path, headers=headers, timeout=timeout) as answer:
            if answer.is_success:
                yield from _events_of(answer.iter_bytes())


def _events_of(chunks: Iterator[bytes]) -> Iterator[_Event]:
    """Read the text/event-stream format, of which a comment is a ping."""
    fields: dict[str, str] = {}
    for line in _lines(chunks):
        name, _, value = line.partition(":")
        if name:
            fields[name] = value.removeprefix(" ")
        elif not line:
            if "data" in fields:
                yield _Event(fields.get("event", ""), fields.get("id", ""), fields["data"])
            fields = {}


def _lines(chunks: Iterator[bytes]) -> Iterator[str]:
    rest = b""
    for chunk in chunks:
        *whole, rest = (rest + chunk).split(b"\n")
        for line in whole:
            yield line.removesuffix(b"\r").decode()


def _checked(response: httpx.Response) -> httpx.Response:
    """Give an answer that is none of an error."""
    if response.is_success:
        return response
    try:
        problem = Problem.model_validate_json(response.content, extra="ignore")
    except ValidationError:
        raise ServiceError(response.status_code, "unknown_answer", response.reason_phrase) from None
    said = (response.status_code, problem.code, problem.detail, tuple(problem.errors))
    if response.status_code != 503:
        raise ServiceError(*said)
    pause = response.headers.get("Retry-After", "")
    raise _Again(*said, pause_s=min(float(pause), _LONGEST_PAUSE_S) if pause.isdecimal() else 0.0)


def _read(kind: type[Answer], content: bytes | str) -> Answer:
    """Read an answer; what a newer service adds is left out."""
    try:
        return kind.model_validate_json(content, extra="ignore")
    except ValidationError as error:
        raise ServiceError(
            200, "unknown_answer", f"this is no {kind.__name__} of treestroke's; is it there?"
        ) from error


def _unreachable(address: object, error: httpx.TransportError) -> ServiceError:
    why = str(error) or type(error).__name__
    return ServiceError(0, "unreachable", f"{address} does not answer ({why}); start it by `treestroke serve`")


def _plain(strokes: StrokesLike) -> dict[str, Any]:
    if isinstance(strokes, Strokes):
        return strokes.model_dump(mode="json", exclude_none=True)
    if isinstance(strokes, Mapping):
        return dict(strokes)
    plain: dict[str, Any] = json.loads(Path(strokes).read_bytes())
    return plain


def _content(file: str | os.PathLike[str] | bytes) -> bytes:
    return file if isinstance(file, bytes) else Path(file).read_bytes()


def _id(thing: Photo | Model | str) -> str:
    return quote(thing if isinstance(thing, str) else thing.id, safe="")


def _left(deadline: float) -> float:
    """Give the seconds until a deadline."""
    left = deadline - time.monotonic()
    if left <= 0:
        raise TimeoutError("the model is not finished yet; wait for it again, or cancel it")
    return left


def _tell(model: Model, shown: Model | None, on_progress: Callable[[Model], None] | None) -> Model:
    if on_progress is not None and model != shown:
        on_progress(model)
    return model
