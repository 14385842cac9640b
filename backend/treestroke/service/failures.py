"""Failures that the input did not cause: their codes, and what the user is told."""

import errno
import sqlite3
from typing import Any

import cv2
from sqlalchemy.exc import DataError, DBAPIError, InterfaceError, OperationalError
from sqlalchemy.exc import TimeoutError as NoConnection

from treestroke.core.errors import TreestrokeError
from treestroke.store.objects import StorageAway

_DETAILS = {
    "worker_lost": (
        "The process that worked on this ended unexpectedly three times. Try again; if it happens again, report it.",
        True,
    ),
    "time_limit": ("This took longer than the service allows. Try fewer iterations, or fewer photos.", False),
    "out_of_memory": ("This needs more memory than the service allows. Try a smaller photo, or fewer photos.", False),
    "input_damaged": (
        "A stored file that this is made of is damaged or missing. Upload the photo again, then try again.",
        False,
    ),
    "engine_error": ("This could not be done. It is an error in treestroke; the log has the details.", False),
    "storage_full": ("The service's disk is full. Free some space, then try again.", True),
    "storage_read_only": ("The service may not write to its data folder. Make its user the folder's owner.", True),
    "storage_broken": ("The service's disk or database cannot be read or written. See `treestroke doctor`.", False),
    "storage_unavailable": ("The place of the files does not respond at the moment. Try again.", True),
    "file_missing": ("A file is missing on the service's disk. See `treestroke doctor`.", False),
    "too_many_files": ("The service has reached its limit of open files and connections. Try again.", True),
    "database_busy": ("The database is busy. Try again.", True),
    "text_unusable": ("A text holds the character NUL, which cannot be kept. Leave it out.", False),
    "database_unavailable": ("The database cannot be opened at the moment. Try again.", True),
}
_BY_ERRNO = {
    errno.ENOSPC: "storage_full",
    errno.EDQUOT: "storage_full",
    errno.EROFS: "storage_read_only",
    errno.EACCES: "storage_read_only",
    errno.EPERM: "storage_read_only",
    errno.EIO: "storage_broken",
    errno.ENOENT: "file_missing",
    errno.EMFILE: "too_many_files",
    errno.ENFILE: "too_many_files",
}
_BY_SQLITE = {
    sqlite3.SQLITE_FULL: "storage_full",
    sqlite3.SQLITE_READONLY: "storage_read_only",
    sqlite3.SQLITE_IOERR: "storage_broken",
    sqlite3.SQLITE_CORRUPT: "storage_broken",
    sqlite3.SQLITE_NOTADB: "storage_broken",
    sqlite3.SQLITE_BUSY: "database_busy",
    sqlite3.SQLITE_LOCKED: "database_busy",
    sqlite3.SQLITE_CANTOPEN: "database_unavailable",
}
_BY_SQLSTATE = {
    "08": "database_unavailable",
    "25006": "database_unavailable",  # it became a standby, which accepts no changes
    "25P03": "database_busy",  # this process was too slow in a transaction
    "40": "database_busy",  # a deadlock, or rows that another transaction has changed
    "53": "database_busy",
    "53100": "storage_full",
    "55P03": "database_busy",
    "57": "database_unavailable",
    "57014": "database_busy",
    "58": "storage_broken",
    "XX": "storage_broken",
}
"""Codes by Postgres's error code, or its first two characters, which name a class of errors."""
WORTH_WAITING = ("database_busy", "database_unavailable")
"""Failures of the database that pass by themselves."""


def problem_of(code: str) -> dict[str, Any]:
    """Return a failure as plain values: ``code``, ``detail``, and whether it is worth trying again (``retryable``)."""
    detail, retryable = _DETAILS[code]
    return {"code": code, "detail": detail, "retryable": retryable}


def code_of(error: Exception) -> str:
    """Return the code of an error of the system or the database; ``engine_error`` for any other error."""
    if ran_out_of_memory(error):
        return "out_of_memory"
    if isinstance(error, StorageAway):
        return "storage_unavailable"
    if isinstance(error, NoConnection):
        return "database_busy"
    if isinstance(error, DBAPIError):
        return _code_of_database(error)
    return _BY_ERRNO.get((isinstance(error, OSError) and error.errno) or 0, "engine_error")


def _code_of_database(error: DBAPIError) -> str:
    if not hasattr(error.orig, "sqlstate"):
        # The low byte is SQLite's primary result code, the others extend it.
        return _BY_SQLITE.get(getattr(error.orig, "sqlite_errorcode", 0) & 0xFF, "engine_error")
    state: str | None = getattr(error.orig, "sqlstate", None)
    if state is None and isinstance(error, DataError):  # the driver did not even send it
        return "text_unusable"
    if state is None:  # the server said nothing: it cannot be reached, or the connection is lost
        return "database_unavailable" if isinstance(error, OperationalError | InterfaceError) else "engine_error"
    return _BY_SQLSTATE.get(state) or _BY_SQLSTATE.get(state[:2], "engine_error")


def problem_of_input(error: TreestrokeError) -> dict[str, Any]:
    """Return an error of the input as plain values."""
    return {"code": "input_unusable", "detail": str(error), "retryable": False}


def ran_out_of_memory(error: Exception) -> bool:
    """Tell whether an error means that memory ran out; OpenCV has an error of its own for that."""
    return isinstance(error, MemoryError) or (isinstance(error, cv2.error) and error.code == cv2.Error.StsNoMem)
