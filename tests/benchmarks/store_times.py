"""How long a store of many models answers, and holds locks, on SQLite and on Postgres; `make bench` prints it.

Half of the models were answered from others, the newest among them; each has a report, two parts and three files. What
is timed runs in this process, on a database of its own.
"""

import json
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from sqlalchemy import Engine, event, insert, text, update
from sqlalchemy.pool import Pool
from tests.api import drawn
from tests.postgres import running_postgres

from treestroke.service import model_request, photos, stored_models
from treestroke.service.engine_version import engine_version
from treestroke.service.photos import Resources
from treestroke.service.retention import Sweeper
from treestroke.service.tracing_pool import TracingPool
from treestroke.store import queries
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.scope import LOCAL, SERVICE
from treestroke.store.tables import File, ModelPart, ModelRow
from treestroke.store.uploads import Uploads

SIZES = (10_000, 100_000)
ASKED, DELETED, REPEATS = 40, 1000, 20
PROMISED_MS = 20
REPORT = {"score": {"silhouette_iou": 0.9}, "measures": {f"figure_{at}": "x" * 60 for at in range(40)}}
LOCKING = ("BEGIN IMMEDIATE", "INSERT", "UPDATE", "DELETE")
"""How statements begin that lock something until all is committed; others say so within."""
_FILES = ("tree.glb", "preview.png", "growth.json")
_PARTS = {"photo": "image/png", "strokes": "application/json"}
_STEP = 1000
_DAY = 86_400.0


def fill(database: Database, count: int) -> None:
    """Write so many finished models straight into the tables."""
    with database.writing() as session:
        for begin in range(0, count, _STEP):
            numbers = range(begin, min(begin + _STEP, count))
            session.execute(insert(ModelRow), [_model(at, count) for at in numbers])
            session.execute(insert(File), [_file(at, *each) for at in numbers for each in enumerate(_FILES)])
            session.execute(insert(ModelPart), [_part(at, *each) for at in numbers for each in _PARTS.items()])
    if database.url:
        with database.autocommitting() as session:
            session.execute(text("ANALYZE"))  # as Postgres does by itself, within a minute


def _model(at: int, count: int) -> dict[str, Any]:
    repeated = at % 2 or at > count - 1000
    return {
        "id": _id(at),
        "name": f"Tree {at}",
        "photo": "pho_1",
        "settings": {},
        "seed": at,
        "engine": engine_version(),
        "fingerprint": _blob(at),
        "status": "succeeded",
        "phase_fraction": 0.0,
        "progress": 1.0,
        "seq": 5,
        "attempt": 1,
        "beat": 9,
        "created": float(at),
        "started": None if repeated else float(at),
        "finished": at + 6.0,
        "report": REPORT,
    }


def _file(at: int, number: int, name: str) -> dict[str, Any]:
    return {"team": LOCAL.team, "model": _id(at), "name": name, "blob": f"{_blob(at)[:63]}{number}", "bytes": 1000}


def _part(at: int, name: str, media_type: str) -> dict[str, Any]:
    return {"team": LOCAL.team, "model": _id(at), "name": name, "blob": _blob(at), "media_type": media_type}


def _id(at: int) -> str:
    return f"mdl_{at:024x}"


def _blob(at: int) -> str:
    return f"{at * 2654435761 % 2**32:08x}" * 8


@contextmanager
def held() -> Iterator[list[float]]:
    """Collect for how long each writer of this process holds locks: from the first until all is committed."""
    began: dict[int, float] = {}
    took: list[float] = []

    def begin(connection: Any, _: Any, statement: str, *__: Any) -> None:
        if statement.startswith(LOCKING) or "FOR UPDATE" in statement or "pg_advisory" in statement:
            began.setdefault(id(connection.connection.dbapi_connection), time.perf_counter())

    def end(connection: Any, _: Any) -> None:
        if (at := began.pop(id(connection), None)) is not None:
            took.append(time.perf_counter() - at)

    event.listen(Engine, "before_cursor_execute", begin)
    event.listen(Pool, "checkin", end)
    try:
        yield took
    finally:
        event.remove(Engine, "before_cursor_execute", begin)
        event.remove(Pool, "checkin", end)


def say(name: str, took: list[float]) -> None:
    """Write down the times of many, in ms."""
    middle, late, worst = np.percentile(took, [50, 95, 100]) * 1000
    sys.stdout.write(f"{name:<46} n {len(took):4}   p50 {middle:7.2f}   p95 {late:7.2f}   max {worst:7.2f} ms\n")


def times(ask: Callable[[], object]) -> list[float]:
    """Time a question again and again."""
    took = []
    for _ in range(REPEATS):
        began = time.perf_counter()
        ask()
        took.append(time.perf_counter() - began)
    return took


def answer(database: Database, count: int) -> None:
    """Time what is asked of the tables, alone."""
    with database.reading() as session:
        row = queries.model(session, f"mdl_{count - 1:024x}")
        assert row is not None
        say(
            "an equal model that there is",
            times(lambda: queries.finished(session, ModelRow, row.fingerprint, row.engine)),
        )
        say(
            "an equal model that there is not", times(lambda: queries.finished(session, ModelRow, "0" * 64, row.engine))
        )
        say("the usual time of late", times(lambda: queries.usual_seconds(session, ModelRow)))
    say("a page of 20 models", times(lambda: stored_models.list_models(database, None, 20)))


def ask(resources: Resources) -> bool:
    """Time how long requests for models, each a new one, hold locks; tell whether that is short."""
    photo = photos.add_photo(resources, drawn.encoded()).id
    with held() as took:
        for seed in range(ASKED):
            order = model_request.read_order(json.dumps(drawn.request(photo, seed=seed)).encode())
            assert stored_models.accept_model(resources, order, f"key-{seed}").row.status == "queued"
    say(f"locks, held by POST /v1/models (< {PROMISED_MS})", took)
    return bool(np.median(took) * 1000 < PROMISED_MS)


def sweep(resources: Resources) -> None:
    """Time how long a sweep holds locks: one that marks every row, and one that removes a thousand models."""
    clock = [0.0]
    sweeper = Sweeper(
        resources.database.of(SERVICE), resources.blobs.of(SERVICE), 0, threading.Event(), lambda: clock[0]
    )
    began = time.perf_counter()
    with held() as took:
        sweeper.sweep()
    say("locks, held by the first sweep's steps", took)
    sys.stdout.write(f"{'the first sweep in all':<46} {time.perf_counter() - began:.1f} s\n")
    with resources.database.writing() as session:
        session.execute(update(ModelRow).where(ModelRow.number <= DELETED).values(deleted=1, seen=-2 * _DAY))
    began = time.perf_counter()
    with held() as took:
        assert sweeper.sweep().models == DELETED
    say(f"locks, held while {DELETED} models go", took)
    sys.stdout.write(f"{'that sweep in all':<46} {time.perf_counter() - began:.1f} s\n")


def measure(folder: Path, url: str, count: int, tracers: TracingPool) -> bool:
    """Print the times of one database; tell whether locks are held as briefly as is promised."""
    database = Database(folder, url).of(LOCAL)
    try:
        database.migrate()
        blobs = open_blobs(database, folder).of(LOCAL)
        fill(database, count)
        resources = Resources(database, blobs, tracers, tracers, tracers, Uploads(folder))
        sys.stdout.write(f"{'Postgres' if url else 'SQLite'}, {count} models\n")
        answer(database, count)
        short = ask(resources)
        sweep(resources)
    finally:
        database.close()
    return short


def main() -> int:
    """Print the times; give 1 where locks are held for longer than is promised."""
    short = True
    tracers = TracingPool(1, 20, 2048)
    with running_postgres() as postgres:
        for count in SIZES:
            for url in ("", postgres.fresh()):
                with tempfile.TemporaryDirectory() as folder:
                    short &= measure(Path(folder), url, count, tracers)
    tracers.close()
    return 0 if short else 1


if __name__ == "__main__":
    sys.exit(main())
