"""Processes that die in the middle of a job: `kill -9`, each in its turn."""

import socket
from concurrent.futures import ThreadPoolExecutor

import httpx
from sqlalchemy import delete
from tests import promises
from tests.faults.harness import PATIENCE_SECONDS, Service
from tests.faults.processes import wait_for
from tests.promises import kept
from tests.rows import add_model

from treestroke.service.dispatch import record_heartbeat
from treestroke.store.database import Database
from treestroke.store.leases import heartbeat
from treestroke.store.scope import LOCAL
from treestroke.store.tables import ModelRow, Worker

AGAIN_SECONDS = 30
"""A lost job is ready again within this, with its own time of about a second."""


def test_a_job_whose_process_dies_is_grown_again(service: Service) -> None:
    id = service.ask("held at first")
    service.wait_running(id)
    with kept(AGAIN_SECONDS):
        for grower in service.growers():
            grower.hit()
        (row,) = service.finish([id])
    assert (row["status"], row["attempt"]) == ("succeeded", 2)


def test_a_job_whose_worker_dies_with_its_child_is_grown_again(service: Service) -> None:
    id, expired = service.ask("held at first"), len(service.logged("attempt_lost"))
    service.wait_running(id)
    with kept(AGAIN_SECONDS):
        for process in service.workers() + service.growers():
            process.hit()
        (row,) = service.finish([id])
    assert (row["status"], row["attempt"]) == ("succeeded", 2)
    # The next run gives it back before its lease runs out, where it starts as fast as it does on a quiet machine.
    assert len(service.logged("attempt_lost")) == expired or not promises.checked


def test_a_worker_that_starts_judges_nobody_by_host_and_process_number(service: Service) -> None:
    """As where two containers have one name: the other's process 1 is nobody's here, and lives all the same."""
    service.finish()
    here = wait_for(service.workers, PATIENCE_SECONDS, "a worker")[0]
    database, name = Database(service.data).of(LOCAL), f"{socket.gethostname()}/{2**22 - 1}/abcd"
    record_heartbeat(database, name, 1, "treestroke")
    held = add_model(database, status="running", attempt=1, worker=name, claim="token", settings={})
    here.hit()

    def another() -> bool:
        """Tell whether another worker is ready; whoever holds the job goes on meanwhile."""
        record_heartbeat(database, name, 1, "treestroke")
        with database.writing() as session:
            heartbeat(session, held, None, 0.0, 0.0)
        return any(one.pid != here.pid and service.name_of(one) for one in service.workers())

    try:
        wait_for(another, PATIENCE_SECONDS, "another worker", every_s=0.5)
        row = service.row(held.id)
        assert (row["status"], row["worker"], row["attempt"]) == ("running", name, 1)
    finally:  # a model whose files do not exist breaks what is promised of all
        with database.writing() as session:
            session.execute(delete(ModelRow).where(ModelRow.id == held.id))
            session.execute(delete(Worker).where(Worker.id == name))
        database.close()


def test_a_worker_that_dies_leaves_no_process_behind(service: Service) -> None:
    service.finish()
    worker = wait_for(service.workers, PATIENCE_SECONDS, "a worker")[0]
    left = service.growers(worker)
    worker.hit()
    with kept(3.0):
        wait_for(
            lambda: not {one.pid for one in left} & {one.pid for one in service.alive()},
            PATIENCE_SECONDS,
            "its children's end",
        )
    service.wait_for_workers(1)


def test_requests_wait_while_the_web_process_is_replaced_and_only_those_it_had_begun_are_cut_off(
    service: Service,
) -> None:
    id = service.ask("held")
    service.wait_running(id)
    web = service.web()
    assert web is not None
    with ThreadPoolExecutor(3) as pool:
        begun = [pool.submit(answer_or_cut, service) for _ in range(3)]
        web.hit()
        wait_for(lambda: web.pid not in {one.pid for one in service.alive()}, PATIENCE_SECONDS, "its end")
        assert service.client.get("/livez").status_code == 200
        assert {upload.result() for upload in begun} <= {"taken", "cut off"}
    assert answer_or_cut(service) == "taken"
    service.release(id)
    (row,) = service.finish([id])
    assert (row["status"], row["attempt"]) == ("succeeded", 1)


def answer_or_cut(service: Service) -> str:
    try:
        service.upload()
    except httpx.TransportError:
        return "cut off"
    return "taken"


def test_all_processes_end_with_a_launcher_that_dies_and_the_next_one_finishes_their_jobs(service: Service) -> None:
    ids = service.ask_for(2, "held at first")
    service.wait_running(ids[0])
    launcher = service.launcher
    assert launcher is not None
    launcher.kill()
    launcher.wait()
    wait_for(lambda: not service.alive(), PATIENCE_SECONDS, "the end of its children")
    service.start()
    assert [row["status"] for row in service.finish(ids)] == ["succeeded", "succeeded"]
