import hashlib
import os
import resource
import threading
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import pytest

from treestroke.store.blobs import Blobs, Damaged, state_of


@pytest.fixture
def blobs(tmp_path: Path) -> Blobs:
    return Blobs(tmp_path)


def left(blobs: Blobs) -> set[str]:
    return {path.name for path in blobs.folder.rglob("*") if path.is_file()}


def test_a_blob_is_named_by_its_sha256_and_read_back(blobs: Blobs) -> None:
    name = blobs.put(b"tree")
    assert name == hashlib.sha256(b"tree").hexdigest()
    assert blobs.get(name) == b"tree"
    assert blobs.path(name) == blobs.folder / name[:2] / name


def test_the_same_bytes_are_stored_once(blobs: Blobs) -> None:
    assert blobs.put(b"tree") == blobs.put(b"tree")
    assert len(left(blobs)) == 1


def test_many_may_store_the_same_bytes_at_once(blobs: Blobs) -> None:
    threads = [threading.Thread(target=blobs.put, args=(bytes(100_000),)) for _ in range(16)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert left(blobs) == {hashlib.sha256(bytes(100_000)).hexdigest()}


def flip(path: Path) -> None:
    """Turn one bit of a file, as a disk does that goes bad."""
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def test_a_damaged_blob_is_not_read(blobs: Blobs) -> None:
    name = blobs.put(b"tree")
    flip(blobs.path(name))
    for read in (blobs.get, blobs.check):
        with pytest.raises(Damaged, match=f"{name}: damaged"):
            read(name)
    blobs.path(name).unlink()
    for read in (blobs.get, blobs.check):
        with pytest.raises(Damaged, match=f"{name}: missing"):
            read(name)


@pytest.mark.parametrize(
    ("harm", "said"), [(Path.mkdir, "Is a directory"), (lambda path: path.symlink_to(path), "symbolic links")]
)
def test_what_cannot_be_read_is_damaged(blobs: Blobs, harm: Callable[[Path], None], said: str) -> None:
    path = blobs.path(blobs.put(b"tree"))
    path.unlink()
    harm(path)
    for read in (blobs.get, blobs.check):
        with pytest.raises(Damaged, match=f"{path.name}: .*{said}"):
            read(path.name)


def test_a_lack_of_descriptors_is_no_damage(blobs: Blobs) -> None:
    name = blobs.put(b"tree")
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (0, before[1]))
    try:
        for read in (blobs.get, blobs.check):
            with pytest.raises(OSError, match="Too many open files"):
                read(name)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


def test_storing_a_damaged_blob_again_mends_it(blobs: Blobs) -> None:
    name = blobs.put(b"tree")
    flip(blobs.path(name))
    assert blobs.put(b"tree") == name
    assert blobs.get(name) == b"tree"


def test_a_blob_that_was_checked_is_checked_again_once_it_was_written_to(blobs: Blobs) -> None:
    name = blobs.put(bytes(100_000))
    path, settled = blobs.path(name), time.time() + 1.1
    while time.time() < settled:
        time.sleep(0.05)
    assert blobs.check(name) == blobs.check(name) == path
    times = path.stat()
    flip(path)
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
    with pytest.raises(Damaged):
        blobs.check(name)


def test_checking_takes_no_more_memory_than_a_piece(blobs: Blobs) -> None:
    name = blobs.put(bytes(32 * 2**20))
    tracemalloc.start()
    try:
        blobs.check(name)
        assert tracemalloc.get_traced_memory()[1] < 2**20
    finally:
        tracemalloc.stop()


def test_places_are_all_files_folder_by_folder(blobs: Blobs) -> None:
    assert list(blobs.places()) == []
    names = [blobs.put(b"%d" % at) for at in range(20)]
    half = blobs.path(names[0]).with_name(".treestroke-0011")
    half.write_bytes(b"half")
    found = dict(blobs.places())
    assert {path for files in found.values() for path in files} == {half, *map(blobs.path, names)}
    assert all(path.parent.name == folder for folder, files in found.items() for path in files)


def test_a_file_is_removed_in_the_state_it_was_seen_in_alone(blobs: Blobs) -> None:
    path = blobs.path(blobs.put(b"tree"))
    before = state_of(path)
    blobs.put(b"tree")
    assert not blobs.remove(path, before)
    assert blobs.remove(path, state_of(path))
    assert not blobs.remove(path, before)
    assert left(blobs) == set()


def test_a_blob_that_is_written_again_while_it_is_removed_survives(blobs: Blobs) -> None:
    """Sweepers hold states that were true a moment ago, as after an hour: of each file the first that was seen."""
    contents = [b"%d" % at for at in range(20)]
    stale = {blobs.path(name): state_of(blobs.path(name)) for name in map(blobs.put, contents)}
    over = threading.Event()

    def sweep() -> None:
        while not over.is_set():
            for path, state in stale.items():
                blobs.remove(path, state)

    sweepers = [threading.Thread(target=sweep) for _ in range(3)]
    for sweeper in sweepers:
        sweeper.start()
    for _ in range(5):
        for content in contents:
            blobs.put(content)
    over.set()
    for sweeper in sweepers:
        sweeper.join()
    assert {blobs.get(path.name) for path in stale} == set(contents)
