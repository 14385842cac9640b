"""Real photos for all tests, and the order in which several processes run them."""

from collections.abc import Iterator
from pathlib import Path

import hypothesis
import pytest
from tests import promises
from tests.postgres import PostgresServer, running_postgres
from xdist.scheduler import LoadFileScheduling

from treestroke.service.execution import one_thread
from treestroke.store.database import Database
from treestroke.store.scope import LOCAL

pytest_plugins = ["tests.bucket"]
EXAMPLES = Path(__file__).parents[1] / "examples"
DATA = Path(__file__).parent / "data"

FIRST = ("tests/api/test_events.py", "tests/faults/", "tests/test_installed.py", "tests/api/")
"""What takes longest from its beginning to its end, mostly by waiting: the tests of one service, one after another."""

NO_SHARED_SERVICE = tuple(
    f"tests/api/test_{name}.py"
    for name in (
        "schemathesis",
        "connections",
        "following",
        "limits",
        "bucket",
        "rates",
        "request_counts",
        "stream_places",
        "teams",
        "audit",
    )
)


class Scheduling(LoadFileScheduling):
    """Keeps in one process what shares services: a file's tests, those that harm one broker's, and those of the API."""

    def _split_scope(self, nodeid: str) -> str:
        file = str(super()._split_scope(nodeid))
        if file.startswith("tests/faults/") and nodeid.endswith(("[files]", "[redis]")):
            return nodeid.rpartition("[")[2]
        return "tests/api" if file.startswith("tests/api/") and file not in NO_SHARED_SERVICE else file


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> Scheduling:
    return Scheduling(config, log)  # type: ignore[arg-type]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--promises", action="store_true", help="check what is promised in seconds, on a quiet machine")


def pytest_configure(config: pytest.Config) -> None:
    promises.checked = config.getoption("--promises")
    slow = [hypothesis.HealthCheck.too_slow]
    hypothesis.settings.register_profile("busy", hypothesis.settings(), deadline=None, suppress_health_check=slow)
    hypothesis.settings.load_profile("busy")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Let what takes longest begin first."""

    def place(item: pytest.Item) -> int:
        return next((at for at, path in enumerate(FIRST) if item.nodeid.startswith(path)), len(FIRST))

    items.sort(key=place)


@pytest.fixture(scope="session", autouse=True)
def _as_the_service_computes() -> Iterator[None]:
    with one_thread():
        yield


@pytest.fixture
def database_kind() -> str:
    """SQLite, unless what tests the store asks for both kinds."""
    return "sqlite"


@pytest.fixture
def database(tmp_path: Path, database_kind: str, request: pytest.FixtureRequest) -> Iterator[Database]:
    """An empty database with its tables."""
    url = request.getfixturevalue("postgres").fresh_with_tables() if database_kind == "postgres" else ""
    opened = Database(tmp_path, url).of(LOCAL)
    opened.migrate()
    yield opened
    opened.close()


@pytest.fixture(scope="session")
def postgres() -> Iterator[PostgresServer]:
    """A Postgres of this process; a test that stops it starts it again."""
    with running_postgres() as server:
        yield server


@pytest.fixture
def postgres_url(postgres: PostgresServer) -> str:
    """The URL of an empty database that nobody else uses."""
    return postgres.fresh()


@pytest.fixture(scope="session")
def maple_photo() -> Path:
    return EXAMPLES / "sugar_maple_autumn.jpg"


@pytest.fixture(scope="session")
def maple_strokes() -> Path:
    return EXAMPLES / "sugar_maple_autumn.strokes.json"
