"""A service that is told to stop, as by a new version or Ctrl+C."""

import signal
import time
from concurrent.futures import ThreadPoolExecutor

import httpx
import pytest
from tests.faults.harness import LONGER, Service
from tests.faults.processes import wait_for

PROMISED_SECONDS = 12
POISONED = "tests.faults.poisoned_worker"


def follow(service: Service, id: str) -> str:
    with service.client.stream("GET", f"/v1/models/{id}/events", timeout=60) as stream:
        return "".join(stream.iter_text())


def test_a_stop_ends_streams_lets_a_short_job_finish_and_refuses_what_comes_later(service: Service) -> None:
    service.wait_for_workers(1)
    id = service.ask(**LONGER)
    service.wait_running(id)
    with ThreadPoolExecutor() as pool:
        stream = pool.submit(follow, service, id)
        time.sleep(0.3)
        assert service.stop(PROMISED_SECONDS) < PROMISED_SECONDS
        assert "event: snapshot" in stream.result(5)
    assert service.row(id)["status"] == "succeeded"
    with pytest.raises(httpx.ConnectError):
        service.client.get("/livez")
    service.start()


def test_a_stop_gives_a_long_job_back_and_the_next_worker_finishes_it(poisoned: Service) -> None:
    first = poisoned.workers()[0]
    first.hit(signal.SIGTERM)
    wait_for(lambda: not poisoned.workers(), 5, "the end of a worker that has nothing to do")
    stopping = poisoned.run(POISONED, TREESTROKE_MODEL_SECONDS=100)
    id = poisoned.ask("loop at first")
    poisoned.wait_running(id)
    began = time.monotonic()
    stopping.send_signal(signal.SIGTERM)
    poisoned.wait_until(id, lambda row: row["status"] == "queued", PROMISED_SECONDS)
    wait_for(lambda: not poisoned.workers(), PROMISED_SECONDS, "the worker's end")
    assert time.monotonic() - began < PROMISED_SECONDS
    poisoned.run(POISONED, TREESTROKE_WORKERS=2)
    (row,) = poisoned.finish([id])
    assert (row["status"], row["attempt"]) == ("succeeded", 2)
