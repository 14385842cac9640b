import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest
from sqlalchemy import select, update
from tests.accounts import accounts, make
from tests.postgres import KINDS, PostgresServer
from tests.rows import add_model, claim, photo_row
from tests.sweeping import HOUR, Kept

from treestroke.core.progress import silent
from treestroke.service.backup import back_up
from treestroke.service.restore import restore
from treestroke.store.account_tables import TeamRow
from treestroke.store.backup_folder import BackupError, BackupFolder, Manifest
from treestroke.store.blobs import Blobs, open_blobs
from treestroke.store.data_folder import DataFolderError
from treestroke.store.database import Database, upgrade
from treestroke.store.objects import Damaged, FolderObjects, StorageAway, sha256_of
from treestroke.store.queries import referenced
from treestroke.store.scope import LOCAL, SERVICE
from treestroke.store.table_rows import TableFile
from treestroke.store.tables import ModelRow


@dataclass
class Target:
    """An empty database and an empty place for blobs."""

    database: Database
    blobs: Blobs

    def restore(self, source: BackupFolder, verify: bool = True) -> Manifest:
        return restore(source, self.database, self.blobs, silent, verify)

    def names(self) -> set[str]:
        return {name for _, sizes in self.blobs.objects.pages() for name in sizes}


@pytest.fixture
def folder(tmp_path: Path) -> BackupFolder:
    """Where backups are written; the data folder of `kept` is beside it."""
    return BackupFolder(tmp_path.with_name(f"{tmp_path.name}-backup"))


@pytest.fixture(params=[(kind, place) for kind in KINDS for place in ("folder", "bucket")], ids="-".join)
def target(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Target]:
    kind, place = request.param
    url = request.getfixturevalue("postgres_url") if kind == "postgres" else ""
    bucket_url = ""
    if place == "bucket":
        request.getfixturevalue("bucket_url")  # by which the server is reached; that place may be the source's
        bucket_url = request.getfixturevalue("s3_server").fresh()
    with a_target(tmp_path.with_name(f"{tmp_path.name}-target"), url, bucket_url) as made:
        yield made


@pytest.fixture
def plain(tmp_path: Path) -> Iterator[Target]:
    """SQLite and a folder."""
    with a_target(tmp_path.with_name(f"{tmp_path.name}-target")) as made:
        yield made


@contextmanager
def a_target(folder: Path, url: str = "", bucket_url: str = "") -> Iterator[Target]:
    folder.mkdir()
    database = Database(folder, url)
    yield Target(database, open_blobs(database, folder, bucket_url))
    database.close()


def backed_up(kept: Kept, folder: BackupFolder) -> Manifest:
    return back_up(kept.database, kept.blobs, folder, silent)


def test_a_backup_is_restored_in_every_form(anywhere: Kept, folder: BackupFolder, target: Target) -> None:
    done, waiting = anywhere.model(), anywhere.model("queued")
    anywhere.photo("pho_1")
    anywhere.blobs.put(b"of nothing")
    made = backed_up(anywhere, folder)
    assert target.restore(folder) == made
    assert target.names() == anywhere.named()
    assert target.database.current()
    with target.database.of(LOCAL).reading() as session:
        assert referenced(session) == anywhere.named()
        found = {row.id: row.status for row in session.scalars(select(ModelRow))}
    assert found == {done.id: "succeeded", waiting.id: "queued"}
    with target.database.of(SERVICE).reading() as session:
        assert session.scalars(select(TeamRow.team)).all() == (["local"] if target.database.url else [])


def test_a_job_that_was_running_waits_again_with_its_attempt(kept: Kept, folder: BackupFolder, plain: Target) -> None:
    rows = [add_model(kept.database, {}) for _ in range(2)]
    for row in rows:
        claim(kept.database, row)
    with kept.database.writing() as session:
        session.execute(update(ModelRow).where(ModelRow.id == rows[1].id).values(cancel=True))
    backed_up(kept, folder)
    plain.restore(folder)
    with plain.database.of(LOCAL).reading() as session:
        found = [(row.status, row.attempt, row.worker) for row in session.scalars(select(ModelRow))]
    assert found == [("queued", 1, None), ("canceled", 1, None)]


def test_what_a_team_has_is_there_after_it_and_its_keys_are_valid(
    tmp_path: Path, folder: BackupFolder, postgres: PostgresServer
) -> None:
    database = Database(tmp_path, postgres.fresh_with_tables())
    made, blobs = make(database), open_blobs(database, tmp_path)
    who = accounts(database).by_key(made.key)
    photo = photo_row(blobs.of(who.scope).put(b"photo"), 5)
    with database.of(who.scope).writing() as session:
        session.add(photo)
    back_up(database, blobs, folder, silent)
    database.close()
    with a_target(tmp_path.with_name(f"{tmp_path.name}-target"), postgres.fresh()) as target:
        target.restore(folder)
        assert accounts(target.database).by_key(made.key) == who
        assert target.blobs.of(who.scope).get(photo.blob) == b"photo"
        with target.database.of(SERVICE).reading() as session:
            assert session.scalars(select(TeamRow.name)).all() == ["Oaks"]


def test_what_teams_made_goes_to_a_service_for_teams_alone(
    database: Database, tmp_path: Path, folder: BackupFolder, plain: Target
) -> None:
    make(database, team="Elms")
    back_up(database, open_blobs(database, tmp_path), folder, silent)
    with pytest.raises(BackupError, match=r"what teams made \('Elms' is one\).*set TREESTROKE_DATABASE_URL$"):
        plain.restore(folder)
    assert not plain.database.exists()


def test_the_next_backup_copies_what_is_new_and_removes_what_no_row_needs(
    kept: Kept, folder: BackupFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    old, stays = kept.model(), kept.model()
    assert backed_up(kept, folder).number == 1
    with kept.database.writing() as session:
        session.delete(session.get_one(ModelRow, old.number))
    kept.photo("pho_1")
    copied = list[str]()
    copy = FolderObjects.copy

    def counted(self: FolderObjects, team: str, name: str, path: Path) -> None:
        copied.append(name)
        copy(self, team, name, path)

    monkeypatch.setattr(FolderObjects, "copy", counted)
    made = backed_up(kept, folder)
    assert (made.number, len(copied)) == (2, 1)
    assert stored(folder) == kept.named()
    assert [path.name for path in (folder.path / "tables").iterdir()] == ["2"]
    assert stays.id in (folder.tables(2) / "models.jsonl").read_text()


def stored(folder: BackupFolder) -> set[str]:
    return {path.name for path in (folder.path / "blobs").rglob("*") if path.is_file()}


def test_a_backup_that_is_interrupted_leaves_the_one_before(
    kept: Kept, folder: BackupFolder, plain: Target, monkeypatch: pytest.MonkeyPatch
) -> None:
    row = kept.model()
    first = backed_up(kept, folder)
    with kept.database.writing() as session:
        session.delete(session.get_one(ModelRow, row.number))
    kept.model()
    with monkeypatch.context() as away:
        away.setattr(FolderObjects, "copy", _away)
        with pytest.raises(StorageAway):
            backed_up(kept, folder)
    assert folder.manifest() == first
    plain.restore(folder)
    with plain.database.of(LOCAL).reading() as session:
        assert session.scalars(select(ModelRow.id)).all() == [row.id]
    assert backed_up(kept, folder).number == 2
    assert stored(folder) == kept.named()


def _away(*_: object) -> None:
    raise StorageAway("the bucket is away")


def test_a_first_backup_that_was_interrupted_is_none(
    kept: Kept, folder: BackupFolder, plain: Target, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept.model()
    with monkeypatch.context() as away:
        away.setattr(FolderObjects, "copy", _away)
        with pytest.raises(StorageAway):
            backed_up(kept, folder)
    with pytest.raises(BackupError, match="there is no whole backup in it"):
        plain.restore(folder)
    assert backed_up(kept, folder).number == 1


@pytest.mark.parametrize("harm", [Path.unlink, lambda path: path.write_bytes(b"other")], ids=["missing", "damaged"])
def test_a_backup_without_a_blob_is_never_whole(
    kept: Kept, folder: BackupFolder, harm: Callable[[Path], object]
) -> None:
    row = kept.photo("pho_1")
    kept.model()
    harm(kept.blobs.path(row.blob))
    with pytest.raises(
        BackupError, match=f"missing or damaged files .{row.blob}: (missing|damaged).*upload the photos"
    ):
        backed_up(kept, folder)
    assert folder.manifest() is None
    assert stored(folder) == kept.named() - {row.blob}
    kept.blobs.put(b"pho_1")
    assert backed_up(kept, folder).number == 1


def test_no_sweep_removes_a_blob_while_a_backup_is_made(kept: Kept) -> None:
    row = kept.photo("pho_1")
    kept.sweep()
    with kept.database.hold():
        with kept.database.writing() as session:
            session.delete(session.merge(row))
        kept.sweep_for(4 * HOUR)
        kept.blobs.verify(row.blob)
    kept.sweep_for(2 * HOUR)
    with pytest.raises(Damaged):
        kept.blobs.verify(row.blob)


def test_a_damaged_backup_is_refused_before_anything_is_written(
    kept: Kept, folder: BackupFolder, plain: Target
) -> None:
    row = kept.photo("pho_1")
    backed_up(kept, folder)
    folder.blob("local", row.blob).write_bytes(b"other")
    with pytest.raises(BackupError, match=f"damaged files .{row.blob}: damaged.*another copy of this one$"):
        plain.restore(folder)
    assert (plain.names(), plain.database.exists()) == (set(), False)
    with pytest.raises(BackupError, match=f"damaged files .{row.blob}: damaged"):
        plain.restore(folder, verify=False)
    assert (plain.names(), plain.database.exists()) == (set(), False)


def test_damaged_rows_are_refused(kept: Kept, folder: BackupFolder, plain: Target) -> None:
    kept.model()
    made = backed_up(kept, folder)
    path = folder.tables(made.number) / "models.jsonl"
    path.write_text(path.read_text().replace("succeeded", "failed"))
    with pytest.raises(BackupError, match=r"damaged files \(models.jsonl\)"):
        plain.restore(folder, verify=False)
    (folder.path / "backup.json").write_text("{}")
    with pytest.raises(BackupError, match=r"backup.json: it is damaged"):
        plain.restore(folder)


def test_a_restore_that_was_interrupted_is_begun_again(
    kept: Kept, folder: BackupFolder, plain: Target, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept.model()
    backed_up(kept, folder)
    with monkeypatch.context() as away:
        away.setattr("treestroke.service.restore.queue_running", _away)
        with pytest.raises(StorageAway):
            plain.restore(folder)
    assert plain.database.empty()
    plain.restore(folder)
    assert plain.names() == kept.named()


def test_no_rows_that_are_there_are_mixed_with_those_of_a_backup(
    kept: Kept, folder: BackupFolder, target: Target
) -> None:
    kept.photo("pho_1")
    backed_up(kept, folder)
    with target.database.migrating() as connection:
        upgrade(connection)
    with pytest.raises(BackupError, match=r"it is not empty; restore into a new database"):
        target.restore(folder)


def test_no_files_that_are_there_are_mixed_with_those_of_a_backup(
    kept: Kept, folder: BackupFolder, plain: Target
) -> None:
    kept.photo("pho_1")
    backed_up(kept, folder)
    plain.blobs.objects.put("local", "ab" * 32, b"tree")
    with pytest.raises(BackupError, match=r"blobs: it is not empty"):
        plain.restore(folder)
    assert not plain.database.exists()


def test_a_backup_of_a_newer_program_is_refused(kept: Kept, folder: BackupFolder, plain: Target) -> None:
    made = backed_up(kept, folder)
    newer = made.model_copy(update={"revision": "9999", "version": "9.0"})
    (folder.path / "backup.json").write_text(newer.model_dump_json())
    with pytest.raises(BackupError, match=r"treestroke 9.0, which is newer.*9999.*; install that treestroke$"):
        plain.restore(folder)


def test_a_backup_of_an_older_program_is_brought_up_to_date(kept: Kept, folder: BackupFolder, target: Target) -> None:
    """Its rows are those that an older database has, and columns and tables that came later are missing."""
    row = kept.model()
    made = backed_up(kept, folder)
    tables = folder.tables(made.number)
    for name in ("shares", "webhooks", "deliveries", "audit"):
        (tables / f"{name}.jsonl").unlink()
    path = tables / "models.jsonl"
    assert ',"tags":[]}' in path.read_text()
    path.write_text(path.read_text().replace(',"tags":[]}', "}"))
    files = {name: told for name, told in made.tables.items() if (tables / f"{name}.jsonl").exists()}
    files["models"] = TableFile(files["models"].rows, sha256_of(path))
    older = made.model_copy(update={"revision": "0014", "tables": files})
    (folder.path / "backup.json").write_text(older.model_dump_json())
    target.restore(folder)
    assert target.database.current()
    with target.database.of(LOCAL).reading() as session:
        assert [(one.id, one.tags) for one in session.scalars(select(ModelRow))] == [(row.id, [])]


def test_a_folder_with_other_things_is_no_place_for_backups(kept: Kept, folder: BackupFolder) -> None:
    folder.path.mkdir()
    (folder.path / "thesis.odt").touch()
    with pytest.raises(BackupError, match=r"it also holds 'thesis.odt'; name a folder for backups alone"):
        backed_up(kept, folder)
    for path in (kept.blobs.data, kept.blobs.data / "backup", kept.blobs.data.parent):
        with pytest.raises(BackupError, match="outside of"):
            backed_up(kept, BackupFolder(path))
    shutil.rmtree(folder.path)


def test_one_backup_at_a_time_is_written_to_a_folder(kept: Kept, folder: BackupFolder) -> None:
    with folder.writing(), pytest.raises(BackupError, match="another backup is being written; wait for its end"):
        backed_up(kept, folder)
    backed_up(kept, folder)


def test_only_a_database_of_this_version_is_backed_up(tmp_path: Path, folder: BackupFolder) -> None:
    database = Database(tmp_path)
    blobs = open_blobs(database, tmp_path)
    with pytest.raises(BackupError, match="there are no tables, or those of an older treestroke; start"):
        back_up(database, blobs, folder, silent)
    database.migrate()
    with database.of(SERVICE).writing() as session:
        session.connection().exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    with pytest.raises(DataFolderError, match="a newer treestroke made this database"):
        back_up(database, blobs, folder, silent)
    assert not folder.path.exists()
    database.close()
