from tests.faults.chaos import torment
from tests.faults.harness import PATIENCE_SECONDS, Service
from tests.faults.processes import wait_for


def test_no_job_is_lost_or_made_twice_while_workers_are_killed_at_random(service: Service) -> None:
    """A short form of `make chaos`."""
    wait_for(service.workers, PATIENCE_SECONDS, "a worker to strike at")
    outcome = torment(service, seconds=7, jobs=6, seed=3)
    assert outcome.violations == []
    assert outcome.blows
