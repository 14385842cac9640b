"""Jobs that harm the process that grows them: each ends as it should, and its neighbours never notice."""

import json

from tests.faults.harness import Row, Service


def code(row: Row) -> str | None:
    return json.loads(row["error"])["code"] if row["error"] else None


def test_poisoned_jobs_end_and_their_neighbours_succeed(service: Service) -> None:
    names = ["segfault", "memory", "loop", "hang", "deaf", "dies before the commit", "dies after the commit", "", ""]
    ids = [service.ask(name) for name in names]
    rows = service.finish(ids)
    assert [(row["status"], code(row), row["attempt"]) for row in rows] == [
        ("failed", "worker_lost", 3),
        ("failed", "out_of_memory", 1),
        ("failed", "time_limit", 1),
        ("failed", "time_limit", 1),
        ("failed", "time_limit", 1),
        ("succeeded", None, 2),
        ("succeeded", None, 1),
        ("succeeded", None, 1),
        ("succeeded", None, 1),
    ]


def test_a_worker_whose_children_were_killed_takes_the_next_job(service: Service) -> None:
    rows = service.finish(service.ask_for(3))
    assert [(row["status"], row["attempt"]) for row in rows] == [("succeeded", 1)] * 3
