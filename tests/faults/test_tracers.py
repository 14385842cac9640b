"""Tracing processes that are gone or cannot be started: the service says so, and goes on when it can."""

import os
import resource
import shutil
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
from tests.faults.harness import PATIENCE_SECONDS, Service, small_tree
from tests.faults.processes import Process, wait_for


def upload(service: Service, client: httpx.Client) -> httpx.Response:
    return client.post("/v1/photos", content=small_tree()[0], headers={"content-type": "image/png"})


def web_of(service: Service) -> Process:
    web = service.web()
    assert web is not None
    return web


def kill_below(service: Service, web: Process) -> None:
    """Kill all that the web process has started, and what those have."""
    doomed, parents = set[int](), {web.pid}
    while found := {one.pid for one in service.alive() if one.parent in parents} - doomed:
        doomed |= found
        parents |= found
    for one in service.alive():
        if one.pid in doomed:
            one.hit()
    wait_for(lambda: not doomed & {one.pid for one in service.alive()}, PATIENCE_SECONDS, "their end")


@contextmanager
def no_descriptors(web: Process) -> Iterator[None]:
    """Let the web process open nothing more, as with many connections."""
    before = resource.prlimit(web.pid, resource.RLIMIT_NOFILE)
    taken = {int(name) for name in os.listdir(f"/proc/{web.pid}/fd")}
    # The lowest that is free is the one that would be given next.
    resource.prlimit(web.pid, resource.RLIMIT_NOFILE, (min(set(range(len(taken) + 1)) - taken), before[1]))
    try:
        yield
    finally:
        resource.prlimit(web.pid, resource.RLIMIT_NOFILE, before)


def test_tracers_that_are_killed_with_all_that_starts_them_are_started_again(service: Service) -> None:
    service.upload()
    for place in (service.data / "tmp").iterdir():
        shutil.rmtree(place)
    kill_below(service, web_of(service))
    for _ in range(2):
        answer = upload(service, service.client)
        assert answer.status_code == 201, answer.text


def test_without_descriptors_uploads_are_to_come_again_and_then_succeed(service: Service) -> None:
    service.upload()
    web = web_of(service)
    with httpx.Client(base_url=service.client.base_url, timeout=PATIENCE_SECONDS, trust_env=False) as client:
        assert client.get("/readyz").json()["checks"]["tracers"] == "ok"  # and its connection stays
        for _ in range(3):
            with no_descriptors(web):
                kill_below(service, web)
                answer = upload(service, client)
                assert (answer.status_code, answer.json()["code"]) == (503, "tracing_unavailable"), answer.text
                assert answer.headers["retry-after"] == "1"
                assert "Too many open files" in client.get("/readyz").json()["checks"]["tracers"]
            assert upload(service, client).status_code == 201
        wait_for(lambda: client.get("/readyz").json()["status"] == "ok", PATIENCE_SECONDS, "it to be well")
