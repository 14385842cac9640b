"""The data folder: private to its user, with a database that this program can use. It imports nothing slow."""

import os
import sqlite3
import stat
from contextlib import closing
from pathlib import Path

DATABASE, BLOBS = "treestroke.sqlite3", "blobs"
_DATABASE_FILES = {DATABASE, *(f"{DATABASE}-{part}" for part in ("journal", "shm", "wal"))}
_SERVICE_NAMES = {BLOBS, "cache", "projects", "queue", "tmp", "uploads", *_DATABASE_FILES, "lock"}
"""Names that the service creates; ``lock`` is left of earlier versions."""
_FILE_SYSTEM_NAMES = {"lost+found"}
_MIGRATIONS = Path(__file__).parent / "migrations" / "versions"
_BUSY_SECONDS = 10


class DataFolderError(Exception):
    """The data folder or its database cannot be used; the message is one line: what, where, how to mend it."""


def prepare_folder(folder: Path) -> None:
    """Create the data folder, or make an existing one private; files of this process are private from now on.

    An existing folder's permissions are changed only if it has nothing but the service's files. Otherwise it may be a
    home folder, or shared on purpose.

    Raises
    ------
    DataFolderError
        Other users can read the folder, and it is not the service's alone.
    OSError
        The folder cannot be created.
    """
    os.umask(0o077)
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if not is_open_to_others(folder):
        return
    found = folder.stat()
    foreign = {path.name for path in folder.iterdir()} - _SERVICE_NAMES - _FILE_SYSTEM_NAMES
    if found.st_uid != os.geteuid() or foreign:
        why = f"it also holds {sorted(foreign)[0]!r}" if foreign else "it belongs to another user"
        raise DataFolderError(
            f"{folder}: other users of this machine can read it ({stat.filemode(found.st_mode)}), and {why}; "
            f"name a folder for treestroke alone, such as --data {folder / 'treestroke'}; or, if all of it is "
            f"treestroke's, run `chmod 700 {folder}`"
        )
    folder.chmod(0o700)


def is_open_to_others(folder: Path) -> bool:
    """Tell whether other users of this machine may read or change a folder."""
    return bool(folder.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO))


def check_version(folder: Path) -> None:
    """Check that this program can use the folder's database; a folder without database and files is new.

    Files without a database mean that it was lost. Served with an empty database, all of them would be removed, since
    no row refers to them.

    Raises
    ------
    DataFolderError
        The database is lost, cannot be read, or was made by a newer program.
    """
    path = folder / DATABASE
    other = "name another folder by --data"
    try:
        found = _revisions(path) if path.is_file() else set[str]()
    except sqlite3.DatabaseError as error:
        raise DataFolderError(
            f"{path}: the database cannot be read ({error}); restore it from a copy, or {other}"
        ) from error
    check_revisions(found, folder, str(path), other)


def check_revisions(found: set[str], folder: Path, place: str, other: str) -> None:
    """Check that this program can use tables of the revisions ``found`` with the files of a folder.

    ``place`` is where the database is, ``other`` how another one is named.

    Raises
    ------
    DataFolderError
        The database is lost, or was made by a newer program.
    """
    if not found and any(files for _, _, files in os.walk(folder / BLOBS)):
        raise DataFolderError(
            f"{place}: the database is lost or empty, but there are files in {folder / BLOBS}; restore it from a "
            f"copy, or move the folder {BLOBS!r} away to start with an empty database"
        )
    if unknown := found - known_revisions():
        raise DataFolderError(
            f"{place}: a newer treestroke made this database (its version is {', '.join(sorted(unknown))}, this one "
            f"knows up to {max(known_revisions())}); install that treestroke again, or {other}"
        )


def known_revisions() -> set[str]:
    """Return the revisions of the database that this program can use or migrate."""
    return {path.name.partition("_")[0] for path in _MIGRATIONS.glob("[0-9]*.py")}


def _revisions(path: Path) -> set[str]:
    with closing(sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True, timeout=_BUSY_SECONDS)) as database:
        made = database.execute("SELECT 1 FROM sqlite_master WHERE name = 'alembic_version'").fetchone()
        found = database.execute("SELECT version_num FROM alembic_version").fetchall() if made else []
    return {str(version) for (version,) in found}
