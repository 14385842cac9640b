from collections.abc import Iterator

import pytest
from tests.faults.processes import wait_for
from tests.postgres import PostgresServer

from treestroke.store import leadership
from treestroke.store.leadership import Leadership, LeadLost


@pytest.fixture
def both(postgres_url: str) -> Iterator[tuple[Leadership, Leadership]]:
    """Two web processes on one database."""
    pair = Leadership(postgres_url), Leadership(postgres_url)
    yield pair
    for one in pair:
        one.release()


def test_where_the_database_is_a_file_its_only_web_process_leads() -> None:
    only = Leadership("")
    assert only.held()
    only.release()
    assert only.held()


def test_one_of_two_leads_until_it_ends(both: tuple[Leadership, Leadership]) -> None:
    first, second = both
    assert [one.held() for one in (first, second, first, second)] == [True, False, True, False]
    first.release()
    wait_for(second.held, 60, "the other one's lead")
    assert not first.held()


def test_one_that_stands_still_is_replaced_and_stands_by_when_it_goes_on(
    postgres_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    second = Leadership(postgres_url)
    assert leadership.IDLE_SECONDS < 10
    monkeypatch.setattr(leadership, "IDLE_SECONDS", 1)
    stopped = Leadership(postgres_url)
    assert stopped.held()
    wait_for(second.held, 60, "the other one's lead", every_s=0.2)
    with pytest.raises(LeadLost):
        stopped.held()
    assert not stopped.held()
    for one in (stopped, second):
        one.release()


def test_whoever_loses_the_database_loses_the_lead(
    postgres: PostgresServer, both: tuple[Leadership, Leadership]
) -> None:
    first, second = both
    assert first.held()
    postgres.stop()
    try:
        for one in (first, second):
            with pytest.raises(LeadLost):
                one.held()
    finally:
        postgres.start()
    assert [second.held(), first.held()] == [True, False]
