"""A client of the service: sends photos, clips and sketches, receives traces and trees; needs no modelling package."""

import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Unpack
from urllib.parse import quote

from treestroke.client_captures import CaptureLike
from treestroke.client_clips import ClipCalls, ClipLike
from treestroke.client_connection import Followed, id_of
from treestroke.request_bodies import (
    FrameStrokesLike,
    PhotoOptions,
    PictureLike,
    SiblingOptions,
    SketchLike,
    SketchOptions,
    StrokesLike,
    TreeOptions,
    ViewsLike,
    file_bytes,
    plain_sketch,
    plain_sketches,
    plain_strokes,
)
from treestroke.responses import Event, ServiceError, read
from treestroke.schemas import GrownSkeleton, ModelInfo, ModelPage, PhotoInfo, PhotoPage, SketchTraceAnswer, TraceAnswer

__all__ = [
    "CaptureLike",
    "Client",
    "ClipLike",
    "FrameStrokesLike",
    "PhotoOptions",
    "PictureLike",
    "ServiceError",
    "SiblingOptions",
    "SketchLike",
    "SketchOptions",
    "StrokesLike",
    "TreeOptions",
    "ViewsLike",
]

_ENDS = ("succeeded", "failed", "canceled")


class Client(ClipCalls):
    """A connection to one service; threads may share it.

    A request is sent again, for some seconds, where the service was too busy for it or the connection broke and sending
    it twice does no harm.

    Parameters
    ----------
    address
        The address on which `treestroke serve` listens.
    timeout
        Seconds that the service may take for one answer.
    key
        A key of a member (``ts_...``), where the service has keys; ``TREESTROKE_KEY`` of the environment where absent.
    """

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
        return read(PhotoInfo, self._ask("GET", f"/v1/photos/{id_of(photo)}").content)

    def photos(self) -> Iterator[PhotoInfo]:
        """Yield all photos, newest first; pages are requested as they are needed."""
        for page in self._pages(PhotoPage, "/v1/photos"):
            yield from page.photos

    def delete_photo(self, photo: PhotoInfo | str) -> None:
        """Delete a photo; models that were made of it keep their own copy."""
        self._ask("DELETE", f"/v1/photos/{id_of(photo)}")

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
        return read(TraceAnswer, self._ask("POST", f"/v1/photos/{id_of(photo)}/trace", json=body).content)

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
        inputs = {"photo": id_of(photo), "strokes": plain_strokes(strokes), **sketches}
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
        inputs = {"sketches": plain_sketches(front, side), **({} if photo is None else {"photo": id_of(photo)})}
        return self._ask_for_tree(inputs, settings, seed, options)

    def siblings(self, model: ModelInfo | str, count: int, **options: Unpack[SiblingOptions]) -> ModelInfo:
        """Ask for other trees of the same kind, as files of a new model: ``tree.s1.glb`` and so on; `wait` for it.

        ``options`` are the names of `SiblingOptions`.

        Raises
        ------
        ServiceError
            There is no such model, or an option cannot be used.
        """
        path = f"/v1/models/{id_of(model)}/siblings"
        return read(ModelInfo, self._ask("POST", path, json={"count": count, **options}).content)

    def model(self, model: ModelInfo | str) -> ModelInfo:
        """Return a model."""
        return read(ModelInfo, self._ask("GET", f"/v1/models/{id_of(model)}").content)

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

        def show(event: Event) -> None:
            if on_preview is not None:
                on_preview(read(GrownSkeleton, event.text))

        return self._follow(Followed(ModelInfo, f"/v1/models/{id_of(model)}", _ENDS), timeout, on_progress, show)

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
        self._download(f"/v1/models/{id_of(model)}/{quote(file, safe='')}", place)
        return place

    def rename(self, model: ModelInfo | str, name: str) -> ModelInfo:
        """Name a model."""
        return read(ModelInfo, self._ask("PATCH", f"/v1/models/{id_of(model)}", json={"name": name}).content)

    def cancel(self, model: ModelInfo | str) -> ModelInfo:
        """Stop a model that is not finished; a finished one stays as it is."""
        return read(ModelInfo, self._ask("POST", f"/v1/models/{id_of(model)}/cancel").content)

    def delete(self, model: ModelInfo | str) -> None:
        """Delete a model; for 24 hours `restore` undoes that."""
        self._ask("DELETE", f"/v1/models/{id_of(model)}")

    def restore(self, model: ModelInfo | str) -> ModelInfo:
        """Undo a model's deletion."""
        return read(ModelInfo, self._ask("POST", f"/v1/models/{id_of(model)}/restore").content)
