"""Workers that stand still past their lease and come back: what they made in the meantime counts no more."""

import signal
from pathlib import Path

from tests.faults.harness import PATIENCE_SECONDS, Row, Service
from tests.faults.processes import Process, wait_for


def test_a_worker_that_comes_back_after_its_lease_changes_nothing(broker_url: str, tmp_path: Path) -> None:
    """Takes over 20 s: a lease runs out, and four workers are started."""
    with Service(tmp_path / "service", broker_url=broker_url.replace("/0", "/2"), workers=0) as service:
        for _ in range(3):
            service.run("tests.faults.poisoned_worker", TREESTROKE_WORKERS=1)
        service.wait_for_workers(3)
        ids = [service.ask("held at first") for _ in range(3)]
        child_stops, group_stops, group_dies = (group_of(service, service.wait_running(id)) for id in ids)
        frozen = [child_stops[1], *group_stops]
        service.freeze(frozen)
        for process in group_dies:
            process.hit()
        service.run("tests.faults.poisoned_worker", TREESTROKE_WORKERS=1)
        rows = service.finish(ids)
        assert [(row["status"], row["attempt"]) for row in rows] == [("succeeded", 2)] * 3
        for process in frozen:
            process.hit(signal.SIGCONT)
        wait_for(
            lambda: len(service.logged("job_superseded")) == 2,
            PATIENCE_SECONDS,
            "two attempts that find themselves too late",
        )
        assert [service.row(id) for id in ids] == rows
        service.check_invariants()


def group_of(service: Service, row: Row) -> list[Process]:
    """Give the worker that has a job, and its child."""
    worker = next(one for one in service.workers() if service.name_of(one) == row["worker"])
    return [worker, *service.growers(worker)]
