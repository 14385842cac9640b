"""How long a store of many models answers, and holds the one lock of writers; `make bench` prints it.

Half of the models were answered from others, the newest among them; each has a report, two parts and three files. What
is timed runs in this process, on a database of its own.
"""

import json
import sqlite3
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from sqlalchemy import Engine, event
from sqlalchemy.pool import Pool
from tests.api import drawn

from treestroke.service import model_request, photos, stored_models
from treestroke.service.engine_version import engine_version
from treestroke.service.photos import Resources
from treestroke.service.retention import Sweeper
from treestroke.service.tracing_pool import TracingPool
from treestroke.store import queries
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.scope import LOCAL
from treestroke.store.tables import ModelRow
from treestroke.store.uploads import Uploads

SIZES = (50_000, 100_000)
ASKED, DELETED, REPEATS = 40, 1000, 20
PROMISED_MS = 20
REPORT = json.dumps({"score": {"silhouette_iou": 0.9}, "measures": {f"figure_{at}": "x" * 60 for at in range(40)}})
_COLUMNS = (
    "id, name, photo, settings, seed, engine, fingerprint, status, phase_fraction, progress, seq, attempt, beat,"
    " created, started, finished, report"
)
_DAY = 86_400.0


def fill(path: Path, count: int) -> None:
    """Write so many finished models straight into the tables."""

    def row(at: int) -> tuple[Any, ...]:
        blob = f"{at * 2654435761 % 2**32:08x}" * 8
        started = None if at % 2 or at > count - 1000 else float(at)
        return (
            *(f"mdl_{at:024x}", f"Tree {at}", "pho_1", "{}", at, engine_version(), blob, "succeeded", 0, 1),
            *(5, 1, 9, float(at), started, at + 6.0, REPORT),
        )

    with closing(sqlite3.connect(path)) as database:
        marks = ",".join("?" * len(_COLUMNS.split(",")))
        database.executemany(f"INSERT INTO models ({_COLUMNS}) VALUES ({marks})", map(row, range(count)))
        files = [(name, f"{number}") for number, name in enumerate(("tree.glb", "preview.png", "growth.json"))]
        for name, digit in files:
            database.execute(
                "INSERT INTO files SELECT id, ?, substr(fingerprint, 1, 63) || ?, 1000 FROM models", (name, digit)
            )
        for name, media_type in (("photo", "image/png"), ("strokes", "application/json")):
            database.execute("INSERT INTO model_parts SELECT id, ?, fingerprint, ? FROM models", (name, media_type))
        database.commit()


@contextmanager
def held() -> Iterator[list[float]]:
    """Collect for how long each writer of this process holds the lock: from its first word until all is committed."""
    began: dict[int, float] = {}
    took: list[float] = []

    def begin(connection: Any, _: Any, statement: str, *__: Any) -> None:
        if statement == "BEGIN IMMEDIATE":
            began[id(connection.connection.dbapi_connection)] = time.perf_counter()

    def end(connection: Any, _: Any) -> None:
        if (at := began.pop(id(connection), None)) is not None:
            took.append(time.perf_counter() - at)

    event.listen(Engine, "after_cursor_execute", begin)
    event.listen(Pool, "checkin", end)
    try:
        yield took
    finally:
        event.remove(Engine, "after_cursor_execute", begin)
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
        say("an equal model that there is", times(lambda: queries.finished_model(session, row.fingerprint, row.engine)))
        say("an equal model that there is not", times(lambda: queries.finished_model(session, "0" * 64, row.engine)))
        say("the usual time of late", times(lambda: queries.usual_seconds(session, ModelRow)))
    say("a page of 20 models", times(lambda: stored_models.list_models(database, None, 20)))


def ask(resources: Resources) -> bool:
    """Time how long requests for models, each a new one, hold the lock of writers; tell whether that is short."""
    photo = photos.add_photo(resources, drawn.encoded()).id
    with held() as took:
        for seed in range(ASKED):
            order = model_request.read_order(json.dumps(drawn.request(photo, seed=seed)).encode())
            assert stored_models.accept_model(resources, order, f"key-{seed}").row.status == "queued"
    say(f"the lock, held by POST /v1/models (< {PROMISED_MS})", took)
    return bool(np.median(took) * 1000 < PROMISED_MS)


def sweep(resources: Resources, path: Path) -> None:
    """Time how long a sweep holds the lock: one that marks every row, and one that removes a thousand models."""
    clock = [0.0]
    sweeper = Sweeper(resources.database, resources.blobs, 0, threading.Event(), lambda: clock[0])
    began = time.perf_counter()
    with held() as took:
        sweeper.sweep()
    say("the lock, held by the first sweep's steps", took)
    sys.stdout.write(f"{'the first sweep in all':<46} {time.perf_counter() - began:.1f} s\n")
    with closing(sqlite3.connect(path)) as database:
        database.execute("UPDATE models SET deleted = 1, seen = ? WHERE number <= ?", (-2 * _DAY, DELETED))
        database.commit()
    began = time.perf_counter()
    with held() as took:
        assert sweeper.sweep().models == DELETED
    say(f"the lock, held while {DELETED} models go", took)
    sys.stdout.write(f"{'that sweep in all':<46} {time.perf_counter() - began:.1f} s\n")


def main() -> int:
    """Print the times; give 1 where the lock is held for longer than is promised."""
    short = True
    tracers = TracingPool(1, 20, 2048)
    for count in SIZES:
        with tempfile.TemporaryDirectory() as folder:
            database = Database(Path(folder)).of(LOCAL)
            database.migrate()
            blobs = open_blobs(database, Path(folder)).of(LOCAL)
            fill(database.path, count)
            resources = Resources(database, blobs, tracers, tracers, tracers, Uploads(Path(folder)))
            sys.stdout.write(f"{count} models, {database.path.stat().st_size / 1e6:.0f} MB\n")
            answer(database, count)
            short &= ask(resources)
            sweep(resources, database.path)
            database.close()
    tracers.close()
    return 0 if short else 1


if __name__ == "__main__":
    sys.exit(main())
