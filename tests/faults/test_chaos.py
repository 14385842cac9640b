from tests.faults.chaos import torment
from tests.faults.harness import Service


def test_no_job_is_lost_or_made_twice_while_workers_are_killed_at_random(service: Service) -> None:
    outcome = torment(service, seconds=12, jobs=12, seed=3)
    assert outcome.violations == []
    assert outcome.blows
