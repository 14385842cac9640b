"""The data folder: this user's alone."""

import os
import stat
from pathlib import Path

from treestroke.store.versions import DATABASE, Unusable

_DATABASE_FILES = {DATABASE, *(f"{DATABASE}-{part}" for part in ("journal", "shm", "wal"))}
_OURS = {"blobs", "projects", "queue", "tmp", *_DATABASE_FILES, "lock"}
"""What the service makes; ``lock`` lies in folders that earlier versions served."""
_OF_THE_DISK = {"lost+found"}


def own_folder(folder: Path) -> None:
    """Make the data folder, or see to it that nobody else may look into the one that is there.

    A folder that holds nothing but ours is closed to others. One that holds more is left as it is: it may be a home, or
    everybody's. Whatever this process makes from now on is this user's alone as well.

    Raises
    ------
    Unusable
        The folder is open to others, and not plainly ours.
    OSError
        It cannot be made.
    """
    os.umask(0o077)
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    if not open_to_others(folder):
        return
    found = folder.stat()
    strange = {path.name for path in folder.iterdir()} - _OURS - _OF_THE_DISK
    if found.st_uid != os.geteuid() or strange:
        why = f"it also holds {sorted(strange)[0]!r}" if strange else "it belongs to another user"
        raise Unusable(
            f"{folder}: others on this machine may look into it ({stat.filemode(found.st_mode)}), and {why}; "
            f"name a folder of its own, such as --data {folder / 'treestroke'}; or, where all of it is the service's, "
            f"`chmod 700 {folder}`"
        )
    folder.chmod(0o700)


def open_to_others(folder: Path) -> bool:
    """Tell whether another user of this machine may look into a folder, or change it."""
    return bool(folder.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO))
