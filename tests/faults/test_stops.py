"""A service that is told to stop, as by a new version or Ctrl+C."""

import signal
from concurrent.futures import ThreadPoolExecutor
from threading import Event

import httpx
import pytest
from tests.faults.harness import PATIENCE_SECONDS, Service
from tests.faults.processes import wait_for
from tests.promises import kept

PROMISED_SECONDS = 12.0


def follow(service: Service, id: str, begun: Event) -> str:
    told = ""
    with service.client.stream("GET", f"/v1/models/{id}/events") as stream:
        for part in stream.iter_text():
            told += part
            begun.set()
    return told


def test_a_stop_ends_streams_lets_a_short_job_finish_and_refuses_what_comes_later(service: Service) -> None:
    service.wait_for_workers(1)
    id, begun = service.ask("held instant"), Event()
    service.wait_running(id)
    with ThreadPoolExecutor() as pool:
        stream = pool.submit(follow, service, id, begun)
        assert begun.wait(PATIENCE_SECONDS)
        assert service.launcher is not None
        with kept(PROMISED_SECONDS):
            service.launcher.send_signal(signal.SIGTERM)
            service.release(id)
            service.stop()
        assert "event: snapshot" in stream.result(PATIENCE_SECONDS)
    assert service.row(id)["status"] == "succeeded"
    with pytest.raises(httpx.ConnectError):
        service.client.get("/livez")
    service.start()


def test_a_stop_gives_a_long_job_back_and_the_next_worker_finishes_it(service: Service) -> None:
    id = service.ask("held at first")
    service.wait_running(id)
    (worker,) = service.workers()
    worker.hit(signal.SIGTERM)
    with kept(PROMISED_SECONDS):
        service.wait_until(id, lambda row: row["status"] == "queued" or row["attempt"] == 2)
        wait_for(lambda: worker.pid not in {one.pid for one in service.alive()}, PATIENCE_SECONDS, "the worker's end")
    (row,) = service.finish([id])
    assert (row["status"], row["attempt"]) == ("succeeded", 2)
