"""Services that tests harm together: one a broker, with the promises checked when all have had their turn."""

from collections.abc import Iterator

import pytest
from tests.faults.harness import Service
from tests.faults.redis_server import RedisServer, need_redis


@pytest.fixture(scope="session", params=["files", "redis"])
def broker_url(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    if request.param == "files":
        yield ""
        return
    need_redis()
    server = RedisServer(tmp_path_factory.mktemp("broker") / "redis")
    try:
        yield server.url
    finally:
        server.kill()


@pytest.fixture(scope="session")
def service(broker_url: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """Web process and worker as `treestroke serve` starts them."""
    with Service(tmp_path_factory.mktemp("service"), broker_url=broker_url) as service:
        service.wait_for_workers(1)
        yield service
        service.finish()
        service.check_invariants()


@pytest.fixture(scope="session")
def poisoned(broker_url: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A web process, and beside it a worker for two models that knows poisoned jobs."""
    folder = tmp_path_factory.mktemp("poisoned")
    # On a Redis they take turns: the messages of one service mean nothing to the other.
    with Service(folder, broker_url=broker_url.replace("/0", "/1"), workers=0, model_seconds=7) as service:
        service.run("tests.faults.poisoned_worker", TREESTROKE_WORKERS=2)
        service.wait_for_workers(1)
        yield service
        service.finish()
        service.check_invariants()
