"""Project files of models: packed when they are asked for, and kept for those who ask again."""

import hashlib
import json
import shutil
import threading
from collections import OrderedDict
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from treestroke.codec.project import write_project
from treestroke.service.tracing_pool import Overloaded
from treestroke.store.blobs import Blobs, Damaged
from treestroke.store.tables import ModelRow

AT_ONCE = 2
"""Projects that are packed at the same time."""
WAITING = 16
"""Projects that may be or wait to be packed; more are refused."""
MAX_KEPT_BYTES = 500_000_000
"""Of all that are kept; the one that was asked for last stays, whatever its size."""


@dataclass(frozen=True)
class Packed:
    """A project file: where it is, its SHA-256, and how many bytes it has."""

    path: Path
    sha256: str
    size: int
    state: tuple[int, ...]
    """Of the file; it changes with whatever is done to it."""


class Projects:
    """Packs piece by piece from blob to file, so that no project is in memory; what is kept goes at the next start."""

    def __init__(self, folder: Path, blobs: Blobs) -> None:
        self._folder, self._blobs = folder / "projects", blobs
        shutil.rmtree(self._folder, ignore_errors=True)
        self._packers = ThreadPoolExecutor(AT_ONCE, "packer")
        self._kept: OrderedDict[str, Future[Packed]] = OrderedDict()
        self._lock = threading.Lock()

    def ask(self, row: ModelRow) -> Future[Packed]:
        """Promise a model's project file; one of the same parts, settings and seed is packed once.

        Where it cannot be packed the promise ends in an OSError, or in Damaged where a part of it is.

        Raises
        ------
        Overloaded
            Too many wait to be packed.
        """
        key = hashlib.sha256(json.dumps([row.parts, row.settings, row.seed], sort_keys=True).encode()).hexdigest()
        with self._lock:
            promised = self._kept.pop(key, None)
            if promised is None or _gone(promised):
                if sum(not one.done() for one in self._kept.values()) >= WAITING:
                    raise Overloaded("too many projects are being packed at the moment")
                promised = self._packers.submit(self._pack, key, row)
            self._kept[key] = promised  # behind all others: it is the last to go
            return promised

    def close(self) -> None:
        """Pack no more."""
        self._packers.shutdown(cancel_futures=True)

    def _pack(self, key: str, row: ModelRow) -> Packed:
        self._folder.mkdir(mode=0o700, exist_ok=True)
        path = self._folder / key
        try:
            with ExitStack() as opened:
                out = opened.enter_context(path.open("w+b"))
                blobs = {part: self._blobs.check(blob) for part, blob in row.parts.items()}
                parts = {part: opened.enter_context(blob.open("rb")) for part, blob in blobs.items()}
                write_project(out, parts, {**row.settings, "seed": row.seed})
                size = out.tell()
                out.seek(0)
                sha256 = hashlib.file_digest(out, "sha256").hexdigest()
        except (OSError, Damaged):
            path.unlink(missing_ok=True)
            raise
        self._make_room(size)
        return Packed(path, sha256, size, _state(path))

    def _make_room(self, size: int) -> None:
        """Remove what was asked for longest ago, until a new one of this size fits in."""
        with self._lock:
            done = {key: one.result() for key, one in self._kept.items() if one.done() and not one.exception()}
            room = MAX_KEPT_BYTES - size - sum(packed.size for packed in done.values())
            for key, packed in done.items():
                if room >= 0:
                    break
                packed.path.unlink(missing_ok=True)
                del self._kept[key]
                room += packed.size


def _gone(promised: Future[Packed]) -> bool:
    """Tell whether a promise has come to nothing: its packing failed, or its file was removed or changed."""
    if not promised.done():
        return False
    if promised.cancelled() or promised.exception() is not None:
        return True
    packed = promised.result()
    return _state(packed.path) != packed.state


def _state(path: Path) -> tuple[int, ...]:
    """Tell a file's state; () where there is none."""
    try:
        now = path.stat()
    except FileNotFoundError:
        return ()
    return now.st_ino, now.st_size, now.st_mtime_ns, now.st_ctime_ns
