"""Jobs that are to be stopped, at every moment of their lives."""

import random
import time

from tests.faults.harness import Service


def cancel(service: Service, id: str) -> str:
    answer = service.client.post(f"/v1/models/{id}/cancel")
    assert answer.status_code == 200
    return str(answer.json()["status"])


def test_a_job_that_waits_is_canceled_at_once(poisoned: Service) -> None:
    ids = [poisoned.ask("slow") for _ in range(2)]
    for id in ids:
        poisoned.wait_running(id)
    third = poisoned.ask("slow")
    assert cancel(poisoned, third) == "canceled"
    assert cancel(poisoned, third) == "canceled"
    assert [cancel(poisoned, id) for id in ids] == ["running", "running"]
    began = time.monotonic()
    assert [row["status"] for row in poisoned.finish(ids, 2)] == ["canceled", "canceled"]
    assert time.monotonic() - began < 2


def test_a_real_job_under_way_is_canceled_within_two_seconds(service: Service) -> None:
    id = service.ask(iterations=2000, foliage="leaves")
    service.wait_running(id)
    assert [cancel(service, id), cancel(service, id)] == ["running", "running"]
    (row,) = service.finish([id], 2)
    assert row["status"] == "canceled"


def test_a_finished_model_stays_as_it_is(service: Service) -> None:
    id = service.ask()
    service.finish([id])
    before = service.row(id)
    assert cancel(service, id) == "succeeded"
    assert service.row(id) == before


def test_a_cancel_in_the_last_moment_never_leaves_both(poisoned: Service) -> None:
    """What came of each is read from the files too, when the service's promises are checked."""
    chance = random.Random(1)
    ends = []
    for _ in range(24):
        id = poisoned.ask("instant")
        time.sleep(chance.uniform(0, 0.4))
        cancel(poisoned, id)
        (row,) = poisoned.finish([id], 5)
        ends.append(row["status"])
    assert {"canceled", "succeeded"} == set(ends)
