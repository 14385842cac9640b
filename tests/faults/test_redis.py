"""A Redis that is gone, stands still or has forgotten everything: jobs are taken all the same, and none is lost."""

import time
from collections.abc import Iterator
from dataclasses import dataclass

import pytest
from tests.faults.harness import LONGER, Service
from tests.faults.processes import wait_for
from tests.faults.redis_server import RedisServer, need_redis

PROMISED_SECONDS = 1.0


@dataclass(frozen=True)
class Pair:
    service: Service
    redis: RedisServer


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Pair]:
    need_redis()
    folder = tmp_path_factory.mktemp("pair")
    redis = RedisServer(folder / "redis")
    try:
        with Service(folder, broker_url=redis.url) as service:
            service.wait_for_workers(1)
            yield Pair(service, redis)
            service.finish()
            service.check_invariants()
    finally:
        redis.kill()


def ask_quickly(service: Service, number: int = 2, **settings: object) -> list[str]:
    """Ask for models, each answered within what is promised."""
    ids = []
    for _ in range(number):
        body, began = service.body(**settings), time.monotonic()
        answer = service.client.post("/v1/models", json=body)
        took = time.monotonic() - began
        assert (answer.status_code, took < PROMISED_SECONDS) == (202, True), took
        ids.append(str(answer.json()["id"]))
    service.accepted += ids
    return ids


def wait_for_health(service: Service, status: str) -> None:
    wait_for(lambda: service.client.get("/readyz").json()["status"] == status, 15, f"/readyz to say {status}", 0.1)


def outcomes(service: Service, ids: list[str]) -> set[str]:
    return {row["status"] for row in service.finish(ids, 40)}


def test_jobs_are_taken_while_redis_stands_still(pair: Pair) -> None:
    pair.redis.freeze()
    ids = ask_quickly(pair.service)
    wait_for_health(pair.service, "degraded")
    ids += ask_quickly(pair.service)
    pair.redis.thaw()
    assert outcomes(pair.service, ids) == {"succeeded"}
    wait_for_health(pair.service, "ok")


def test_jobs_are_taken_while_redis_is_gone_and_a_worker_that_starts_meanwhile_waits_for_it(pair: Pair) -> None:
    pair.redis.kill()
    for process in pair.service.workers():
        process.hit()
    ids = ask_quickly(pair.service)
    wait_for_health(pair.service, "degraded")
    time.sleep(4)
    pair.redis.start()
    assert outcomes(pair.service, ids) == {"succeeded"}
    wait_for_health(pair.service, "ok")


def test_jobs_survive_a_redis_that_is_emptied(pair: Pair) -> None:
    ids = ask_quickly(pair.service, 4, **LONGER)
    pair.service.wait_running(ids[0])
    pair.redis.empty()
    assert outcomes(pair.service, ids) == {"succeeded"}


def test_jobs_survive_a_redis_that_comes_back_empty_while_one_is_being_grown(pair: Pair) -> None:
    ids = ask_quickly(pair.service, 4, **LONGER)
    pair.service.wait_running(ids[0])
    pair.redis.kill()
    pair.redis.start(empty=True)
    ids += ask_quickly(pair.service)
    rows = pair.service.finish(ids, 40)
    assert {(row["status"], row["attempt"]) for row in rows} == {("succeeded", 1)}


def test_a_stop_does_not_wait_for_a_redis_that_stands_still(pair: Pair) -> None:
    pair.redis.freeze()
    ids = ask_quickly(pair.service)
    assert pair.service.stop() < 12
    pair.redis.thaw()
    pair.service.start()
    assert outcomes(pair.service, ids) == {"succeeded"}
