import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from sqlalchemy import select, update
from sqlalchemy.orm import Session
from tests.plans import planned, scans
from tests.rows import add_capture, add_solve, add_webhook, deliveries
from tests.sweeping import DAY, HOUR, NOTHING, Kept

from treestroke.service import captures, retention, stored_models
from treestroke.service.photos import NotFound
from treestroke.service.retention import UNWATCHED_SECONDS, Sweeper, Swept
from treestroke.store.database import Database
from treestroke.store.outbox import message
from treestroke.store.queries import photo as photo_by_id
from treestroke.store.scope import SERVICE
from treestroke.store.tables import (
    BlobRow,
    CapturePhoto,
    CaptureRow,
    ClipRow,
    File,
    ModelRow,
    PhotoRow,
    Replay,
    SolveRow,
    UploadRow,
)


def test_what_is_not_deleted_stays(anywhere: Kept) -> None:
    anywhere.model()
    anywhere.photo("pho_1")
    assert anywhere.sweep_for(30 * HOUR) == NOTHING
    assert (anywhere.count(ModelRow), anywhere.count(PhotoRow), anywhere.count(File)) == (1, 1, 1)


def test_a_deleted_model_goes_with_its_files_after_a_day(anywhere: Kept) -> None:
    row = anywhere.model()
    anywhere.delete(row)
    assert anywhere.sweep_for(23 * HOUR) == NOTHING
    assert stored_models.restore(anywhere.database, row.id).files["tree.glb"]
    anywhere.delete(row)
    assert anywhere.sweep_for(26 * HOUR) == Swept(1, 0, 0, 0, 0, 3)
    assert (anywhere.count(ModelRow), anywhere.count(File), anywhere.count(BlobRow), anywhere.files()) == (
        0,
        0,
        0,
        set(),
    )
    with pytest.raises(NotFound):
        stored_models.restore(anywhere.database, row.id)


@pytest.mark.parametrize("jump", [25 * HOUR, -25 * HOUR, 400 * DAY])
@pytest.mark.parametrize("again", [False, True])
def test_a_clock_that_jumps_purges_nothing_that_was_just_written_or_deleted(
    kept: Kept, jump: float, again: bool
) -> None:
    kept.restart(keep_days=1)
    kept.sweep()
    kept.delete(kept.model())
    kept.model()
    photo, name = kept.photo("pho_1"), kept.blobs.put(b"about to be named")
    kept.clocks.wall += jump
    for _ in range(3):
        if again:
            kept.restart(keep_days=1)  # the first sweep of a process knows the wall's clock alone
        assert (kept.sweep().models, kept.count(ModelRow), kept.count(PhotoRow)) == (0, 2, 1)
        with kept.database.reading() as session:
            assert photo_by_id(session, photo.id) is not None
        assert kept.blobs.get(name)


def test_no_one_stretch_in_which_nobody_watched_counts_as_a_day(kept: Kept) -> None:
    kept.delete(kept.model())
    kept.sweep()
    went = []
    for _ in range(3):
        kept.clocks.wall += 100 * DAY
        kept.restart()
        went.append(kept.sweep().models)
    assert went == [0, 1, 0]
    assert UNWATCHED_SECONDS * 2 == DAY


def test_a_clock_that_jumps_forth_and_back_between_starts_counts_no_hour_twice(kept: Kept) -> None:
    kept.sweep()
    kept.delete(kept.model())
    for jump in (9, -9, 9, -9, 9, -9, 9, -9):
        kept.clocks.wall += jump * HOUR
        kept.clocks.pass_(60)
        kept.restart()
        assert kept.sweep().models == 0
    assert kept.count(ModelRow) == 1


@pytest.mark.parametrize("again", [False, True])
def test_ages_go_on_after_a_clock_that_was_far_ahead_is_set_right(kept: Kept, again: bool) -> None:
    kept.clocks.wall += 400 * DAY
    kept.sweep()
    kept.clocks.wall -= 400 * DAY
    if again:
        kept.restart()
    kept.delete(kept.model())
    assert kept.sweep_for(23 * HOUR).models == 0
    assert kept.sweep_for(2 * HOUR).models == 1


@pytest.mark.parametrize("part", ["front", "side", "leaf", "fruit"])
def test_what_a_model_is_made_of_stays_as_long_as_it_does(kept: Kept, part: str) -> None:
    blob = kept.blobs.put(part.encode())
    row = kept.model(**{part: blob})
    assert blob in kept.named()
    assert kept.sweep_for(2 * HOUR) == NOTHING
    kept.delete(row)
    assert kept.sweep_for(26 * HOUR) == Swept(1, 0, 0, 0, 0, 4)
    assert not kept.blobs.path(blob).exists()


def test_a_file_that_two_models_share_stays_with_the_other(anywhere: Kept) -> None:
    gone, stays = anywhere.model(), anywhere.model()
    with anywhere.database.writing() as session:
        shared = session.get_one(File, (gone.id, "tree.glb")).blob
        session.get_one(File, (stays.id, "tree.glb")).blob = shared
    anywhere.delete(gone)
    anywhere.sweep_for(26 * HOUR)
    assert anywhere.blobs.path(shared).exists()
    assert shared in anywhere.named() == anywhere.files()


def test_a_deleted_photo_goes_after_a_day_and_its_models_keep_their_copy(kept: Kept) -> None:
    photo, model = kept.photo("pho_1"), kept.model()
    with kept.database.writing() as session:
        session.execute(update(PhotoRow).values(deleted=kept.clocks.wall))
    assert kept.sweep_for(26 * HOUR) == Swept(0, 1, 0, 0, 0, 1)
    assert not kept.blobs.path(photo.blob).exists()
    assert kept.blobs.path(stored_models.find_model(kept.database, model.id).parts["photo"].blob).exists()


def test_a_deleted_model_that_still_grows_is_left_to_its_worker(kept: Kept) -> None:
    kept.delete(kept.model(status="running"))
    assert kept.sweep_for(26 * HOUR) == NOTHING


def test_what_is_older_than_the_days_is_deleted_and_goes_a_day_later(kept: Kept) -> None:
    kept.restart(keep_days=2)
    old, growing, photo = kept.model(), kept.model(status="running"), kept.photo("pho_1")
    assert kept.sweep_for(47 * HOUR) == NOTHING
    young = kept.model()
    assert stored_models.find_model(kept.database, old.id)
    assert kept.sweep_for(2 * HOUR) == NOTHING
    with pytest.raises(NotFound):
        stored_models.find_model(kept.database, old.id)
    for row in (young, growing):
        assert stored_models.find_model(kept.database, row.id).row.id == row.id
    assert kept.sweep_for(26 * HOUR) == Swept(1, 1, 0, 0, 0, 2)
    assert not kept.blobs.path(photo.blob).exists()
    assert kept.count(ModelRow) == 2


def test_a_model_that_is_restored_is_kept_for_as_long_again(kept: Kept) -> None:
    kept.restart(keep_days=1)
    row = kept.model()
    kept.sweep_for(26 * HOUR)
    stored_models.restore(kept.database, row.id)
    kept.sweep_for(20 * HOUR)
    assert stored_models.find_model(kept.database, row.id)


def test_keys_are_forgotten_after_a_day(kept: Kept) -> None:
    def use(key: str) -> None:
        with kept.database.writing() as session:
            session.add(Replay(key=key, fingerprint="", model="", created=kept.clocks.wall))

    use("old")
    kept.sweep_for(20 * HOUR)
    use("young")
    kept.sweep_for(5 * HOUR)
    with kept.database.reading() as session:
        assert session.scalars(select(Replay.key)).all() == ["young"]


def test_a_file_that_no_row_names_goes_an_hour_after_it_was_seen(kept: Kept) -> None:
    name = kept.blobs.put(b"about to be named")
    half = kept.blobs.path(name).with_name(".treestroke-0011")
    half.write_bytes(b"half")
    assert kept.sweep() == NOTHING
    kept.clocks.pass_(HOUR - 1)
    kept.restart()  # what was seen is remembered
    assert kept.sweep() == NOTHING == kept.sweep()
    kept.blobs.put(b"about to be named")  # somebody wants it
    kept.clocks.pass_(2)
    assert kept.sweep().blobs == 1
    assert kept.files() == {name}
    kept.clocks.pass_(HOUR)
    assert kept.sweep().blobs == 1
    assert (kept.files(), kept.count(BlobRow)) == (set(), 0)


def test_a_sweep_writes_in_small_steps_between_which_others_write(kept: Kept, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(retention, "_STEP_ROWS", 10)
    for _ in range(35):
        kept.delete(kept.model())
    kept.sweep()
    left: list[int] = []
    writing = Database.writing

    @contextmanager
    def watched(own: Database) -> Iterator[Session]:
        left.append(kept.count(ModelRow))
        with writing(own) as session:
            yield session

    monkeypatch.setattr(Database, "writing", watched)
    kept.clocks.pass_(DAY)
    assert kept.sweep().models == 35
    assert sorted(set(left), reverse=True) == [35, 25, 15, 5, 0]


def test_a_sweep_reads_no_whole_table(kept: Kept) -> None:
    kept.delete(kept.model())
    kept.model()
    kept.photo("pho_1")
    kept.database = kept.database.of(SERVICE)
    kept.restart(keep_days=1)
    kept.sweep()
    kept.clocks.pass_(2 * DAY)
    with planned() as steps:
        kept.sweep()
    assert scans(steps) == []
    assert any("ix_models_deleted" in step for step in steps)


def test_a_sweep_that_is_told_to_stop_stops(kept: Kept, tmp_path: Path) -> None:
    kept.delete(kept.model())
    kept.sweep()
    kept.clocks.pass_(2 * DAY)
    over = threading.Event()
    over.set()
    assert Sweeper(kept.database, kept.blobs, 0, over).sweep() == NOTHING


def test_a_deleted_capture_goes_with_its_photos_and_what_was_found_of_them(kept: Kept) -> None:
    blobs = [kept.blobs.put(name) for name in (b"one", b"two")]
    row = add_capture(kept.database, blobs)
    add_solve(kept.database, row.id, status="succeeded", structure=kept.blobs.put(b"structure"))
    assert kept.sweep_for(3 * HOUR) == NOTHING
    captures.delete(kept.database, row.id)
    assert kept.sweep_for(23 * HOUR) == NOTHING
    assert kept.sweep_for(3 * HOUR) == Swept(0, 0, 1, 0, 0, 3)
    assert (kept.count(CaptureRow), kept.count(CapturePhoto), kept.count(SolveRow), kept.files()) == (0, 0, 0, set())


def test_a_photo_that_was_removed_from_a_capture_goes_and_the_others_stay(kept: Kept) -> None:
    row = add_capture(kept.database, [kept.blobs.put(b"one"), kept.blobs.put(b"two")])
    kept.sweep()
    photo = captures.find_capture(kept.database, row.id).photos[0]
    captures.remove_photo(kept.database, row.id, photo.id)
    assert kept.sweep_for(3 * HOUR) == Swept(0, 0, 0, 0, 0, 1)
    assert kept.files() == kept.named()


def test_an_old_capture_is_deleted_once_nothing_is_under_way(kept: Kept) -> None:
    kept.restart(keep_days=1)
    busy, idle = (add_capture(kept.database).id for _ in range(2))
    add_solve(kept.database, busy, status="running")
    assert kept.sweep_for(50 * HOUR).captures == 1
    assert captures.find_capture(kept.database, busy)
    with pytest.raises(NotFound):
        captures.find_capture(kept.database, idle)


def test_a_deleted_clip_goes_with_its_file_after_a_day(kept: Kept) -> None:
    kept.clip("clp_1")
    row = kept.clip("clp_2")
    with kept.database.writing() as session:
        session.execute(update(ClipRow).where(ClipRow.id == row.id).values(deleted=1.0, seen=None))
    assert kept.sweep_for(23 * HOUR) == NOTHING
    assert kept.sweep_for(3 * HOUR) == Swept(0, 0, 0, 1, 0, 1)
    assert kept.count(ClipRow) == 1


def test_old_clips_are_deleted_where_days_are_set(kept: Kept) -> None:
    kept.restart(keep_days=2)
    kept.clip("clp_1")
    assert kept.sweep_for(47 * HOUR) == NOTHING
    assert kept.sweep_for(28 * HOUR).clips == 1


def test_an_upload_that_stopped_goes_after_a_day_and_one_that_goes_on_stays(kept: Kept) -> None:
    for id in ("upl_1", "upl_2"):
        kept.upload(id)
    assert kept.sweep_for(23 * HOUR) == NOTHING
    with kept.database.writing() as session:
        session.execute(update(UploadRow).where(UploadRow.id == "upl_2").values(seen=None))
    assert kept.sweep_for(3 * HOUR) == Swept(0, 0, 0, 0, 1, 0)
    assert kept.uploads.ids() == ["upl_2"]


def test_what_arrived_for_an_upload_without_a_row_goes_at_once(kept: Kept) -> None:
    with kept.uploads.adding("upl_1", 0) as writer:
        writer.write(b"video")
    kept.sweep()
    assert kept.uploads.ids() == []


def add_messages(kept: Kept, *states: str) -> None:
    """Write messages to a new webhook that are in some states, the first one first."""
    webhook = add_webhook(kept.database)
    for state in states:
        row = message(webhook, "ping", {})
        row.state = state
        with kept.database.writing() as session:
            session.add(row)


def states(kept: Kept) -> list[str]:
    return [row.state for row in deliveries(kept.database)]


def test_messages_to_webhooks_are_kept_for_thirty_days_unless_they_wait(
    kept: Kept, monkeypatch: pytest.MonkeyPatch
) -> None:
    add_messages(kept, "delivered", "waiting", "failed")
    monkeypatch.setattr(retention, "DELIVERY_SECONDS", 2 * DAY)  # hourly sweeps of a month take long
    kept.sweep_for(47 * HOUR)
    assert states(kept) == ["delivered", "waiting", "failed"]
    kept.sweep_for(3 * HOUR)
    assert states(kept) == ["waiting"]


def test_of_many_messages_to_a_webhook_the_oldest_go_unless_they_wait(
    kept: Kept, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(retention, "MOST_DELIVERIES", 2)
    add_messages(kept, "delivered", "waiting", "failed", "blocked", "canceled")
    add_messages(kept, "delivered", "delivered")
    kept.sweep()
    assert states(kept) == ["waiting", "blocked", "canceled", "delivered", "delivered"]
