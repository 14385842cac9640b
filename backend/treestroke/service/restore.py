"""Restoring a backup into an empty database and an empty place for blobs, of whichever form they are."""

from collections.abc import Callable, Sequence

from sqlalchemy import Connection, exists, insert, inspect, select

from treestroke.core.progress import Report
from treestroke.store.account_tables import TeamRow
from treestroke.store.backup_folder import BackedUp, BackupError, BackupFolder, Manifest, named
from treestroke.store.blobs import Blobs
from treestroke.store.data_folder import known_revisions
from treestroke.store.database import Database, upgrade
from treestroke.store.leases import queue_running
from treestroke.store.objects import Damaged, Verified, pieces_of, write_verified
from treestroke.store.scope import LOCAL, SERVICE
from treestroke.store.table_rows import fill, read
from treestroke.store.tables import BlobRow


def restore(source: BackupFolder, database: Database, blobs: Blobs, report: Report, verify: bool = False) -> Manifest:
    """Write a backup's blobs, then all rows in one transaction, and return what was restored.

    An older backup is brought up to date. Jobs that were running wait again. Each blob is compared with its name while
    it is copied; with ``verify``, all are before anything is written, and again where they are kept afterwards.

    Raises
    ------
    BackupError
        There is no whole backup, it is damaged or of a newer program, or database or place of the blobs are not empty.
    OSError
        There is no room, or the place of the blobs is away.
    """
    manifest = _checked(source)
    _check_teams(source, manifest, database)
    _check_empty(source, database, blobs)
    if verify:
        bad = _bad(source, manifest, report, lambda blob: Verified().check(source.blob(blob.team, blob.sha256)))
        if bad:
            raise _damaged(source.path, bad)
    _copy(source, manifest, blobs, report)
    with database.migrating() as connection:
        if inspect(connection).get_table_names():
            raise _not_empty(database.place)
        upgrade(connection, manifest.revision)
        _fill(connection, source, manifest, report)
        upgrade(connection)
        _settle(database, connection)
    if verify:
        bad = _bad(source, manifest, report, lambda blob: blobs.objects.verify(blob.team, blob.sha256))
        if bad:
            raise _damaged(blobs.objects.place, bad)
    return manifest


def _checked(source: BackupFolder) -> Manifest:
    """Return what a backup tells of itself, if this program can restore it and its rows are as they were written."""
    manifest = source.manifest()
    if manifest is None:
        raise BackupError(
            f"{source.path}: there is no whole backup in it; name the folder of one that `treestroke backup` finished"
        )
    if manifest.revision not in known_revisions():
        raise BackupError(
            f"{source.path}: treestroke {manifest.version}, which is newer, made this backup (its version is "
            f"{manifest.revision}, this one knows up to {max(known_revisions())}); install that treestroke"
        )
    if bad := source.damaged_tables(manifest):
        raise _damaged(source.path, bad)
    return manifest


def _check_teams(source: BackupFolder, manifest: Manifest, database: Database) -> None:
    """Check that what teams made is seen where it is restored to: without a database of its own a service has none."""
    rows = read(source.tables(manifest.number), TeamRow.__tablename__)
    teams = [row["name"] for row in rows if row["team"] != LOCAL.team]
    if teams and not database.url:
        raise BackupError(
            f"{source.path}: it holds what teams made ({teams[0]!r} is one), which only a service for teams shows; set "
            "TREESTROKE_DATABASE_URL"
        )


def _check_empty(source: BackupFolder, database: Database, blobs: Blobs) -> None:
    """Check that nothing is there but what a restore of the same backup, which was interrupted, has left."""
    if not database.empty():
        raise _not_empty(database.place)
    for team, sizes in blobs.objects.pages():
        if any(not source.blob(team, name).exists() for name in sizes):
            raise _not_empty(blobs.objects.place)


def _not_empty(place: str) -> BackupError:
    return BackupError(f"{place}: it is not empty; restore into a new database and a new data folder or bucket")


def _copy(source: BackupFolder, manifest: Manifest, blobs: Blobs, report: Report) -> None:
    done = 0
    for blob in source.blobs(manifest.number):
        report("files", done / max(manifest.bytes, 1))
        path = source.blob(blob.team, blob.sha256)
        with blobs.temporary() as temporary:
            try:
                write_verified(temporary, blob.sha256, pieces_of(path))
            except Damaged as error:
                raise _damaged(source.path, [str(error)]) from error
            blobs.objects.take(blob.team, blob.sha256, temporary)
        done += path.stat().st_size


def _bad(source: BackupFolder, manifest: Manifest, report: Report, check: Callable[[BackedUp], object]) -> list[str]:
    """Check all blobs of a backup, and return what is wrong."""
    bad, count = list[str](), max(manifest.tables[BlobRow.__tablename__].rows, 1)
    for number, blob in enumerate(source.blobs(manifest.number)):
        report("verify", number / count)
        try:
            check(blob)
        except Damaged as error:
            bad.append(str(error))
    return bad


def _damaged(place: object, bad: Sequence[str]) -> BackupError:
    return BackupError(f"{place}: damaged files ({named(bad)}); restore another backup, or another copy of this one")


def _fill(connection: Connection, source: BackupFolder, manifest: Manifest, report: Report) -> None:
    counts = fill(connection, source.tables(manifest.number), manifest.tables, report)
    if counts != {name: told.rows for name, told in manifest.tables.items()}:
        raise _damaged(
            source.path, [f"{name}.jsonl" for name, told in manifest.tables.items() if counts.get(name) != told.rows]
        )


def _settle(database: Database, connection: Connection) -> None:
    """Let what was being done when the backup was made begin again, and give what one person made a team."""
    with database.of(SERVICE).within(connection) as session:
        queue_running(session)
        local = session.scalar(select(exists().where(BlobRow.team == LOCAL.team)))
        known = session.scalar(select(exists().where(TeamRow.team == LOCAL.team)))
        if database.url and local and not known:
            session.execute(insert(TeamRow).values(team=LOCAL.team, name=LOCAL.team, created=0.0))
        session.commit()
