"""The checks of chaos find what they are there to find."""

import pytest
from tests.chaos.__main__ import recoveries
from tests.chaos.asking import Asked
from tests.chaos.blows import Blow
from tests.chaos.invariants import doubled, lost
from tests.chaos.stack import Row, Team
from tests.faults.harness import Change

OAKS = Team("Oaks", "")


def row(id: str, status: str, attempt: int = 1, code: str = "") -> Row:
    error = {"code": code} if code else None
    return {"id": id, "status": status, "attempt": attempt, "error": error, "started": 10.0, "finished": 12.0}


@pytest.mark.parametrize(
    ("rows", "ids", "found"),
    [
        ([row("a", "succeeded")], ["a"], 0),
        ([], ["a"], 1),
        ([row("a", "canceled")], ["a"], 1),
        ([row("a", "failed", 3, "worker_lost")], ["a"], 0),
        ([row("a", "failed", 2, "worker_lost")], ["a"], 1),
        ([row("a", "failed", 1, "storage_full")], ["a"], 0),
        ([row("a", "failed", 1, "internal")], ["a"], 1),
    ],
    ids=["made", "gone", "canceled by nobody", "struck thrice", "given up early", "no room", "broken"],
)
def test_a_job_that_came_to_nothing_without_a_reason_is_found(rows: list[Row], ids: list[str], found: int) -> None:
    assert len(list(lost(rows, [Asked(OAKS, ids)]))) == found


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ([("queued", 0), ("running", 1), ("queued", 1), ("running", 2), ("succeeded", 2)], 0),
        ([("running", 1), ("succeeded", 1), ("running", 2), ("succeeded", 2)], 1),
        ([("running", 2), ("running", 1), ("succeeded", 1)], 1),
    ],
    ids=["twice begun", "twice ended", "backwards"],
)
def test_a_job_that_ends_twice_or_goes_back_is_found(changes: list[tuple[str, int]], found: int) -> None:
    seen = [Change(float(at), status, attempt) for at, (status, attempt) in enumerate(changes)]
    assert len(list(doubled([row("a", "succeeded")], [Asked(OAKS, ["a"])], {"a": seen}))) == found


def test_a_model_that_nobody_was_told_of_is_found() -> None:
    assert len(list(doubled([row("a", "succeeded"), row("b", "succeeded")], [Asked(OAKS, ["a"])], {}))) == 1


def test_recovery_is_the_time_from_the_last_blow_to_the_end_less_the_usual() -> None:
    rows = [row("a", "succeeded"), row("b", "succeeded", 3)]
    blows = [Blow("worker killed", at, at, {("b", attempt)}) for attempt, at in ((1, 20.0), (2, 30.0), (3, 36.0))]
    changes = {"b": [Change(40.0, "succeeded", 3)]}
    assert recoveries(rows, blows, changes) == [8.0]
