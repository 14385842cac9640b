from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.running import FAR_LIMITS
from tests.sweeping import Clocks, Kept

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


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kept]:
    opened = Kept(tmp_path, Clocks(monkeypatch))
    yield opened
    opened.database.close()


@pytest.fixture(params=["folder", "bucket"])
def anywhere(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Kept]:
    """A store whose blobs are in a folder, or in a bucket."""
    url = request.getfixturevalue("bucket_url") if request.param == "bucket" else ""
    opened = Kept(tmp_path, Clocks(monkeypatch), url)
    yield opened
    opened.database.close()
