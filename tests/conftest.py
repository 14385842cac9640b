"""Real photos for all tests."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from treestroke.service.execution import one_thread
from treestroke.store.database import Database

EXAMPLES = Path(__file__).parents[1] / "examples"
DATA = Path(__file__).parent / "data"


@pytest.fixture(scope="session", autouse=True)
def _as_the_service_computes() -> Iterator[None]:
    with one_thread():
        yield


@pytest.fixture
def database(tmp_path: Path) -> Iterator[Database]:
    """An empty database with its tables."""
    opened = Database(tmp_path)
    opened.migrate()
    yield opened
    opened.close()


@pytest.fixture(scope="session")
def maple_photo() -> Path:
    return EXAMPLES / "sugar_maple_autumn.jpg"


@pytest.fixture(scope="session")
def maple_strokes() -> Path:
    return EXAMPLES / "sugar_maple_autumn.strokes.json"
