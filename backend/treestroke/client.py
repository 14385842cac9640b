"""A client of the service: uploads photos and sketches, downloads traces and trees; needs no modelling package."""

import hashlib
import math
import os
import secrets
import time
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import closing, suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self, TypeVar, Unpack
from urllib.parse import quote

import httpx

from treestroke.request_bodies import (
    PhotoOptions,
    PictureLike,
    SketchLike,
    SketchOptions,
    StrokesLike,
    TreeOptions,
    file_bytes,
    plain_options,
    plain_sketch,
    plain_sketches,
    plain_strokes,
)
from treestroke.responses import Event, RetryableError, ServiceError, checked, events_of, read, unreachable
from treestroke.schemas import GrownSkeleton, ModelInfo, ModelPage, PhotoInfo, PhotoPage, SketchTraceAnswer, TraceAnswer

__all__ = [
    "Client",
    "PhotoOptions",
    "PictureLike",
    "ServiceError",
    "SketchLike",
    "SketchOptions",
    "StrokesLike",
    "TreeOptions",
]

Done = TypeVar("Done")
Page = TypeVar("Page", ModelPage, PhotoPage)

_PAUSES_S = (0.2, 0.4, 0.8, 1.6, 3.2)
"""Pauses between tries; a service that restarts is back within them."""
_SILENCE_S = 20.0
"""An event stream without even a ping for this long is broken."""
_POLL_S = 0.5
_ENDS = ("succeeded", "failed", "canceled")


class Client:
    """A connection to one service; threads may share it.

    A request is sent again, for some seconds, where the service was too busy for it or the connection broke and sending
    it twice does no harm.

    Parameters
    ----------
    address
        The address on which `treestroke serve` listens.
    timeout
        Seconds that the service may take for one answer.
    """

    def __init__(self, address: str = "http://127.0.0.1:8000", timeout: float = 60.0) -> None:
        # The service listens on this machine only: no proxy leads there.
        self._timeout = timeout
        self._http = httpx.Client(base_url=address, timeout=timeout, trust_env=False)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Close the connection."""
        self._http.close()

    def upload(self, photo: PictureLike) -> PhotoInfo:
        """Upload a photo: a path, or encoded bytes (JPEG, PNG, WebP, HEIC, AVIF or TIFF).

        Raises
        ------
        ServiceError
            It cannot be used.
        OSError
            The file cannot be read.
        """
        content = file_bytes(photo)
        headers = {"Content-Type": "application/octet-stream"}
        return read(PhotoInfo, self._ask("POST", "/v1/photos", content=content, headers=headers).content)

    def photo(self, photo: PhotoInfo | str) -> PhotoInfo:
        """Return a photo."""
        return read(PhotoInfo, self._ask("GET", f"/v1/photos/{_id(photo)}").content)

    def photos(self) -> Iterator[PhotoInfo]:
        """Yield all photos, newest first; pages are requested as they are needed."""
        for page in self._pages(PhotoPage, "/v1/photos"):
            yield from page.photos

    def delete_photo(self, photo: PhotoInfo | str) -> None:
        """Delete a photo; models that were made of it keep their own copy."""
        self._ask("DELETE", f"/v1/photos/{_id(photo)}")

    def trace(
        self,
        photo: PhotoInfo | str,
        strokes: StrokesLike,
        rev: int | None = None,
        grow: bool = False,
        *,
        side: SketchLike | None = None,
        settings: Mapping[str, Any] | None = None,
    ) -> TraceAnswer:
        """Find foliage and visible branches; with ``grow`` the whole tree's skeleton too, by ``settings``.

        The answer repeats ``rev``. A sketch of the tree's left ``side`` gives the skeleton its depth.

        Raises
        ------
        ServiceError
            There is no such photo, or a stroke or a setting cannot be used.
        """
        body = {**plain_strokes(strokes), "grow": grow} | ({} if rev is None else {"rev": rev})
        body |= {} if side is None else {"side": plain_sketch(side)}
        body |= {} if settings is None else {"settings": dict(settings)}
        return read(TraceAnswer, self._ask("POST", f"/v1/photos/{_id(photo)}/trace", json=body).content)

    def trace_sketches(
        self, front: SketchLike, side: SketchLike | None = None, rev: int | None = None, grow: bool = False
    ) -> SketchTraceAnswer:
        """Find the branches that sketches of a tree's front and left side show; else as `trace`.

        Raises
        ------
        ServiceError
            A sketch cannot be used.
        """
        body = {**plain_sketches(front, side), "grow": grow} | ({} if rev is None else {"rev": rev})
        return read(SketchTraceAnswer, self._ask("POST", "/v1/sketches/trace", json=body).content)

    def grow(
        self,
        photo: PhotoInfo | str,
        strokes: StrokesLike,
        settings: Mapping[str, Any] | None = None,
        seed: int = 0,
        **options: Unpack[PhotoOptions],
    ) -> ModelInfo:
        """Ask for a tree; `wait` for it. The request may be cut off and sent again: it makes one model.

        ``options`` are the names of `PhotoOptions`.

        Raises
        ------
        ServiceError
            There is no such photo, or a stroke or a setting cannot be used.
        """
        side = options.pop("side", None)
        sketches = {} if side is None else {"sketches": {"side": plain_sketch(side)}}
        inputs = {"photo": _id(photo), "strokes": plain_strokes(strokes), **sketches}
        return self._ask_for_tree(inputs, settings, seed, options)

    def grow_sketches(
        self,
        front: SketchLike,
        side: SketchLike | None = None,
        settings: Mapping[str, Any] | None = None,
        seed: int = 0,
        **options: Unpack[SketchOptions],
    ) -> ModelInfo:
        """Ask for a tree from sketches of its front and, where there is one, of its left side; else as `grow`.

        ``options`` are the names of `SketchOptions`.

        Raises
        ------
        ServiceError
            A sketch or a setting cannot be used, or there is no such photo.
        """
        photo = options.pop("photo", None)
        inputs = {"sketches": plain_sketches(front, side), **({} if photo is None else {"photo": _id(photo)})}
        return self._ask_for_tree(inputs, settings, seed, options)

    def model(self, model: ModelInfo | str) -> ModelInfo:
        """Return a model."""
        return read(ModelInfo, self._ask("GET", f"/v1/models/{_id(model)}").content)

    def models(self) -> Iterator[ModelInfo]:
        """Yield all models, newest first; pages are requested as they are needed."""
        for page in self._pages(ModelPage, "/v1/models"):
            yield from page.models

    def wait(
        self,
        model: ModelInfo | str,
        timeout: float | None = None,
        on_progress: Callable[[ModelInfo], None] | None = None,
        on_preview: Callable[[GrownSkeleton], None] | None = None,
    ) -> ModelInfo:
        """Follow a model until it has succeeded, failed or been canceled, and return it.

        A stream of events that breaks is resumed; where none arrives, the model is polled.

        Parameters
        ----------
        timeout
            Seconds; no limit by default.
        on_progress
            Called with the model, at once and after every change.
        on_preview
            Called with the grown skeleton when growth ends, if the stream of events arrives.

        Raises
        ------
        TimeoutError
            It took longer than ``timeout``; the model goes on.
        ServiceError
            There is no such model, or the service cannot be reached.
        """
        deadline = math.inf if timeout is None else time.monotonic() + timeout
        last, shown = "", None
        while True:
            with closing(self._events(_id(model), last, min(_left(deadline), _SILENCE_S))) as events:
                for event in events:
                    last = event.id or last
                    if event.kind != "preview":
                        shown = _tell(read(ModelInfo, event.text), shown, on_progress)
                    elif on_preview is not None:
                        on_preview(read(GrownSkeleton, event.text))
                    if shown is not None and event.kind in _ENDS:
                        return shown
                    _left(deadline)
            shown = _tell(self.model(model), shown, on_progress)
            if shown.status in _ENDS:
                return shown
            time.sleep(min(_POLL_S, _left(deadline)))

    def download(self, model: ModelInfo | str, path: str | os.PathLike[str], file: str = "tree.glb") -> Path:
        """Download one of a model's files, whole or not at all, checked against its SHA-256; return its path.

        Raises
        ------
        ServiceError
            There is no such model or file, or it did not arrive undamaged.
        OSError
            It cannot be written.
        """
        place = Path(path)
        temporary = place.with_name(f".treestroke-{secrets.token_hex(8)}")
        try:
            self._repeat(lambda: self._fetch(f"/v1/models/{_id(model)}/{quote(file, safe='')}", temporary))
            temporary.replace(place)
        finally:
            temporary.unlink(missing_ok=True)
        return place

    def rename(self, model: ModelInfo | str, name: str) -> ModelInfo:
        """Name a model."""
        return read(ModelInfo, self._ask("PATCH", f"/v1/models/{_id(model)}", json={"name": name}).content)

    def cancel(self, model: ModelInfo | str) -> ModelInfo:
        """Stop a model that is not finished; a finished one stays as it is."""
        return read(ModelInfo, self._ask("POST", f"/v1/models/{_id(model)}/cancel").content)

    def delete(self, model: ModelInfo | str) -> None:
        """Delete a model; for 24 hours `restore` undoes that."""
        self._ask("DELETE", f"/v1/models/{_id(model)}")

    def restore(self, model: ModelInfo | str) -> ModelInfo:
        """Undo a model's deletion."""
        return read(ModelInfo, self._ask("POST", f"/v1/models/{_id(model)}/restore").content)

    def _pages(self, kind: type[Page], path: str) -> Iterator[Page]:
        cursor: dict[str, str] = {}
        while True:
            page = read(kind, self._ask("GET", path, params=cursor).content)
            yield page
            if page.next is None:
                return
            cursor = {"cursor": page.next}

    def _ask_for_tree(
        self, inputs: Mapping[str, Any], settings: Mapping[str, Any] | None, seed: int, options: Mapping[str, Any]
    ) -> ModelInfo:
        headers = {"Idempotency-Key": options.get("idempotency_key") or secrets.token_hex(16)}
        body = {**inputs, **plain_options(options), "settings": dict(settings or {}), "seed": seed}
        return read(ModelInfo, self._ask("POST", "/v1/models", json=body, headers=headers).content)

    def _ask(self, method: str, path: str, **request: Any) -> httpx.Response:
        # A deletion that was cut off may have happened; sent again it would fail.
        return self._repeat(lambda: checked(self._http.request(method, path, **request)), harmless=method != "DELETE")

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

    def _events(self, id: str, last: str, seconds: float) -> Generator[Event]:
        """Yield a model's events until the stream ends, however it ends; silence for ``seconds`` ends it too."""
        headers = {"Last-Event-ID": last} if last else {}
        timeout = httpx.Timeout(self._timeout, read=seconds)
        path = f"/v1/models/{id}/events"
        with suppress(httpx.TransportError), self._http.stream("GET", path, headers=headers, timeout=timeout) as answer:
            if answer.is_success:
                yield from events_of(answer.iter_bytes())


def _id(info: PhotoInfo | ModelInfo | str) -> str:
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
        raise TimeoutError("the model is not finished yet; wait for it again, or cancel it")
    return left


def _tell(model: ModelInfo, shown: ModelInfo | None, on_progress: Callable[[ModelInfo], None] | None) -> ModelInfo:
    if on_progress is not None and model != shown:
        on_progress(model)
    return model
