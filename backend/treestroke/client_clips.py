"""What a client does with clips: videos of one tree, sent in pieces that go on where the connection broke."""

import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Unpack

import httpx

from treestroke.client_captures import CaptureCalls
from treestroke.client_connection import id_of
from treestroke.clip_schemas import ClipInfo, ClipPage, ClipTraceAnswer, UploadInfo
from treestroke.request_bodies import FrameStrokesLike, TraceOptions, TreeOptions, plain_strokes
from treestroke.responses import ServiceError, read
from treestroke.schemas import ModelInfo

ClipLike = ClipInfo | str
"""A clip, or its id."""
_PIECE = 8_000_000
"""Bytes of a clip that are sent at once."""
_READ_SECONDS = 600.0
"""A clip that was just sent is read whole, and others may be before it."""
_OCTETS, _PARTIAL = {"Content-Type": "application/octet-stream"}, {"Content-Type": "application/partial-upload"}


class ClipCalls(CaptureCalls):
    """The calls of a `Client` about clips."""

    def upload_clip(self, clip: str | os.PathLike[str], on_progress: Callable[[float], None] | None = None) -> ClipInfo:
        """Upload a clip by its path: MP4, MOV, WebM, AVI or GIF; a connection that breaks loses nothing.

        ``on_progress`` is called with the fraction that has arrived.

        Raises
        ------
        ServiceError
            It cannot be used.
        OSError
            The file cannot be read.
        """
        path = Path(clip)
        size = path.stat().st_size
        headers = {"Upload-Complete": "?0", "Upload-Length": str(size), **_OCTETS}
        begun = self._ask("POST", "/v1/clips", params={"name": path.name}, headers=headers)
        place, offset = f"/v1/uploads/{read(UploadInfo, begun.content).id}", 0
        with path.open("rb") as file:
            while True:
                file.seek(offset)
                piece = file.read(_PIECE)
                last = offset + len(piece) >= size
                answer = self._send_piece(place, offset, piece, last)
                offset = int(answer.headers["Upload-Offset"])
                if on_progress is not None:
                    on_progress(offset / max(size, 1))
                if last and answer.status_code == httpx.codes.CREATED:
                    return read(ClipInfo, answer.content)

    def clip(self, clip: ClipLike) -> ClipInfo:
        """Return a clip."""
        return read(ClipInfo, self._ask("GET", f"/v1/clips/{id_of(clip)}").content)

    def clips(self) -> Iterator[ClipInfo]:
        """Yield all clips, newest first; pages are requested as they are needed."""
        for page in self._pages(ClipPage, "/v1/clips"):
            yield from page.clips

    def clip_frame(self, clip: ClipLike, frame: int, height: int | None = None) -> bytes:
        """Return one frame of a clip as a JPEG, at most ``height`` px high.

        Raises
        ------
        ServiceError
            There is no such clip or frame.
        """
        params = {} if height is None else {"height": height}
        return self._ask("GET", f"/v1/clips/{id_of(clip)}/frames/{frame}", params=params).content

    def trace_clip(self, clip: ClipLike, strokes: FrameStrokesLike, **options: Unpack[TraceOptions]) -> ClipTraceAnswer:
        """Find foliage and visible branches in a frame of a clip, and follow points of the tree through all frames.

        ``options`` are the names of `TraceOptions`. The first answer for new strokes takes many seconds.

        Raises
        ------
        ServiceError
            There is no such clip, or a stroke or a setting cannot be used.
        """
        body = {**plain_strokes(strokes), **options}
        path = f"/v1/clips/{id_of(clip)}/trace"
        return read(ClipTraceAnswer, self._ask("POST", path, json=body, timeout=self._patience()).content)

    def grow_clip(
        self,
        clip: ClipLike,
        strokes: FrameStrokesLike,
        settings: Mapping[str, Any] | None = None,
        seed: int = 0,
        **options: Unpack[TreeOptions],
    ) -> ModelInfo:
        """Ask for a tree of a clip; else as `Client.grow`. ``options`` are the names of `TreeOptions`.

        Raises
        ------
        ServiceError
            There is no such clip, or a stroke or a setting cannot be used.
        """
        inputs = {"clip": id_of(clip), "strokes": plain_strokes(strokes)}
        return self._ask_for_tree(inputs, settings, seed, options)

    def delete_clip(self, clip: ClipLike) -> None:
        """Delete a clip; models that were made of it keep their own copy."""
        self._ask("DELETE", f"/v1/clips/{id_of(clip)}")

    def _send_piece(self, place: str, offset: int, piece: bytes, last: bool) -> httpx.Response:
        """Send a piece; where one of its tries arrived in part, or whole, the service's offset is what counts."""
        headers = {"Upload-Offset": str(offset), "Upload-Complete": f"?{int(last)}", **_PARTIAL}
        try:
            return self._ask("PATCH", place, content=piece, headers=headers, timeout=self._patience())
        except ServiceError as error:
            if error.code not in ("upload_offset_wrong", "upload_superseded"):
                raise
            return self._ask("GET", place)

    def _patience(self) -> httpx.Timeout:
        return httpx.Timeout(self._timeout, read=max(self._timeout, _READ_SECONDS))
