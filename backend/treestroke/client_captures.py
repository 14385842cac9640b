"""What a client does with captures: photos of one tree from several places."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Unpack

import httpx

from treestroke.capture_schemas import CaptureInfo, CapturePage, CapturePhotoInfo, CaptureState, CaptureTraceAnswer
from treestroke.client_connection import Connection, Followed, id_of
from treestroke.codec.photo_kinds import PHOTO_ENDINGS
from treestroke.request_bodies import TraceOptions, TreeOptions, ViewsLike, plain_strokes
from treestroke.responses import read
from treestroke.schemas import ModelInfo

CaptureLike = CaptureState | str
"""A capture, or its id."""
_TRACE_SECONDS = 600.0
"""A trace may take longer than other answers: all photos are read, and others may be before it."""


class CaptureCalls(Connection):
    """The calls of a `Client` about captures."""

    def make_capture(self, name: str = "") -> CaptureInfo:
        """Make a capture without photos."""
        return read(CaptureInfo, self._ask("POST", "/v1/captures", json={"name": name}).content)

    def capture(self, capture: CaptureLike) -> CaptureInfo:
        """Return a capture with its photos, and once it is solved with their cameras."""
        return read(CaptureInfo, self._ask("GET", f"/v1/captures/{id_of(capture)}").content)

    def captures(self) -> Iterator[CaptureState]:
        """Yield all captures, newest first; pages are requested as they are needed."""
        for page in self._pages(CapturePage, "/v1/captures"):
            yield from page.captures

    def add_photos(
        self, capture: CaptureLike, photos: str | os.PathLike[str] | Sequence[str | os.PathLike[str]]
    ) -> list[CapturePhotoInfo]:
        """Add the photos of a folder, in the order of their names, or those of paths; those it has already stay.

        Raises
        ------
        ServiceError
            There is no such capture, or a photo cannot be used; those before it were added.
        OSError
            A file cannot be read.
        """
        paths = _in_folder(Path(photos)) if isinstance(photos, str | os.PathLike) else [Path(path) for path in photos]
        return [self._add_photo(id_of(capture), path) for path in paths]

    def solve(
        self,
        capture: CaptureLike,
        timeout: float | None = None,
        on_progress: Callable[[CaptureState], None] | None = None,
    ) -> CaptureInfo:
        """Find a capture's cameras, wait until that is over, and return it: ``solved``, ``failed`` or ``unsolved``.

        Parameters
        ----------
        timeout
            Seconds; no limit by default.
        on_progress
            Called with the capture's state, at once and after every change.

        Raises
        ------
        TimeoutError
            It took longer than ``timeout``; the search goes on.
        ServiceError
            There is no such capture, it has too few photos, or the service cannot be reached.
        """
        place = f"/v1/captures/{id_of(capture)}"
        self._ask("POST", f"{place}/solve")
        self._follow(Followed(CaptureState, place, ("solved", "failed", "unsolved")), timeout, on_progress)
        return self.capture(capture)

    def cancel_solve(self, capture: CaptureLike) -> CaptureInfo:
        """Stop looking for a capture's cameras; what was found stays as it is."""
        return read(CaptureInfo, self._ask("POST", f"/v1/captures/{id_of(capture)}/cancel").content)

    def trace_capture(
        self,
        capture: CaptureLike,
        views: ViewsLike,
        edits: Sequence[Mapping[str, Any]] = (),
        **options: Unpack[TraceOptions],
    ) -> CaptureTraceAnswer:
        """Find the tree in the photos of a solved capture, its crown and its branches, to which ``edits`` are applied.

        ``options`` are the names of `TraceOptions`. The first answer for new strokes takes many seconds.

        Raises
        ------
        ServiceError
            There is no such capture, it is not solved, or a stroke, an edit or a setting cannot be used.
        """
        body = {**plain_strokes(views), "edits": list(edits), **options}
        patience = httpx.Timeout(self._timeout, read=max(self._timeout, _TRACE_SECONDS))
        path = f"/v1/captures/{id_of(capture)}/trace"
        return read(CaptureTraceAnswer, self._ask("POST", path, json=body, timeout=patience).content)

    def grow_capture(
        self,
        capture: CaptureLike,
        views: ViewsLike,
        edits: Sequence[Mapping[str, Any]] = (),
        settings: Mapping[str, Any] | None = None,
        seed: int = 0,
        **options: Unpack[TreeOptions],
    ) -> ModelInfo:
        """Ask for a tree of a solved capture; else as `Client.grow`. ``options`` are the names of `TreeOptions`.

        Raises
        ------
        ServiceError
            There is no such capture, it is not solved, or a stroke, an edit or a setting cannot be used.
        """
        inputs = {"capture": id_of(capture), "views": plain_strokes(views)}
        return self._ask_for_tree({**inputs, **({"edits": list(edits)} if edits else {})}, settings, seed, options)

    def rename_capture(self, capture: CaptureLike, name: str) -> CaptureInfo:
        """Name a capture."""
        return read(CaptureInfo, self._ask("PATCH", f"/v1/captures/{id_of(capture)}", json={"name": name}).content)

    def delete_capture(self, capture: CaptureLike) -> None:
        """Delete a capture with its photos; for 24 hours `restore_capture` undoes that."""
        self._ask("DELETE", f"/v1/captures/{id_of(capture)}")

    def restore_capture(self, capture: CaptureLike) -> CaptureInfo:
        """Undo a capture's deletion."""
        return read(CaptureInfo, self._ask("POST", f"/v1/captures/{id_of(capture)}/restore").content)

    def _add_photo(self, capture: str, path: Path) -> CapturePhotoInfo:
        headers = {"Content-Type": "application/octet-stream"}
        place, content = f"/v1/captures/{capture}/photos", path.read_bytes()
        answer = self._ask("POST", place, params={"name": path.name}, content=content, headers=headers)
        return read(CapturePhotoInfo, answer.content)


def _in_folder(folder: Path) -> list[Path]:
    """Return the photos of a folder in the order of their names."""
    return sorted(path for path in folder.iterdir() if path.suffix.lower() in PHOTO_ENDINGS)
