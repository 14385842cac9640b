"""What is missing or broken, and how to mend it."""

import shutil
import sqlite3
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module, metadata

from kombu import Connection
from sqlalchemy import select, text
from sqlalchemy.exc import SQLAlchemyError

from treestroke.queue import make_queue
from treestroke.schemas import Health
from treestroke.service.photos import Shelf
from treestroke.service.retention import referenced
from treestroke.settings import Settings
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.tables import Worker

_LEAST_FREE_BYTES = 500_000_000
_BROKER_SECONDS = 3
_PARTS = ("cv2", "maxflow", "PIL", "fastapi", "uvicorn", "celery", "sqlalchemy", "alembic")


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at: whether it is well, what was found, and what mends it."""

    part: str
    well: bool
    found: str
    mend: str = ""


def readiness(shelf: Shelf, broker_takes: bool) -> Health:
    """Tell whether requests can be taken, from what is at hand: cheap enough to be asked every second."""
    checks = {"broker": "ok" if broker_takes else "does not take messages; jobs wait"}
    try:
        with shelf.database.reading() as session:
            workers = session.scalars(select(Worker.id)).all()
        checks["database"] = "ok"
        checks["workers"] = "ok" if workers else "none; jobs wait"
    except SQLAlchemyError:
        checks["database"] = "unavailable"
    free = shutil.disk_usage(shelf.blobs.folder.parent).free
    checks["storage"] = "ok" if free > _LEAST_FREE_BYTES else f"only {free // 10**6} MB free"
    down = checks["database"] != "ok"
    well = all(check == "ok" for check in checks.values())
    return Health(status="down" if down else "ok" if well else "degraded", checks=checks)


def examine(settings: Settings) -> Iterator[Finding]:
    """Look at everything that the service needs, one part after another."""
    yield _parts()
    yield _engine()
    yield from _folder(settings)
    yield _broker(settings)
    yield from _rows(settings)


def _parts() -> Finding:
    missing = [name for name in _PARTS if not _imports(name)]
    if missing:
        return Finding(
            "packages", False, f"missing: {', '.join(missing)}", "run `make setup`, or install treestroke anew"
        )
    return Finding("packages", True, f"all there; treestroke {metadata.version('treestroke')}")


def _imports(name: str) -> bool:
    try:
        import_module(name)
    except ImportError:
        return False
    return True


def _engine() -> Finding:
    if _imports("treestroke.core.grow._engine"):
        return Finding("growth engine", True, "compiled")
    mend = "install a C compiler and Python's headers (python3-dev), and install treestroke anew"
    return Finding("growth engine", False, "not compiled: growth takes minutes", mend)


def _folder(settings: Settings) -> Iterator[Finding]:
    folder = settings.folder
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".doctor"
        probe.write_bytes(b"well")
        probe.unlink()
    except OSError as error:
        mend = "choose another folder (TREESTROKE_DATA) or make this one writable"
        yield Finding("data folder", False, f"{folder}: {error.strerror}", mend)
        return
    yield Finding("data folder", True, str(folder))
    free = shutil.disk_usage(folder).free
    well = free > _LEAST_FREE_BYTES
    yield Finding("disk", well, f"{free // 10**6} MB free", "" if well else "free space, or move the data folder")


def _broker(settings: Settings) -> Finding:
    name = "queue (Redis)" if settings.broker_url else "queue (files)"
    try:
        with make_queue(settings).connection_for_write() as connection:
            _connect(connection)
    except Exception as error:  # noqa: BLE001 - a broker fails in many ways
        mend = "start Redis, or correct TREESTROKE_BROKER_URL; jobs wait until then and none is lost"
        return Finding(name, False, str(error) or type(error).__name__, mend)
    return Finding(name, True, "takes messages")


def _connect(connection: Connection) -> None:
    connection.ensure_connection(max_retries=1, timeout=_BROKER_SECONDS)


def _rows(settings: Settings) -> Iterator[Finding]:
    """Look into the database: sound, of this version, every file there, a worker alive."""
    database = Database(settings.folder)
    if not database.path.exists():
        yield Finding("database", True, "none yet; `treestroke serve` makes it")
        return
    for look in (_soundness, _files, _workers):
        try:
            yield look(settings, database)
        except (SQLAlchemyError, sqlite3.DatabaseError) as error:
            mend = f"stop the service and restore {database.path} from a copy"
            yield Finding("database", False, str(getattr(error, "orig", error)), mend)
            return
    database.close()


def _soundness(_: Settings, database: Database) -> Finding:
    with database.reading() as session:
        said = session.execute(text("PRAGMA quick_check")).scalar()
    if said != "ok":
        return Finding("database", False, str(said), f"stop the service and restore {database.path} from a copy")
    if not database.current():
        return Finding("database", False, "of another version", "start `treestroke serve`, which brings it up to date")
    return Finding("database", True, "sound")


def _files(settings: Settings, database: Database) -> Finding:
    blobs = Blobs(settings.folder)
    missing = [name for name in referenced(database) if not blobs.path(name).is_file()]
    if missing:
        return Finding("files", False, f"{len(missing)} missing", f"restore {blobs.folder} from a copy")
    return Finding("files", True, "all there")


def _workers(_: Settings, database: Database) -> Finding:
    before = _beats(database)
    if not before:
        return Finding("workers", True, "none runs")
    _wait(lambda: any(_beats(database).get(name) != beat for name, beat in before.items()))
    alive = [name for name, beat in _beats(database).items() if before.get(name) != beat]
    mend = "" if alive else "start `treestroke serve`, or `treestroke worker` where workers run elsewhere"
    return Finding("workers", bool(alive), f"{len(alive)} of {len(before)} alive", mend)


def _beats(database: Database) -> dict[str, int]:
    with database.reading() as session:
        return {worker.id: worker.beat for worker in session.scalars(select(Worker))}


def _wait(ready: Callable[[], bool], seconds: float = 5.0) -> None:
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline and not ready():
        time.sleep(0.1)
