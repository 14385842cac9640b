import errno
import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest
from sqlalchemy import create_engine, text
from sqlalchemy.exc import DBAPIError
from sqlalchemy.pool import QueuePool

from treestroke.service.failures import code_of, problem_of


def caught(fail: Callable[[], object], kind: type[Exception] = OSError) -> Exception:
    with pytest.raises(kind) as raised:
        fail()
    return raised.value


def test_a_missing_file_is_no_full_disk(tmp_path: Path) -> None:
    assert code_of(caught((tmp_path / "blob").read_bytes)) == "file_missing"


def test_a_full_disk_is_named_so() -> None:
    def fill() -> None:
        with Path("/dev/full").open("wb") as disk:
            disk.write(b"1")

    assert code_of(caught(fill)) == "storage_full"


@pytest.mark.parametrize(
    ("number", "code"),
    [
        (errno.EDQUOT, "storage_full"),
        (errno.EMFILE, "too_many_files"),
        (errno.ENFILE, "too_many_files"),
        (errno.EROFS, "storage_read_only"),
        (errno.EACCES, "storage_read_only"),
        (errno.EIO, "storage_broken"),
        (errno.EPIPE, "engine_error"),
    ],
)
def test_what_the_system_says_has_a_name_each(number: int, code: str) -> None:
    assert code_of(OSError(number, "")) == code


def said_by(path: str | Path, *statements: str, **options: object) -> str:
    """Say statements to a database until one fails; name how."""
    with create_engine(f"sqlite:///{path}", connect_args=options).connect() as connection:
        error = caught(lambda: [connection.execute(text(one)) for one in statements], DBAPIError)
        return code_of(error)


def test_what_the_database_says_has_a_name_each(tmp_path: Path) -> None:
    path, torn = tmp_path / "a.sqlite3", tmp_path / "torn.sqlite3"
    torn.write_bytes(b"no database at all, and long enough to see that" * 20)
    with sqlite3.connect(path) as other:
        other.execute("CREATE TABLE t (a)")
        other.commit()
        assert said_by(path, "PRAGMA max_page_count = 3", "INSERT INTO t VALUES (randomblob(90000))") == "storage_full"
        assert said_by(f"file:{path}?mode=ro&uri=true", "INSERT INTO t VALUES (1)") == "storage_read_only"
        assert said_by(torn, "SELECT * FROM t") == "storage_broken"
        other.execute("BEGIN EXCLUSIVE")
        assert said_by(path, "INSERT INTO t VALUES (1)", timeout=0) == "database_busy"
    other.close()
    no_place = create_engine(f"sqlite:///{tmp_path}/none/a.sqlite3")
    assert code_of(caught(no_place.connect, DBAPIError)) == "database_unavailable"


def test_a_pool_without_a_free_connection_is_a_busy_database(tmp_path: Path) -> None:
    path = f"sqlite:///{tmp_path}/a.sqlite3"
    engine = create_engine(path, poolclass=QueuePool, pool_size=1, max_overflow=0, pool_timeout=0.01)
    with engine.connect():
        assert code_of(caught(engine.connect, Exception)) == "database_busy"


def test_a_mistake_in_a_query_is_ours(tmp_path: Path) -> None:
    assert said_by(tmp_path / "a.sqlite3", "SELECT nonsense") == "engine_error"


def test_every_failure_says_what_to_do_in_one_line() -> None:
    for code in (
        "storage_unavailable",
        "storage_full",
        "file_missing",
        "too_many_files",
        "database_busy",
        "worker_lost",
    ):
        told = problem_of(code)
        assert told["code"] == code
        assert told["detail"].endswith(".")
        assert "\n" not in told["detail"]
