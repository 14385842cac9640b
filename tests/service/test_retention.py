import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import func, select, update
from tests.rows import add_model

from treestroke.service import models
from treestroke.service.photos import NotFound
from treestroke.service.retention import Swept, referenced, sweep
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.tables import File, Model, Photo, Replay

DAY = 86_400.0


class Kept:
    """A store with rows of any age."""

    def __init__(self, folder: Path) -> None:
        self.database, self.blobs = Database(folder), Blobs(folder)
        self.database.migrate()

    def blob(self, content: bytes) -> str:
        name = self.blobs.put(content)
        then = time.time() - 2 * 3600
        os.utime(self.blobs.path(name), (then, then))
        return name

    def photo(self, id: str, age_days: float = 0, deleted_days: float | None = None) -> Photo:
        now = time.time()
        row = Photo(
            id=id,
            sha256="",
            width=1,
            height=1,
            blob=self.blob(id.encode()),
            created=now - age_days * DAY,
            deleted=None if deleted_days is None else now - deleted_days * DAY,
        )
        with self.database.writing() as session:
            session.add(row)
        return row

    def model(self, age_days: float = 0, deleted_days: float | None = None, status: str = "succeeded") -> Model:
        now = time.time()
        row = add_model(
            self.database,
            status=status,
            photo_blob=self.blob(b"photo"),
            strokes_blob=self.blob(b"strokes"),
            created=now - age_days * DAY,
            deleted=None if deleted_days is None else now - deleted_days * DAY,
        )
        tree = self.blob(b"tree of " + row.id.encode())
        with self.database.writing() as session:
            session.add(File(model=row.id, name="tree.glb", blob=tree, bytes=4))
        return row

    def count(self, table: type[Model] | type[Photo] | type[File] | type[Replay]) -> int:
        with self.database.reading() as session:
            return session.scalar(select(func.count()).select_from(table)) or 0

    def sweep(self, keep_days: float = 0, young_s: float = 3600) -> Swept:
        return sweep(self.database, self.blobs, keep_days, young_s)


@pytest.fixture
def kept(tmp_path: Path) -> Iterator[Kept]:
    opened = Kept(tmp_path)
    yield opened
    opened.database.close()


def test_what_is_not_deleted_stays_for_ever(kept: Kept) -> None:
    kept.model(age_days=9999)
    kept.photo("pho_1", age_days=9999)
    assert kept.sweep() == Swept(0, 0, 0)
    assert (kept.count(Model), kept.count(Photo), kept.count(File)) == (1, 1, 1)


def test_a_deleted_model_goes_with_its_files_after_a_day(kept: Kept) -> None:
    row = kept.model(deleted_days=1.01)
    assert kept.sweep() == Swept(1, 0, 3)
    assert (kept.count(Model), kept.count(File)) == (0, 0)
    with pytest.raises(NotFound):
        models.restore(kept.database, row.id)


@pytest.mark.parametrize("part", ["front", "side", "leaf", "fruit"])
def test_what_a_model_is_made_of_stays_as_long_as_it_does(kept: Kept, part: str) -> None:
    row, blob = kept.model(), kept.blob(part.encode())
    with kept.database.writing() as session:
        session.execute(update(Model).values({f"{part}_blob": blob, "photo": None, "photo_blob": None}))
    assert blob in referenced(kept.database)
    assert kept.sweep().blobs == 1  # the photo's
    with kept.database.writing() as session:
        session.execute(update(Model).where(Model.id == row.id).values(deleted=time.time() - 1.01 * DAY))
    assert kept.sweep() == Swept(1, 0, 3)
    assert not kept.blobs.path(blob).exists()


def test_a_deleted_model_is_restored_with_its_files_before(kept: Kept) -> None:
    row = kept.model(deleted_days=0.99)
    assert kept.sweep() == Swept(0, 0, 0)
    seen = models.restore(kept.database, row.id)
    assert kept.blobs.get(seen.files["tree.glb"].blob)
    assert seen.row.deleted is None


def test_a_model_that_is_restored_in_time_outlives_the_day(kept: Kept) -> None:
    row = kept.model(deleted_days=0.99)
    models.restore(kept.database, row.id)
    with kept.database.writing() as session:
        session.execute(update(Model).values(created=0.0))
    assert kept.sweep() == Swept(0, 0, 0)


def test_a_file_that_two_models_share_stays_with_the_other(kept: Kept) -> None:
    gone, stays = kept.model(deleted_days=2), kept.model()
    with kept.database.writing() as session:
        shared = session.get_one(File, (gone.id, "tree.glb")).blob
        session.get_one(File, (stays.id, "tree.glb")).blob = shared
    kept.sweep()
    assert kept.blobs.path(shared).exists()
    assert shared in referenced(kept.database)


def test_a_deleted_photo_goes_after_a_day_and_its_models_keep_their_copy(kept: Kept) -> None:
    photo, model = kept.photo("pho_1", deleted_days=1.01), kept.model()
    assert kept.sweep() == Swept(0, 1, 1)
    assert not kept.blobs.path(photo.blob).exists()
    assert kept.blobs.path(model.photo_blob).exists()


def test_a_deleted_model_that_still_grows_is_left_to_its_worker(kept: Kept) -> None:
    kept.model(deleted_days=2, status="running")
    assert kept.sweep() == Swept(0, 0, 0)


def test_what_is_older_than_the_days_is_deleted_and_goes_a_day_later(kept: Kept) -> None:
    old, young, growing = kept.model(age_days=8), kept.model(age_days=6), kept.model(age_days=8, status="running")
    kept.photo("pho_1", age_days=8)
    assert kept.sweep(keep_days=7) == Swept(0, 0, 0)
    with pytest.raises(NotFound):
        models.see(kept.database, old.id)
    for row in (young, growing):
        assert models.see(kept.database, row.id).row.id == row.id
    with kept.database.writing() as session:
        for table in (Model, Photo):
            session.execute(update(table).where(table.deleted.is_not(None)).values(deleted=time.time() - 1.01 * DAY))
    assert kept.sweep(keep_days=7) == Swept(1, 1, 2)
    assert kept.count(Model) == 2


def test_keys_are_forgotten_after_a_day(kept: Kept) -> None:
    with kept.database.writing() as session:
        for key, age in (("old", 1.01), ("young", 0.99)):
            session.add(Replay(key=key, fingerprint="", model="", created=time.time() - age * DAY))
    kept.sweep()
    with kept.database.reading() as session:
        assert session.scalars(select(Replay.key)).all() == ["young"]


def test_a_blob_that_no_row_names_yet_stays_while_it_is_young(kept: Kept) -> None:
    name = kept.blobs.put(b"about to be named")
    assert kept.sweep() == Swept(0, 0, 0)
    assert kept.sweep(young_s=-1).blobs == 1
    assert not kept.blobs.path(name).exists()
