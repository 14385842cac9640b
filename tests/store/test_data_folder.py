import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from treestroke.store.blobs import open_blobs
from treestroke.store.data_folder import DataFolderError, is_open_to_others, prepare_folder
from treestroke.store.database import Database
from treestroke.store.scope import LOCAL


@pytest.fixture(autouse=True)
def _umask() -> Iterator[None]:
    before = os.umask(0o022)
    yield
    os.umask(before)


def mode(path: Path) -> int:
    return path.stat().st_mode & 0o7777


def test_a_new_folder_and_all_that_is_put_there_are_this_user_s_alone(tmp_path: Path) -> None:
    folder = tmp_path / "a" / "data"
    prepare_folder(folder)
    database = Database(folder).of(LOCAL)
    database.migrate()
    open_blobs(database, folder).of(LOCAL).put(b"tree")
    database.close()
    assert {path for path in (folder, *folder.rglob("*")) if is_open_to_others(path)} == set()


def test_a_data_folder_that_others_may_look_into_is_closed(tmp_path: Path) -> None:
    for number, made in enumerate(
        [(), ("treestroke.sqlite3", "lock"), ("blobs", "lost+found"), ("projects", "treestroke.sqlite3-journal")]
    ):
        folder = tmp_path / str(number)
        folder.mkdir(0o755)
        for name in made:
            (folder / name).write_bytes(b"")
        prepare_folder(folder)
        assert mode(folder) == 0o700


def test_a_folder_of_other_things_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    folder = tmp_path / "home"
    folder.mkdir(0o755)
    (folder / "treestroke.sqlite3").write_bytes(b"")
    (folder / "holiday.jpg").write_bytes(b"")
    with pytest.raises(DataFolderError, match=r"drwxr-xr-x.*'holiday.jpg'; name a folder for treestroke alone"):
        prepare_folder(folder)
    assert mode(folder) == 0o755
    folder.chmod(0o700)
    prepare_folder(folder)  # its user has closed it


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may give a folder away")
def test_a_folder_of_another_user_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    folder = tmp_path / "theirs"
    folder.mkdir(0o755)
    os.chown(folder, 12345, 12345)
    with pytest.raises(DataFolderError, match="belongs to another user"):
        prepare_folder(folder)
    assert mode(folder) == 0o755
