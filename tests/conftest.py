"""Real photos for all tests."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from xdist.remote import Producer
from xdist.scheduler import LoadScopeScheduling

from treestroke.service.threads import one_thread
from treestroke.store.database import Database

EXAMPLES = Path(__file__).parents[1] / "examples"
DATA = Path(__file__).parent / "data"
LONGEST_FIRST = (
    "tests/faults/",
    "tests/api/test_schemathesis.py",
    "tests/core/grow/test_reference.py",
    "tests/core/pipeline/",
    "tests/api/",
    "tests/service/",
    "tests/test_",
)


class ByService(LoadScopeScheduling):
    """Tests that share a running service go to one process: the API's; faults by file and broker; else by file.

    To start one costs seconds of a processor; tests of faults wait more than they work.
    """

    def _split_scope(self, nodeid: str) -> str:
        path, _, name = nodeid.partition("::")
        if path.startswith("tests/faults/"):
            return path + name[name.find("[") :] if "[" in name else path
        return "api" if path.startswith("tests/api/") and "schemathesis" not in path else path


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> ByService:
    config.option.loadscopereorder = False  # by number of tests, when it is the few that take long
    return ByService(config, log)


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes long, so that no process waits for another at the end."""

    def place(item: pytest.Item) -> int:
        return next((at for at, path in enumerate(LONGEST_FIRST) if item.nodeid.startswith(path)), len(LONGEST_FIRST))

    items.sort(key=place)


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
