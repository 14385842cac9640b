"""Bytes as a file that tells how far it was read."""

import io
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

_TOLD = 0.05
"""Share of the bytes after which it is told again."""


class WatchedBytes(io.RawIOBase):
    """Bytes, not copied, as a file; ``told`` is called with the share, 0 to 1, that was read."""

    def __init__(self, data: bytes, told: Callable[[float], object]) -> None:
        self._data, self._at, self._furthest, self._told = memoryview(data), 0, 0, told

    def readable(self) -> bool:
        """Say that it can be read."""
        return True

    def seekable(self) -> bool:
        """Say that it can be read from anywhere."""
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place, as in any file."""
        start = {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: len(self._data)}[whence]
        self._at = max(start + offset, 0)
        return self._at

    def readinto(self, buffer: "WriteableBuffer") -> int:
        """Read, as any file does; tell of each further share."""
        room = memoryview(buffer)
        found = self._data[self._at : self._at + len(room)]
        room[: len(found)] = found
        self._at += len(found)
        if self._at > self._furthest + _TOLD * len(self._data):
            self._furthest = self._at
            self._told(self._furthest / len(self._data))
        return len(found)
