"""A Redis that is gone, stands still or has forgotten everything: jobs are taken all the same, and none is lost."""

import signal
import time

import pytest
from tests.faults.harness import PATIENCE_SECONDS, Service
from tests.faults.processes import wait_for
from tests.faults.redis_server import RedisServer
from tests.promises import kept

from treestroke.worker import _LOOK_SECONDS as LOOK_SECONDS

pytestmark = pytest.mark.parametrize("broker", ["redis"], indirect=True)
PROMISED_SECONDS = 1.0


def ask_quickly(service: Service, number: int = 2, name: str = "instant") -> list[str]:
    """Ask for models, each answered within what is promised."""
    ids = []
    for _ in range(number):
        body = service.body(name)
        with kept(PROMISED_SECONDS):
            answer = service.client.post("/v1/models", json=body)
        assert answer.status_code == 202, answer.text
        ids.append(str(answer.json()["id"]))
    service.accepted += ids
    return ids


def wait_for_health(service: Service, status: str) -> None:
    wait_for(lambda: service.client.get("/readyz").json()["status"] == status, PATIENCE_SECONDS, status, 0.1)


def outcomes(service: Service, ids: list[str]) -> set[str]:
    return {row["status"] for row in service.finish(ids)}


def test_jobs_are_taken_while_redis_stands_still(service: Service, broker: RedisServer) -> None:
    service.body()  # the photo is there before
    broker.freeze()
    ids = ask_quickly(service)
    wait_for_health(service, "degraded")
    ids += ask_quickly(service)
    broker.thaw()
    assert outcomes(service, ids) == {"succeeded"}
    wait_for_health(service, "ok")


def test_jobs_are_taken_while_redis_is_gone_and_a_worker_that_starts_meanwhile_waits_for_it(
    service: Service, broker: RedisServer
) -> None:
    broker.kill()
    for process in service.workers():
        process.hit()
    ids = ask_quickly(service)
    wait_for_health(service, "degraded")
    begins = len(service.log())
    wait_for(lambda: "Cannot connect to redis" in service.log()[begins:], PATIENCE_SECONDS, "a worker that waits")
    broker.start()
    assert outcomes(service, ids) == {"succeeded"}
    wait_for_health(service, "ok")


def test_jobs_survive_a_redis_that_is_emptied(service: Service, broker: RedisServer) -> None:
    held, ids = ask_quickly(service, 2, "held instant"), ask_quickly(service)
    service.wait_running(held[0])
    broker.empty()
    service.release(*held)
    assert outcomes(service, held + ids) == {"succeeded"}


def test_jobs_survive_a_redis_that_comes_back_empty_while_one_is_being_grown(
    service: Service, broker: RedisServer
) -> None:
    held, ids = ask_quickly(service, 2, "held instant"), ask_quickly(service)
    service.wait_running(held[0])
    broker.kill()
    broker.start(empty=True)
    ids += ask_quickly(service)
    service.release(*held)
    rows = service.finish(held + ids)
    assert {(row["status"], row["attempt"]) for row in rows} == {("succeeded", 1)}


def test_a_stop_does_not_wait_for_a_redis_that_stands_still(service: Service, broker: RedisServer) -> None:
    broker.freeze()
    ids = ask_quickly(service)
    with kept(12.0):
        service.stop()
    broker.thaw()
    service.start()
    assert outcomes(service, ids) == {"succeeded"}


def test_a_worker_goes_on_that_could_not_tell_redis_what_it_took(service: Service, broker: RedisServer) -> None:
    """It has taken messages ahead, and begins with them while Redis is gone: it must ask for others afterwards."""
    held = ask_quickly(service, 2, "held instant")
    for id in held:
        service.wait_running(id)
    ids = ask_quickly(service)
    wait_for(lambda: broker.taken() == 2, PATIENCE_SECONDS, "messages that are taken ahead")
    broker.kill()
    begins = len(service.log())
    service.release(*held)
    wait_for(lambda: "Couldn't ack" in service.log()[begins:], PATIENCE_SECONDS, "a message that is begun with")
    service.finish(held)
    broker.start(empty=True)
    ids += ask_quickly(service)
    assert {row["attempt"] for row in service.finish(ids)} == {1}
    assert service.logged("worker_deaf") == []


def test_a_worker_that_takes_no_messages_any_more_is_ended_and_started_again(service: Service) -> None:
    held = ask_quickly(service, 1, "held instant")
    service.wait_running(held[0])
    (deaf,) = service.workers()
    deaf.hit(signal.SIGUSR2)
    ids = ask_quickly(service)
    time.sleep(3 * LOOK_SECONDS)
    assert service.workers() == [deaf]  # it has a job, and takes no other for a good reason
    service.release(*held)
    assert {row["attempt"] for row in service.finish(held + ids)} == {1}
    assert [line["worker"] for line in service.logged("worker_deaf")] == [service.name_of(deaf)]
    assert service.workers() != [deaf]
