"""Services that tests harm together: one a broker, with the promises checked when all have had their turn."""

from collections.abc import Iterator

import pytest
from tests.faults.harness import POISONED, Service
from tests.faults.redis_server import RedisServer, need_redis


@pytest.fixture(scope="package", params=["files", "redis"])
def broker(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[RedisServer | None]:
    """A Redis; nothing where the queue is a folder."""
    if request.param == "files":
        yield None
        return
    need_redis()
    server = RedisServer(tmp_path_factory.mktemp("broker") / "redis")
    try:
        yield server
    finally:
        server.kill()


@pytest.fixture(scope="package")
def broker_url(broker: RedisServer | None) -> str:
    return broker.url if broker else ""


@pytest.fixture(scope="package")
def service(broker_url: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """Web process and worker as `treestroke serve` starts them, but that jobs may be poisoned."""
    folder = tmp_path_factory.mktemp("service")
    with Service(folder, program=POISONED, broker_url=broker_url, workers=2, model_seconds=1) as service:
        service.wait_for_workers(1)
        yield service
        service.finish()
        service.check_invariants()
