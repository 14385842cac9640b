"""Backing up: all rows in one snapshot, then the blobs that they refer to, while the service runs."""

from datetime import UTC, datetime

from treestroke import __version__
from treestroke.core.progress import Report
from treestroke.store.backup_folder import BackupError, BackupFolder, Manifest, named
from treestroke.store.blobs import Blobs
from treestroke.store.database import Database
from treestroke.store.objects import Damaged
from treestroke.store.revisions import revisions_of
from treestroke.store.table_rows import dump


def back_up(database: Database, blobs: Blobs, target: BackupFolder, report: Report) -> Manifest:
    """Write a backup into a folder and return what was written; of an earlier one there, what is new is copied.

    No sweep removes a blob meanwhile, so that all that the rows of the snapshot refer to are still there.

    Raises
    ------
    BackupError
        The folder holds other things, the database is of another version, or blobs are missing or damaged.
    DataFolderError
        The database is lost, or was made by a newer program.
    OSError
        The disk is full, or the place of the blobs is away.
    """
    _check_folders(target, blobs)
    database.check()
    if not database.current():
        raise BackupError(
            f"{database.place}: there are no tables, or those of an older treestroke; start `treestroke serve`, which "
            "brings them up to date"
        )
    with target.writing(), database.hold():
        before = target.manifest()
        number = before.number + 1 if before else 1
        with database.copying() as connection:
            (revision,) = revisions_of(connection)
            files = dump(connection, target.new_tables(number), report)
        size = _copy(blobs, target, number, report)
        made = Manifest(
            version=__version__,
            revision=revision,
            created=datetime.now(UTC).isoformat(timespec="seconds"),
            number=number,
            tables=files,
            bytes=size,
        )
        target.publish(made)
    return made


def _check_folders(target: BackupFolder, blobs: Blobs) -> None:
    """Check that neither folder is within the other: both have blobs, and each removes those that it does not know."""
    backup, data = target.path.resolve(), blobs.data.resolve()
    if backup.is_relative_to(data) or data.is_relative_to(backup):
        raise BackupError(
            f"{target.path}: the data folder is {blobs.data}; name a folder outside of it, for backups alone"
        )


def _copy(blobs: Blobs, target: BackupFolder, number: int, report: Report) -> int:
    """Copy the blobs that are not there yet; return the size of all."""
    total = sum(blob.bytes for blob in target.blobs(number))
    bad, done, size = list[str](), 0, 0
    for blob in target.blobs(number):
        path = target.blob(blob.team, blob.sha256)
        report("files", done / total if total else 0.0)
        done += blob.bytes
        try:
            if not path.exists():
                path.parent.mkdir(parents=True, exist_ok=True)
                blobs.objects.copy(blob.team, blob.sha256, path)
            size += path.stat().st_size
        except Damaged as error:
            bad.append(str(error))
    if bad:
        raise BackupError(
            f"{blobs.objects.place}: missing or damaged files ({named(bad)}), so the backup is not whole; upload the "
            "photos or request the models again, or delete these and wait a day"
        )
    return size
