"""The clock on the wall: it is shown, and nothing waits by it."""

import time
from pathlib import Path

import pytest
from tests.rows import Messages, add_model, claim

from treestroke.service.dispatch import Dispatcher, record_heartbeat
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.tables import ModelRow, Worker

HOUR = 3600.0


@pytest.mark.parametrize("jump", [HOUR, -HOUR])
def test_a_clock_that_jumps_expires_no_lease_and_forgets_no_worker(
    database: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, jump: float
) -> None:
    queued = add_model(database)
    claim(database, queued)
    record_heartbeat(database, "worker", 1, "treestroke")
    dispatcher = Dispatcher(database, open_blobs(database, tmp_path), Messages(), 0)
    real = time.time
    for shift in (0.0, jump, 0.0):
        monkeypatch.setattr(time, "time", lambda shift=shift: real() + shift)
        dispatcher.lead()
        dispatcher.recover()
        dispatcher.dispatch()
    with database.reading() as session:
        job, worker = session.get(ModelRow, queued.number), session.get(Worker, "worker")
    assert job is not None
    assert (job.status, job.attempt) == ("running", 1)
    assert worker is not None
