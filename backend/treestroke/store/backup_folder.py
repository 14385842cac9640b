"""A backup on disk: ``backup.json``, rows in ``tables/NUMBER/NAME.jsonl``, blobs in ``blobs/TEAM/ab/SHA-256``.

``backup.json`` is written last, and whole: without it there is no backup. Until the next backup is whole, it is that of
the one before, of which nothing is removed. So whatever interrupts a backup, what can be restored is whole.
"""

import fcntl
import os
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import groupby
from pathlib import Path
from typing import Annotated, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from treestroke.store.atomic_write import sync_folder, write_atomically
from treestroke.store.data_folder import DataFolderError
from treestroke.store.objects import sha256_of
from treestroke.store.table_rows import ENDING, TableFile, read
from treestroke.store.tables import BlobRow

_MANIFEST, _TABLES, _BLOBS, _LOCK = "backup.json", "tables", "blobs", "lock"
_MAX_NAMED = 3


class BackupError(DataFolderError):
    """A backup cannot be made, read or restored; the message is one line: what, where, how to mend it."""


def named(bad: Sequence[str]) -> str:
    """Return the first of what is wrong, and how many more there are."""
    more = f", and {len(bad) - _MAX_NAMED} more" if len(bad) > _MAX_NAMED else ""
    return ", ".join(bad[:_MAX_NAMED]) + more


class BackedUp(NamedTuple):
    """A blob of a backup, by its row."""

    team: str
    sha256: str
    bytes: int


class Manifest(BaseModel):
    """What ``backup.json`` tells of a backup: who wrote it, when, the revision of its tables, and what it holds."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    version: str
    revision: Annotated[str, Field(pattern=r"^\d+$")]
    created: str
    number: Annotated[int, Field(ge=1)]
    """The folder of its tables."""
    tables: dict[Annotated[str, Field(pattern=r"^[a-z_]+$")], TableFile]
    bytes: int
    """Size of its blobs."""


class BackupFolder:
    """The folder of a backup."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Make the folder, or check that it is a backup's; nobody else writes to it meanwhile.

        Raises
        ------
        BackupError
            It holds other things, or another backup is being written to it.
        OSError
            It cannot be written.
        """
        self.path.mkdir(mode=0o700, parents=True, exist_ok=True)
        foreign = {path.name for path in self.path.iterdir()} - {_MANIFEST, _TABLES, _BLOBS, _LOCK, "lost+found"}
        if foreign:
            raise BackupError(f"{self.path}: it also holds {min(foreign)!r}; name a folder for backups alone")
        with (self.path / _LOCK).open("ab") as lock:  # a file, since network file systems lock no folders
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise BackupError(f"{self.path}: another backup is being written; wait for its end") from None
            yield

    def manifest(self) -> Manifest | None:
        """Return what the folder tells of its backup; None where there is no whole one.

        Raises
        ------
        BackupError
            It cannot be understood.
        """
        try:
            return Manifest.model_validate_json((self.path / _MANIFEST).read_bytes())
        except (FileNotFoundError, NotADirectoryError):
            return None
        except ValidationError:
            raise BackupError(
                f"{self.path / _MANIFEST}: it is damaged, or of a newer treestroke; take another backup, or install "
                "that treestroke"
            ) from None

    def tables(self, number: int) -> Path:
        """Return the folder of a backup's tables."""
        return self.path / _TABLES / str(number)

    def new_tables(self, number: int) -> Path:
        """Return an empty folder for the tables of the next backup."""
        folder = self.tables(number)
        if folder.exists():  # of a backup that was not finished
            shutil.rmtree(folder)
        folder.mkdir(parents=True)
        return folder

    def blobs(self, number: int) -> Iterator[BackedUp]:
        """Yield the blobs of a backup, those of a team with the same first digits one after another."""
        for row in read(self.tables(number), BlobRow.__tablename__):
            yield BackedUp(row["team"], row["sha256"], row["bytes"])

    def blob(self, team: str, sha256: str) -> Path:
        """Return the path of a blob, which need not exist."""
        return self.path / _BLOBS / team / sha256[:2] / sha256

    def publish(self, manifest: Manifest) -> None:
        """Make a backup the one of this folder, once all of it is on disk, and remove what only others needed.

        Raises
        ------
        OSError
            The disk is full, or cannot be written.
        """
        for folder, _, _ in os.walk(self.path, topdown=False):
            sync_folder(Path(folder))
        write_atomically({self.path / _MANIFEST: manifest.model_dump_json(indent=2).encode() + b"\n"})
        for tables in (self.path / _TABLES).iterdir():
            if tables != self.tables(manifest.number):
                shutil.rmtree(tables)
        self._remove_blobs(manifest.number)

    def damaged_tables(self, manifest: Manifest) -> list[str]:
        """Return the names of files of tables that are not as they were written."""
        folder = self.tables(manifest.number)
        paths = {folder / f"{name}{ENDING}": told.sha256 for name, told in manifest.tables.items()}
        return [path.name for path, sha256 in paths.items() if not path.is_file() or sha256_of(path) != sha256]

    def _remove_blobs(self, number: int) -> None:
        """Remove all blobs but those of a backup."""
        kept = set[Path]()
        for folder, blobs in groupby(self.blobs(number), lambda blob: self.blob(blob.team, blob.sha256).parent):
            names = {blob.sha256 for blob in blobs}
            kept |= {folder, folder.parent}
            for path in folder.iterdir():
                if path.name not in names:
                    path.unlink()
        for team in (self.path / _BLOBS).glob("*"):
            for folder in (team, *team.glob("*")):
                if folder not in kept and folder.is_dir():
                    shutil.rmtree(folder)
