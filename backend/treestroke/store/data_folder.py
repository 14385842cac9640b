"""The data folder: private to its user, with a database that this program can use. It imports nothing slow."""

import os
import sqlite3
import stat
from contextlib import closing
from pathlib import Path

DATABASE = "treestroke.sqlite3"
_DATABASE_FILES = {DATABASE, *(f"{DATABASE}-{part}" for part in ("journal", "shm", "wal"))}
_OURS = {"blobs", "projects", "queue", "tmp", *_DATABASE_FILES, "lock"}
"""What the service makes; ``lock`` lies in folders that earlier versions served."""
_OF_THE_DISK = {"lost+found"}
_BLOBS = "blobs"
_MIGRATIONS = Path(__file__).parent / "migrations" / "versions"
_BUSY_SECONDS = 10


class DataFolderError(Exception):
    """The data folder or its database cannot be used; the message is one line: what, where, how to mend it."""


def prepare_folder(folder: Path) -> None:
    """Make the data folder, or see to it that nobody else may look into the one that is there.

    A folder that holds nothing but ours is closed to others. One that holds more is left as it is: it may be a home, or
    everybody's. Whatever this process makes from now on is this user's alone as well.

    Raises
    ------
    DataFolderError
        The folder is open to others, and not plainly ours.
    OSError
        It cannot be made.
    """
    os.umask(0o077)
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if not is_open_to_others(folder):
        return
    found = folder.stat()
    strange = {path.name for path in folder.iterdir()} - _OURS - _OF_THE_DISK
    if found.st_uid != os.geteuid() or strange:
        why = f"it also holds {sorted(strange)[0]!r}" if strange else "it belongs to another user"
        raise DataFolderError(
            f"{folder}: others on this machine may look into it ({stat.filemode(found.st_mode)}), and {why}; "
            f"name a folder of its own, such as --data {folder / 'treestroke'}; or, where all of it is the service's, "
            f"`chmod 700 {folder}`"
        )
    folder.chmod(0o700)


def is_open_to_others(folder: Path) -> bool:
    """Tell whether another user of this machine may look into a folder, or change it."""
    return bool(folder.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO))


def check_version(folder: Path) -> None:
    """Refuse a database that a newer program made, or that is none; one that is not there yet is well.

    One that is lost is not: by an empty database all files are strays, and would be removed.

    Raises
    ------
    DataFolderError
        It is of another kind.
    """
    path = folder / DATABASE
    try:
        found = _revisions(path) if path.is_file() else set[str]()
    except sqlite3.DatabaseError as error:
        what = f"{path}: the database cannot be read ({error})"
        raise DataFolderError(f"{what}; restore it from a copy, or name another folder by --data") from error
    if not found and any(files for _, _, files in os.walk(folder / _BLOBS)):
        raise DataFolderError(
            f"{path}: the database is lost or empty, but there are files in {folder / _BLOBS}; restore it from a copy, "
            f"or move the folder {_BLOBS!r} away to begin anew"
        )
    if unknown := found - known_revisions():
        raise DataFolderError(
            f"{path}: a newer treestroke made this database (its version is {', '.join(sorted(unknown))}, this one "
            f"knows up to {max(known_revisions())}); install that treestroke again, or name another folder by --data"
        )


def known_revisions() -> set[str]:
    """Give the versions of the database that this program can read or bring up to date."""
    return {path.name.partition("_")[0] for path in _MIGRATIONS.glob("[0-9]*.py")}


def _revisions(path: Path) -> set[str]:
    with closing(sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True, timeout=_BUSY_SECONDS)) as database:
        made = database.execute("SELECT 1 FROM sqlite_master WHERE name = 'alembic_version'").fetchone()
        found = database.execute("SELECT version_num FROM alembic_version").fetchall() if made else []
    return {str(version) for (version,) in found}
