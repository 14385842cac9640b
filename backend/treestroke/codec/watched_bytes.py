"""Bytes as a file that reports how far it has been read."""

import io
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

_REPORT_STEP = 0.05
"""Share of the bytes between two reports."""


class WatchedBytes(io.RawIOBase):
    """Bytes, not copied, as a file; ``report`` is called with the share, 0 to 1, that has been read."""

    def __init__(self, data: bytes, report: Callable[[float], object]) -> None:
        self._data, self._at, self._furthest, self._report = memoryview(data), 0, 0, report

    def readable(self) -> bool:
        """Return True: the file can be read."""
        return True

    def seekable(self) -> bool:
        """Return True: the file can be read from any position."""
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Move to a position, as in any file."""
        start = {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: len(self._data)}[whence]
        self._at = max(start + offset, 0)
        return self._at

    def readinto(self, buffer: "WriteableBuffer") -> int:
        """Read into a buffer, as any file does, and report each further share."""
        room = memoryview(buffer)
        found = self._data[self._at : self._at + len(room)]
        room[: len(found)] = found
        self._at += len(found)
        if self._at > self._furthest + _REPORT_STEP * len(self._data):
            self._furthest = self._at
            self._report(self._furthest / len(self._data))
        return len(found)
