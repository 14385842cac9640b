"""Which form a database has, told before anything else is started: this imports nothing that takes long."""

import os
import sqlite3
from contextlib import closing
from pathlib import Path

DATABASE = "treestroke.sqlite3"
_BLOBS = "blobs"
_MIGRATIONS = Path(__file__).parent / "migrations" / "versions"
_BUSY_SECONDS = 10


class Unusable(Exception):
    """The data folder or its database cannot be used; the message is one line: what, where, how to mend it."""


def check_version(folder: Path) -> None:
    """Refuse a database that a newer program made, or that is none; one that is not there yet is well.

    One that is lost is not: by an empty database all files are strays, and would be removed.

    Raises
    ------
    Unusable
        It is of another kind.
    """
    path = folder / DATABASE
    try:
        found = _revisions(path) if path.is_file() else set[str]()
    except sqlite3.DatabaseError as error:
        what = f"{path}: the database cannot be read ({error})"
        raise Unusable(f"{what}; restore it from a copy, or name another folder by --data") from error
    if not found and any(files for _, _, files in os.walk(folder / _BLOBS)):
        raise Unusable(
            f"{path}: the database is lost or empty, but there are files in {folder / _BLOBS}; restore it from a copy, "
            f"or move the folder {_BLOBS!r} away to begin anew"
        )
    if unknown := found - known_revisions():
        raise Unusable(
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
