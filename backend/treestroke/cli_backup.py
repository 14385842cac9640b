"""`treestroke backup` and `treestroke restore`: the service's rows and files in a folder, and back."""

import argparse
import os
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from treestroke.cli_outputs import ProgressLine
from treestroke.core.progress import Report, silent
from treestroke.store.data_folder import DataFolderError, prepare_folder

if TYPE_CHECKING:
    from treestroke.settings import Settings

_PATIENCE_SECONDS = 120.0
"""Time that the place of the blobs has to come back."""


def add_backup_flags(command: argparse.ArgumentParser) -> None:
    """Add what `treestroke backup` takes."""
    command.add_argument("folder", metavar="FOLDER", type=Path, help="folder for backups alone, made where it is new")


def add_restore_flags(command: argparse.ArgumentParser) -> None:
    """Add what `treestroke restore` takes."""
    command.add_argument("folder", metavar="FOLDER", type=Path, help="folder that `treestroke backup` wrote")
    command.add_argument("--verify", action="store_true", help="compare every file with its SHA-256, before and after")


def backup(settings: "Settings", options: argparse.Namespace) -> None:
    """Write all rows and files of a service, which may run, into a folder.

    Raises
    ------
    DataFolderError
        There is no whole backup in the folder, or only an earlier one.
    """
    from treestroke.service.backup import back_up
    from treestroke.store.backup_folder import BackupFolder
    from treestroke.store.blobs import open_blobs
    from treestroke.store.database import Database

    os.umask(0o077)  # what is copied is as private as it was
    mend = "mend that and run it again: what was copied is kept, and an earlier backup in the folder is still whole"
    database = Database(settings.folder, settings.database_url)
    with _one_line(f"{options.folder}: the backup was not finished", mend), _progress() as report, closing(database):
        blobs = open_blobs(database, settings.folder, settings.bucket_url, _PATIENCE_SECONDS)
        back_up(database, blobs, BackupFolder(options.folder), report)


def restore(settings: "Settings", options: argparse.Namespace) -> None:
    """Write the rows and files of a backup into an empty database and an empty data folder or bucket.

    Raises
    ------
    DataFolderError
        Nothing was restored; files may have been written, and no row.
    """
    from treestroke.service.restore import restore
    from treestroke.store.backup_folder import BackupFolder
    from treestroke.store.blobs import open_blobs
    from treestroke.store.database import Database

    mend = "mend that and run it again: no row was written"
    database = Database(settings.folder, settings.database_url, settings.owner_database_url)
    with _one_line(f"{options.folder}: it was not restored", mend), _progress() as report, closing(database):
        prepare_folder(settings.folder)
        blobs = open_blobs(database, settings.folder, settings.bucket_url, _PATIENCE_SECONDS)
        restore(BackupFolder(options.folder), database, blobs, report, options.verify)


@contextmanager
def _one_line(what: str, mend: str) -> Iterator[None]:
    """Turn what the system and the database say into one line that says what was not done, and what to do."""
    from sqlalchemy.exc import SQLAlchemyError

    try:
        yield
    except SQLAlchemyError as error:
        raise DataFolderError(f"{what} ({getattr(error, 'orig', None) or error}); {mend}") from error
    except OSError as error:
        raise DataFolderError(f"{what} ({error.strerror or error}); {mend}") from error
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"{what} (interrupted); run it again") from None


@contextmanager
def _progress() -> Iterator[Report]:
    """Yield a report that shows the progress on a terminal, and nothing elsewhere."""
    line = ProgressLine(sys.stderr, 0) if sys.stderr.isatty() else None
    try:
        yield line or silent
    finally:
        if line:
            line.clear()
