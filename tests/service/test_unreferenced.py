"""Removal of blobs: while others store them, on both databases; from a folder and from a bucket; of many."""

import hashlib
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from sqlalchemy import delete, update
from sqlalchemy.orm import Session
from tests.plans import planned, scans
from tests.rows import add_model
from tests.sweeping import HOUR, NOTHING, Kept

from treestroke.service import unreferenced
from treestroke.service.retention import Swept
from treestroke.service.unreferenced import BlobSweeper
from treestroke.store.blobs import Blobs, insert_blobs, open_blobs
from treestroke.store.database import Database
from treestroke.store.objects import Damaged, FolderObjects, StorageAway
from treestroke.store.scope import LOCAL, SERVICE, Scope
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


@pytest.mark.parametrize("wanted", ["named", "stored again"])
def test_a_blob_that_is_wanted_at_the_last_moment_stays(
    anywhere: Kept, monkeypatch: pytest.MonkeyPatch, wanted: str
) -> None:
    name = anywhere.blobs.put(b"strokes")
    anywhere.sweep()
    anywhere.clocks.pass_(HOUR)
    remove, asked = BlobSweeper._remove, list[str]()

    def late(sweeper: BlobSweeper, team: str, names: list[str], before: float) -> int:
        asked.extend(names)
        if wanted == "named":
            add_model(anywhere.database, {"strokes": name})
        else:
            anywhere.blobs.put(b"strokes")
        return remove(sweeper, team, names, before)

    monkeypatch.setattr(BlobSweeper, "_remove", late)
    assert anywhere.sweep().blobs == 0
    assert asked == [name]
    assert anywhere.blobs.get(name) == b"strokes"


def test_an_object_without_a_row_and_a_row_without_an_object_go_after_an_hour(anywhere: Kept) -> None:
    lost, bare = anywhere.blobs.put(b"lost"), hashlib.sha256(b"bare").hexdigest()
    anywhere.blobs.objects.remove("local", [lost])
    anywhere.blobs.objects.put("local", bare, b"bare")
    anywhere.blobs.objects.put("team_oaks", bare, b"bare")
    assert anywhere.sweep_for(HOUR) == Swept(0, 0, 0, 0, 0, 3)
    assert (anywhere.files(), anywhere.count(BlobRow)) == (set(), 0)


def test_an_object_whose_row_was_lost_stays_where_another_row_names_it(anywhere: Kept) -> None:
    row = anywhere.photo("pho_1")
    with anywhere.database.writing() as session:
        session.execute(delete(BlobRow))
    assert anywhere.sweep_for(3 * HOUR) == NOTHING
    assert anywhere.blobs.get(row.blob)
    assert anywhere.count(BlobRow) == 1


def test_a_team_keeps_its_blob_while_another_removes_the_same(anywhere: Kept) -> None:
    row, oaks = anywhere.photo("pho_1"), Scope("team_oaks", "usr_ada")
    anywhere.blobs.of(oaks).put(b"pho_1")
    assert anywhere.sweep_for(2 * HOUR).blobs == 1
    assert anywhere.blobs.get(row.blob)
    with pytest.raises(Damaged):
        anywhere.blobs.of(oaks).get(row.blob)


def test_a_bucket_that_is_away_ends_a_sweep_that_has_removed_nothing(
    kept: Kept, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = kept.blobs.put(b"strokes")
    kept.sweep()
    kept.clocks.pass_(HOUR)

    def away(*_: object) -> None:
        raise StorageAway("away")

    with monkeypatch.context() as patched:
        patched.setattr(FolderObjects, "remove", away)
        with pytest.raises(StorageAway):
            kept.sweep()
    assert kept.count(BlobRow) == 1
    assert kept.blobs.get(name) == b"strokes"
    assert kept.sweep().blobs == 1
