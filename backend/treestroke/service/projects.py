"""Project files of models: packed on request, and cached."""

import hashlib
import json
import shutil
import threading
from collections import OrderedDict
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from treestroke.service import packing
from treestroke.service.stored_models import StoredModel
from treestroke.service.tracing_pool import CannotStart, Crashed, Overloaded, TracingPool
from treestroke.store.blobs import Blobs
from treestroke.store.objects import Damaged
from treestroke.store.scope import Scope

AT_ONCE = 2
"""Projects that are packed at the same time."""
WAITING = 16
"""Projects that may be in packing or wait for it; further requests are refused."""
MAX_CACHE_BYTES = 500_000_000
"""Size of the cache; the project that was requested last stays, whatever its size."""


@dataclass(frozen=True)
class Packed:
    """A project file: where it is, its SHA-256, and how many bytes it has."""

    path: Path
    sha256: str
    size: int
    state: tuple[int, ...]
    """State of the file when it was packed; it is another one after every change."""


class Projects:
    """Has projects packed to files by other processes; a start empties the cache."""

    def __init__(self, blobs: Blobs, packers: TracingPool) -> None:
        self._folder, self._blobs, self._pool = blobs.data / "projects", blobs, packers
        shutil.rmtree(self._folder, ignore_errors=True)
        self._packers = ThreadPoolExecutor(AT_ONCE, "packer")
        self._cache: OrderedDict[str, Future[Packed]] = OrderedDict()
        self._lock = threading.Lock()

    def pack(self, model: StoredModel) -> Future[Packed]:
        """Pack a model's project file, once for all models of the same inputs, settings and seed.

        The future raises an OSError where it cannot be packed, Damaged where a part of it is, or Crashed or CannotStart
        where the process ended.

        Raises
        ------
        Overloaded
            Too many projects wait to be packed.
        """
        blobs = {name: part.blob for name, part in model.inputs.parts.items()}
        settings = {**model.row.settings, "seed": model.row.seed}
        team = Scope(model.row.team, model.row.maker)
        key = hashlib.sha256(json.dumps([team.team, blobs, settings], sort_keys=True).encode()).hexdigest()
        with self._lock:
            packed = self._cache.pop(key, None)
            if packed is None or _is_lost(packed):
                if sum(not other.done() for other in self._cache.values()) >= WAITING:
                    raise Overloaded("too many projects are being packed at the moment")
                packed = self._packers.submit(self._write, self._blobs.of(team), key, blobs, settings)
            self._cache[key] = packed  # at the end: the first to go is the one requested longest ago
            return packed

    def close(self) -> None:
        """Stop packing."""
        self._packers.shutdown(cancel_futures=True)

    def _write(self, own: Blobs, key: str, blobs: dict[str, str], settings: dict[str, Any]) -> Packed:
        self._folder.mkdir(mode=0o700, exist_ok=True)
        path = self._folder / key
        try:
            parts = {name: own.check(blob) for name, blob in blobs.items()}
            size, sha256 = self._pool(key, packing.pack, path, parts, settings)
        except (OSError, Damaged, Crashed, CannotStart):
            path.unlink(missing_ok=True)
            raise
        self._make_room(size)
        return Packed(path, sha256, size, _state(path))

    def _make_room(self, size: int) -> None:
        """Remove the projects that were requested longest ago, until one of this size fits in."""
        with self._lock:
            done = {
                key: packing.result()
                for key, packing in self._cache.items()
                if packing.done() and not packing.exception()
            }
            room = MAX_CACHE_BYTES - size - sum(packed.size for packed in done.values())
            for key, packed in done.items():
                if room >= 0:
                    break
                packed.path.unlink(missing_ok=True)
                del self._cache[key]
                room += packed.size


def _is_lost(packing: Future[Packed]) -> bool:
    """Return whether packing failed, or the packed file was removed or changed."""
    if not packing.done():
        return False
    if packing.cancelled() or packing.exception() is not None:
        return True
    packed = packing.result()
    return _state(packed.path) != packed.state


def _state(path: Path) -> tuple[int, ...]:
    """Return a file's state; () where there is no file."""
    try:
        now = path.stat()
    except FileNotFoundError:
        return ()
    return now.st_ino, now.st_size, now.st_mtime_ns, now.st_ctime_ns
