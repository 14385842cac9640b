import hashlib
import os
import threading
import time
from pathlib import Path

import pytest

from treestroke.store.blobs import Blobs

HOUR = 3600.0


@pytest.fixture
def blobs(tmp_path: Path) -> Blobs:
    return Blobs(tmp_path)


def aged(blobs: Blobs, content: bytes) -> str:
    """Store bytes as if it had been two hours ago."""
    name = blobs.put(content)
    then = time.time() - 2 * HOUR
    os.utime(blobs.path(name), (then, then))
    return name


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


def test_a_sweep_removes_the_old_that_nobody_refers_to(blobs: Blobs) -> None:
    old, kept, young = aged(blobs, b"old"), aged(blobs, b"kept"), blobs.put(b"young")
    assert blobs.sweep({kept}, HOUR) == 1
    assert left(blobs) == {kept, young}
    assert old not in left(blobs)


def test_a_sweep_of_nothing_removes_nothing(tmp_path: Path) -> None:
    assert Blobs(tmp_path / "never").sweep(set(), 0) == 0


def test_storing_a_blob_again_makes_it_young(blobs: Blobs) -> None:
    name = aged(blobs, b"tree")
    blobs.put(b"tree")
    assert blobs.sweep(set(), HOUR) == 0
    assert blobs.get(name) == b"tree"


def test_what_interrupted_writers_and_sweepers_left_goes_too(blobs: Blobs) -> None:
    name = aged(blobs, b"tree")
    then = time.time() - 2 * HOUR
    for stray in (".treestroke-0011", ".swept-0011"):
        path = blobs.path(name).with_name(stray)
        path.write_bytes(b"half")
        os.utime(path, (then, then))
    assert blobs.sweep({name}, HOUR) == 2
    assert left(blobs) == {name}


def test_a_blob_that_is_written_again_while_it_is_swept_survives(blobs: Blobs) -> None:
    contents = [b"%d" % at for at in range(20)]
    names = [aged(blobs, content) for content in contents]
    over = threading.Event()

    def sweep() -> None:
        while not over.is_set():
            blobs.sweep(set(), HOUR)

    sweepers = [threading.Thread(target=sweep) for _ in range(3)]
    for sweeper in sweepers:
        sweeper.start()
    for _ in range(5):
        for content, name in zip(contents, names, strict=True):
            blobs.put(content)
            then = time.time() - 2 * HOUR
            if content != contents[-1]:
                try:
                    os.utime(blobs.path(name), (then, then))
                except FileNotFoundError:
                    raise AssertionError("a young blob was swept") from None
    for content in contents:
        blobs.put(content)
    over.set()
    for sweeper in sweepers:
        sweeper.join()
    assert {blobs.get(name) for name in names} == set(contents)
