"""What a team may have is counted where it is written: many at once do not pass a quota together."""

import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy.orm import Session
from tests.plans import planned, scans
from tests.rows import add_capture, add_model, add_solve, model_row, photo_row

from treestroke.service.quotas import (
    DAY_SECONDS,
    NO_QUOTAS,
    QuotaExceeded,
    Quotas,
    admit_job,
    admit_model,
    admit_upload,
    quotas_of,
    used_by_team,
)
from treestroke.settings import Settings
from treestroke.store.database import Database
from treestroke.store.scope import Scope
from treestroke.store.tables import File, Table

OAKS, ELMS = Scope("oaks", "usr_ann"), Scope("elms", "usr_ben")
AT_ONCE = 6
"""Requests at the same time; fewer than a database has connections."""


@pytest.fixture(params=["sqlite", "postgres"])
def shared(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Database]:
    """A database of each kind, without a scope."""
    url = request.getfixturevalue("postgres_url") if request.param == "postgres" else ""
    database = Database(tmp_path, url)
    database.migrate()
    yield database
    database.close()


def admitted(database: Database, write: Callable[[Session, int], Table], times: int) -> list[str]:
    """Write rows from many threads, and give the quotas that refused some."""

    def attempt(number: int) -> str | None:
        try:
            with database.writing() as session:
                session.add(write(session, number))
        except QuotaExceeded as error:
            return error.quota
        return None

    with ThreadPoolExecutor(AT_ONCE) as threads:
        return [refused for refused in threads.map(attempt, range(times)) if refused]


def used(database: Database, name: str, quotas: Quotas = NO_QUOTAS) -> int:
    with database.reading() as session:
        return next(one.used for one in used_by_team(session, quotas) if one.name == name)


@pytest.mark.parametrize(
    ("quotas", "refused"), [(Quotas(queued=5), "queued"), (Quotas(models_a_day=5), "models_a_day")]
)
def test_twenty_requests_at_once_do_not_pass_a_quota_of_models_together(
    shared: Database, quotas: Quotas, refused: str
) -> None:
    def write(session: Session, _: int) -> Table:
        admit_model(session, quotas)
        return model_row()

    assert admitted(shared.of(OAKS), write, 20) == [refused] * 15
    assert used(shared.of(OAKS), refused) == 5
    assert admitted(shared.of(ELMS), write, 5) == []


def test_twenty_photos_at_once_do_not_pass_the_stored_bytes_together(shared: Database) -> None:
    def write(session: Session, number: int) -> Table:
        admit_upload(session, Quotas(stored_bytes=59), 10)
        return photo_row(f"{number:064}", 10)

    assert admitted(shared.of(OAKS), write, 20) == ["stored_bytes"] * 15
    assert used(shared.of(OAKS), "stored_bytes") == 50
    assert admitted(shared.of(ELMS), write, 5) == []


def test_files_of_models_count_among_the_stored_bytes_and_without_room_no_model_is_taken(shared: Database) -> None:
    oaks = shared.of(OAKS)
    model = add_model(oaks, status="succeeded")
    with oaks.writing() as session:
        session.add(File(model=model.id, name="tree.glb", blob="c" * 64, bytes=90))
        session.add(photo_row("d" * 64, 10))
    assert used(oaks, "stored_bytes") == 100
    for write in (admit_model, lambda session, quotas: admit_upload(session, quotas, 1)):
        with pytest.raises(QuotaExceeded, match="stored_bytes"), oaks.writing() as session:
            write(session, Quotas(stored_bytes=100))
    with oaks.writing() as session:
        admit_model(session, Quotas(stored_bytes=101))


def test_what_waits_is_models_and_captures_and_what_is_finished_at_once_does_not(shared: Database) -> None:
    oaks = shared.of(OAKS)
    add_model(oaks)
    add_model(oaks, status="running")
    add_solve(oaks, add_capture(oaks).id)
    full = Quotas(queued=2)
    for write in (admit_model, admit_job):
        with pytest.raises(QuotaExceeded) as refused, oaks.writing() as session:
            write(session, full)
        assert refused.value.quota == "queued"
        assert refused.value.retry_s > 0
    with oaks.writing() as session:
        admit_model(session, full, waits=False)
    assert (used(oaks, "queued"), used(oaks, "running")) == (2, 1)


def test_deleted_models_count_for_their_day_and_the_oldest_says_when_there_is_room(shared: Database) -> None:
    oaks, now = shared.of(OAKS), time.time()
    add_model(oaks, created=now - DAY_SECONDS - 60)
    add_model(oaks, created=now - DAY_SECONDS + 3600, deleted=now)
    add_model(oaks, created=now)
    with pytest.raises(QuotaExceeded) as refused, oaks.writing() as session:
        admit_model(session, Quotas(models_a_day=2))
    assert refused.value.retry_s == pytest.approx(3600, abs=300)
    with oaks.writing() as session:
        admit_model(session, Quotas(models_a_day=3))


def test_a_service_of_one_person_has_no_quotas() -> None:
    assert quotas_of(Settings(team_queued=1)) == NO_QUOTAS
    assert quotas_of(Settings(database_url=f"postgresql:{'//'}x/y", team_queued=7, team_stored_mb=3)) == Quotas(
        stored_bytes=3_000_000, queued=7, running=2, models_a_day=500
    )


def test_no_quota_reads_a_whole_table(database: Database) -> None:
    with planned() as steps, database.reading() as session:
        used_by_team(session, NO_QUOTAS)
    assert len(steps) > 5
    assert scans(steps) == []
    assert any("COVERING INDEX ix_files_team" in step for step in steps)
