"""Removal of blobs while others store them, on both databases; and that a sweep of many stays in small steps."""

import hashlib
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from sqlalchemy import update
from sqlalchemy.orm import Session
from tests.plans import planned, scans

from treestroke.service import unreferenced
from treestroke.service.unreferenced import BlobSweeper
from treestroke.store.blobs import Blobs, insert_blobs, open_blobs
from treestroke.store.database import Database
from treestroke.store.objects import FolderObjects
from treestroke.store.scope import LOCAL, SERVICE
from treestroke.store.tables import BlobRow

CONTENTS = [b"%d" % at for at in range(20)]
NAMES = [hashlib.sha256(content).hexdigest() for content in CONTENTS]


@pytest.fixture(params=["sqlite", "postgres"])
def database_kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def blobs(database: Database, tmp_path: Path) -> Blobs:
    return open_blobs(database, tmp_path).of(LOCAL)


def sweeper_of(database: Database, blobs: Blobs) -> BlobSweeper:
    return BlobSweeper(database.of(SERVICE), blobs, threading.Event())


def test_a_blob_that_is_stored_again_while_it_is_removed_survives(database: Database, blobs: Blobs) -> None:
    """Sweepers hold names that were to go a moment ago: each time one is stored, it is about to be removed."""
    for content in CONTENTS:
        blobs.put(content)
    with database.of(SERVICE).writing() as session:
        session.execute(update(BlobRow).values(seen=0.0))
    sweeper, over = sweeper_of(database, blobs), threading.Event()

    def sweep() -> None:
        while not over.is_set():
            sweeper._remove("local", NAMES, 1.0)

    sweepers = [threading.Thread(target=sweep) for _ in range(3)]
    for thread in sweepers:
        thread.start()
    for _ in range(3):
        for content in CONTENTS:
            blobs.put(content)
    over.set()
    for thread in sweepers:
        thread.join()
    assert [blobs.get(name) for name in NAMES] == CONTENTS


def test_whoever_stores_a_blob_that_is_being_removed_waits_and_stores_it_anew(
    database: Database, blobs: Blobs, monkeypatch: pytest.MonkeyPatch
) -> None:
    blobs.put(CONTENTS[0])
    with database.of(SERVICE).writing() as session:
        session.execute(update(BlobRow).values(seen=0.0))
    storing, stored = threading.Event(), threading.Event()
    remove, note = FolderObjects.remove, Blobs._note

    def store() -> None:
        blobs.put(CONTENTS[0])
        stored.set()

    def noted(own: Blobs, sha256: str, size: int) -> None:
        storing.set()
        note(own, sha256, size)

    def slow(objects: FolderObjects, team: str, names: list[str]) -> None:
        threading.Thread(target=store).start()
        storing.wait()
        assert not stored.wait(0.2)
        remove(objects, team, names)

    with monkeypatch.context() as patched:
        patched.setattr(FolderObjects, "remove", slow)
        patched.setattr(Blobs, "_note", noted)
        assert sweeper_of(database, blobs)._remove("local", NAMES, 1.0) == 1
        stored.wait()
    assert blobs.get(NAMES[0]) == CONTENTS[0]


def test_many_blobs_are_swept_in_small_steps_and_by_indexes(
    database: Database, database_kind: str, blobs: Blobs, monkeypatch: pytest.MonkeyPatch
) -> None:
    if database_kind == "postgres":
        pytest.skip("plans are those of SQLite")
    monkeypatch.setattr(unreferenced, "_PAUSE_SECONDS", 0.0)
    names = [hashlib.sha256(b"%d" % at).hexdigest() for at in range(3000)]
    row = {"team": "local", "bytes": 1, "created": 0.0, "seen": 0.0}
    with database.of(SERVICE).writing() as session:
        session.execute(insert_blobs(session, [{**row, "sha256": name} for name in names]))
    writing, steps = Database.writing, list[None]()

    @contextmanager
    def counted(own: Database) -> Iterator[Session]:
        steps.append(None)
        with writing(own) as session:
            yield session

    monkeypatch.setattr(Database, "writing", counted)
    with planned() as plans:
        assert sweeper_of(database, blobs).sweep(2.0, 1.0) == 3000
    assert len(steps) == 3000 / 50
    assert scans(plans) == []
