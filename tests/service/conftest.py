from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.running import FAR_LIMITS

from treestroke.service.photos import Resources
from treestroke.service.tracing_pool import TracingPool
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.uploads import Uploads


@pytest.fixture(scope="module")
def tracers() -> Iterator[TracingPool]:
    pool = TracingPool(1, FAR_LIMITS["trace_seconds"], 2048)
    yield pool
    pool.close()


@pytest.fixture
def resources(tmp_path: Path, database: Database, tracers: TracingPool) -> Resources:
    return Resources(database, Blobs(tmp_path), tracers, tracers, tracers, Uploads(tmp_path))
