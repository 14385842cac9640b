from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.running import FAR_LIMITS

from treestroke.service.photos import Resources
from treestroke.service.tracing_pool import TracingPool
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.scope import LOCAL
from treestroke.store.upload_pieces import open_uploads


@pytest.fixture(scope="module")
def tracers() -> Iterator[TracingPool]:
    pool = TracingPool(1, FAR_LIMITS["trace_seconds"], 2048)
    yield pool
    pool.close()


@pytest.fixture
def resources(tmp_path: Path, database: Database, tracers: TracingPool) -> Resources:
    blobs = open_blobs(database, tmp_path)
    made = Resources(database, blobs, tracers, tracers, tracers, open_uploads(database, blobs))
    return made.of(LOCAL)
