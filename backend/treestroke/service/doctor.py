"""Checks of the installation and of the deployment: what is missing or broken, and how to mend it."""

import os
import shutil
import sqlite3
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import httpx
from pydantic import ValidationError
from redis import Redis, RedisError
from sqlalchemy import func, select
from sqlalchemy.exc import SQLAlchemyError

from treestroke import __version__
from treestroke.schemas import Health
from treestroke.service.readiness import MIN_FREE_BYTES
from treestroke.service.tracing_pool import CannotStart, Crashed, TracingPool
from treestroke.settings import Settings
from treestroke.store.blobs import Blobs, open_blobs
from treestroke.store.data_folder import DataFolderError, is_open_to_others
from treestroke.store.database import Database
from treestroke.store.objects import Damaged, StorageAway
from treestroke.store.queries import referenced
from treestroke.store.scope import SERVICE, Scope
from treestroke.store.tables import JOBS, UNFINISHED, BlobRow, Worker

_BROKER_SECONDS = 2
_WEB_SECONDS = 5.0
_WATCH_SECONDS = 3.0
"""A running worker sends a heartbeat within this time."""
_MAX_NAMED = 20
"""Damaged files that are listed by name."""
_SERVE = "`treestroke serve`"
_PACKAGES = ("cv2", "maxflow", "PIL", "pillow_heif", "fastapi", "uvicorn", "celery", "sqlalchemy", "alembic")
_REDIS_PACKAGES, _POSTGRES_PACKAGES, _BUCKET_PACKAGES = ("kombu.transport.redis",), ("psycopg",), ("boto3",)
"""Modules that are imported, by their names, only with a Redis for the queue, a Postgres, or a bucket for the files."""
_WEB_PROCESS_ONLY = ("broker", "dispatcher", "tracers")
"""Checks that only the web process can make."""


@dataclass(frozen=True)
class Finding:
    """The result of one check: whether all is in order, what was found, and how to mend it."""

    part: str
    ok: bool
    found: str
    mend: str = ""


def examine(settings: Settings) -> Iterator[Finding]:
    """Check everything that the service needs, part by part; nothing is created."""
    yield from examine_installation(settings)
    yield from examine_deployment(settings)


def examine_installation(settings: Settings) -> Iterator[Finding]:
    """Check what is installed, and whether it starts."""
    redis, postgres = () if settings.embedded else _REDIS_PACKAGES, _POSTGRES_PACKAGES if settings.hosted else ()
    yield _packages((*_PACKAGES, *redis, *postgres, *(_BUCKET_PACKAGES if settings.bucket_url else ())))
    yield _engine()
    yield _tracers(settings)


def examine_deployment(settings: Settings) -> Iterator[Finding]:
    """Check what runs and what is stored."""
    folder = _folder(settings)
    yield folder
    yield _disk(settings)
    yield _web_process(settings)
    yield _messages(settings) if settings.embedded else _redis(settings)
    if folder.ok:
        yield from _rows(settings)


def _packages(names: Sequence[str]) -> Finding:
    missing = sorted({module for name in names if (module := _missing_module(name)) is not None})
    if missing:
        return Finding(
            "packages", False, f"missing: {', '.join(missing)}", "run `make setup`, or install treestroke again"
        )
    return Finding("packages", True, f"all installed; treestroke {__version__}")


def _missing_module(name: str) -> str | None:
    """Import a module; return the name of the module that is missing, which may be another one, or None."""
    try:
        import_module(name)
    except ImportError as error:
        return error.name or name
    return None


def _engine() -> Finding:
    if _missing_module("treestroke.core.grow._engine") is None:
        return Finding("growth engine", True, "compiled")
    mend = "install a C compiler and Python's headers (python3-dev), then install treestroke again"
    return Finding("growth engine", False, "not compiled: growth is many times slower", mend)


def _folder(settings: Settings) -> Finding:
    folder = settings.folder
    existing = _nearest(folder)
    mend = "choose another folder (--data, TREESTROKE_DATA), or make this one writable"
    try:
        with tempfile.TemporaryFile(dir=existing) as probe:
            probe.write(b"well")
    except OSError as error:
        return Finding("data folder", False, f"{existing}: {error.strerror}", mend)
    if existing == folder and is_open_to_others(folder):
        return Finding("data folder", False, f"{folder}: other users can read it", f"chmod 700 {folder}")
    return Finding(
        "data folder", True, str(folder) if existing == folder else f"{folder}: not there yet; {_SERVE} creates it"
    )


def _nearest(folder: Path) -> Path:
    """Return the folder, or the nearest parent that exists."""
    return next(place for place in (folder, *folder.parents) if place.exists())


def _disk(settings: Settings) -> Finding:
    free = shutil.disk_usage(_nearest(settings.folder)).free
    ok = free > MIN_FREE_BYTES
    mend = "" if ok else f"free space until {MIN_FREE_BYTES // 10**6} MB are free, or move the data folder"
    return Finding("disk", ok, f"{free // 10**6} MB free", mend)


def _tracers(settings: Settings) -> Finding:
    """Start a tracing process as the web process does, and call it."""
    pool = TracingPool(1, settings.trace_seconds, settings.memory_mb)
    try:
        pool("", os.getpid)
    except (CannotStart, Crashed) as error:
        mend = "allow more processes and open files (ulimit -u, ulimit -n), or more TREESTROKE_MEMORY_MB"
        return Finding("tracers", False, f"cannot be started: {error}", mend)
    finally:
        pool.close()
    return Finding("tracers", True, "one started and responded")


def _web_process(settings: Settings) -> Finding:
    """Ask the web process for its own checks, if one is running."""
    if settings.port == 0:
        return Finding("web process", True, "not checked: port 0 stands for any free port")
    at = httpx.URL(scheme="http", host=settings.host, port=settings.port, path="/readyz")
    place, mend = f"{at.host}:{at.port}", f"restart {_SERVE}; its log says why"
    try:
        health = Health.model_validate_json(httpx.get(at, timeout=_WEB_SECONDS, trust_env=False).content)
    except httpx.ConnectError:
        return Finding("web process", True, f"none at {place}")
    except httpx.TransportError:
        return Finding("web process", False, f"{place} does not respond within {_WEB_SECONDS:g} s", mend)
    except ValidationError:
        mend = "use another port for treestroke (--port, TREESTROKE_PORT)"
        return Finding("web process", False, f"{place} is another program", mend)
    ill = {name: check for name, check in health.checks.items() if check != "ok"}
    if health.status != "down":
        ill = {name: check for name, check in ill.items() if name in _WEB_PROCESS_ONLY}
    found = "; ".join(f"{name}: {check}" for name, check in ill.items())
    return Finding("web process", not ill, found or f"responds at {place}", mend if ill else "")


def _messages(settings: Settings) -> Finding:
    """Check that the folder of the embedded queue, if it exists, can be written to."""
    folder = settings.folder / "queue"
    try:
        if folder.exists():
            with tempfile.TemporaryFile(dir=folder) as probe:
                probe.write(b"well")
    except OSError as error:
        mend = f"make {folder} a folder that the service may write to, or move it away"
        return Finding("queue", False, f"{folder}: {error.strerror}", mend)
    return Finding("queue", True, "files in the data folder")


def _redis(settings: Settings) -> Finding:
    try:
        with Redis.from_url(
            settings.broker_url, socket_timeout=_BROKER_SECONDS, socket_connect_timeout=_BROKER_SECONDS
        ) as redis:
            # A Redis that is full, or that cannot save, responds to reads but accepts no writes.
            redis.set("treestroke.doctor", "well", ex=1)
    except (RedisError, OSError, ValueError) as error:
        mend = (
            "start Redis or free its memory, or correct TREESTROKE_BROKER_URL; until then jobs wait, and none is lost"
        )
        return Finding("queue", False, " ".join(str(error).split()) or type(error).__name__, mend)
    return Finding("queue", True, "Redis accepts messages")


def _rows(settings: Settings) -> Iterator[Finding]:
    """Check the database: whether it is sound and of this version, its files are whole and its workers run."""
    database = Database(settings.folder, settings.database_url).of(SERVICE)
    if not database.exists():
        yield _refused(database) or Finding("database", True, f"not there yet; {_SERVE} creates it")
        return
    try:
        for check in (_soundness, _files, _workers):
            finding = check(settings, database)
            yield finding
            if not finding.ok and finding.part == "database":
                return
    except (SQLAlchemyError, sqlite3.Error) as error:
        yield _unsound(database, str(getattr(error, "orig", error)))
    finally:
        database.close()


def _soundness(_: Settings, database: Database) -> Finding:
    if fault := database.fault():
        return _unsound(database, fault)
    if refused := _refused(database):
        return refused
    if not database.current():
        return Finding("database", False, "of an older version", f"start {_SERVE}, which brings it up to date")
    return Finding("database", True, "sound")


def _refused(database: Database) -> Finding | None:
    """Return the reason why the service would refuse the database at its start; None if it would not."""
    try:
        database.check()
    except DataFolderError as error:
        reason, _separator, mend = str(error).partition("; ")
        return Finding("database", False, reason, mend)
    return None


def _unsound(database: Database, why: str) -> Finding:
    return Finding("database", False, " ".join(why.split()), database.mend)


def _files(settings: Settings, database: Database) -> Finding:
    """Compare every file that a row refers to with its SHA-256, one range of names of a team at a time."""
    count, bad = 0, list[str]()
    try:
        blobs = open_blobs(database, settings.folder, settings.bucket_url)
        blobs.objects.check_reachable()
        for own, names in _named(database, blobs):
            count += len(names)
            bad += [str(error) for error in (_damage(own, name) for name in sorted(names)) if error is not None]
    except StorageAway as error:
        return Finding(
            "files", False, str(error), "start the bucket's server, or mend TREESTROKE_BUCKET_URL or AWS_..."
        )
    if bad:
        more = f", and {len(bad) - _MAX_NAMED} more" if len(bad) > _MAX_NAMED else ""
        mend = f"restore them from a copy of {blobs.objects.place}; or upload the photos and request the models again"
        return Finding(
            "files", False, f"{len(bad)} of {count} damaged or missing: {', '.join(bad[:_MAX_NAMED])}{more}", mend
        )
    return Finding("files", True, f"all {count} intact")


def _named(database: Database, blobs: Blobs) -> Iterator[tuple[Blobs, set[str]]]:
    """Yield the blobs of a team, and names that its rows refer to."""
    with database.reading() as session:
        teams = session.scalars(select(BlobRow.team).distinct()).all()
    for scope in (Scope(team, "doctor") for team in teams):
        for prefix in (f"{number:02x}" for number in range(256)):
            with database.of(scope).reading() as session:
                names = referenced(session, prefix)
            yield blobs.of(scope), names


def _damage(blobs: Blobs, name: str) -> Damaged | None:
    try:
        blobs.verify(name)
    except Damaged as error:
        return error
    return None


def _workers(_: Settings, database: Database) -> Finding:
    before = _beats(database)
    if not before:
        waiting = _waiting(database)
        mend = f"start {_SERVE}, or `treestroke worker` if workers run elsewhere" if waiting else ""
        return Finding(
            "workers", not waiting, f"none is running; {waiting} models wait" if waiting else "none is running", mend
        )
    deadline = time.monotonic() + _WATCH_SECONDS
    while not _all_beat(before, now := _beats(database)) and time.monotonic() < deadline:
        time.sleep(0.1)
    alive = sum(before.get(name) != beat for name, beat in now.items())
    mend = "" if alive else f"start {_SERVE}, which removes them, or `treestroke worker`"
    return Finding("workers", alive > 0, f"{alive} of {len(now)} are running", mend)


def _all_beat(before: dict[str, int], now: dict[str, int]) -> bool:
    return all(before.get(name) != beat for name, beat in now.items())


def _beats(database: Database) -> dict[str, int]:
    with database.reading() as session:
        return {worker.id: worker.beat for worker in session.scalars(select(Worker))}


def _waiting(database: Database) -> int:
    with database.reading() as session:
        waiting = (select(func.count()).where(table.status.in_(UNFINISHED)) for table in JOBS)
        return sum(session.scalar(query) or 0 for query in waiting)
