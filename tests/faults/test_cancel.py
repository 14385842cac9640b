"""Jobs that are to be stopped, at every moment of their lives."""

import random
import time

from tests.faults.harness import ENDLESS, Service
from tests.promises import kept

PROMISED_SECONDS = 2.0
"""From a cancel to the job's end."""


def cancel(service: Service, id: str) -> str:
    answer = service.client.post(f"/v1/models/{id}/cancel")
    assert answer.status_code == 200
    return str(answer.json()["status"])


def test_a_job_that_waits_is_canceled_at_once(service: Service) -> None:
    ids = service.ask_for(2, "held")
    for id in ids:
        service.wait_running(id)
    third = service.ask("held")
    assert cancel(service, third) == "canceled"
    assert cancel(service, third) == "canceled"
    assert [cancel(service, id) for id in ids] == ["running", "running"]
    with kept(PROMISED_SECONDS):
        assert [row["status"] for row in service.finish(ids)] == ["canceled", "canceled"]


def test_a_real_job_under_way_is_canceled_within_two_seconds(service: Service) -> None:
    id = service.ask(**ENDLESS)
    service.wait_running(id)
    assert cancel(service, id) == "running"
    assert cancel(service, id) in ("running", "canceled")  # it may have ended meanwhile
    with kept(PROMISED_SECONDS):
        (row,) = service.finish([id])
    assert row["status"] == "canceled"


def test_a_finished_model_stays_as_it_is(service: Service) -> None:
    id = service.ask("instant")
    service.finish([id])
    before = service.row(id)
    assert cancel(service, id) == "succeeded"
    assert service.row(id) == before


def test_a_cancel_in_the_last_moment_never_leaves_both(service: Service) -> None:
    """What came of each is read from the files too, when the service's promises are checked."""
    chance, began = random.Random(1), time.monotonic()
    service.finish([service.ask("instant")])
    usual_s = time.monotonic() - began
    for _ in range(24):
        id = service.ask("instant")
        time.sleep(chance.uniform(0, 1.5 * usual_s))
        cancel(service, id)
        (row,) = service.finish([id])
        assert row["status"] in ("canceled", "succeeded")
