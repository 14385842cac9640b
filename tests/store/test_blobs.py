"""Blobs in a folder and in a bucket of a real server: what holds for both, and with both databases."""

import hashlib
import os
import resource
import threading
import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import boto3
import pytest
from sqlalchemy import select

from treestroke.store.blobs import Blobs, open_blobs
from treestroke.store.database import Database
from treestroke.store.objects import Damaged, FolderObjects
from treestroke.store.scope import LOCAL, SERVICE, Foreign, Scope
from treestroke.store.tables import BlobRow

OAKS = Scope("team_oaks", "usr_ada")


@pytest.fixture(params=["folder", "bucket"])
def opened(request: pytest.FixtureRequest, tmp_path: Path, database: Database) -> Blobs:
    """The blobs of all teams."""
    url = request.getfixturevalue("bucket_url") if request.param == "bucket" else ""
    return open_blobs(database, tmp_path, url)


@pytest.fixture
def blobs(opened: Blobs) -> Blobs:
    return opened.of(LOCAL)


@pytest.fixture
def in_folder(tmp_path: Path, database: Database) -> Blobs:
    return open_blobs(database, tmp_path).of(LOCAL)


def left(blobs: Blobs) -> set[str]:
    return {name for _, sizes in blobs.objects.pages() for name in sizes}


def rows(database: Database) -> dict[tuple[str, str], BlobRow]:
    with database.of(SERVICE).reading() as session:
        return {(row.team, row.sha256): row for row in session.scalars(select(BlobRow))}


def harm(blobs: Blobs, name: str, content: bytes | None) -> None:
    """Change a stored object, as a disk does that goes bad, or remove it; a copy of it on this machine is gone."""
    if isinstance(blobs.objects, FolderObjects):
        path = blobs.path(name)
        path.unlink() if content is None else path.write_bytes(content)
        return
    bucket, _, prefix = blobs.objects.place.removeprefix("s3:" + "//").partition("/")
    client: Any = boto3.session.Session().client("s3")
    key = {"Bucket": bucket, "Key": f"{prefix}/local/{name[:2]}/{name}"}
    client.delete_object(**key) if content is None else client.put_object(**key, Body=content)
    for copy in (blobs.data / "cache").rglob(name):
        copy.unlink()


def test_a_blob_is_named_by_its_sha256_and_read_back(blobs: Blobs, database: Database) -> None:
    name = blobs.put(b"tree")
    assert name == hashlib.sha256(b"tree").hexdigest()
    assert blobs.get(name) == blobs.check(name).read_bytes() == b"tree"
    assert blobs.path(name).name == name
    row = rows(database)["local", name]
    assert (row.bytes, row.seen) == (4, None)


def test_the_same_bytes_are_stored_once(blobs: Blobs, database: Database) -> None:
    assert blobs.put(b"tree") == blobs.put(b"tree")
    assert len(left(blobs)) == len(rows(database)) == 1


def test_many_may_store_and_read_the_same_bytes_at_once(blobs: Blobs) -> None:
    read: list[bytes] = []
    threads = [threading.Thread(target=lambda: read.append(blobs.get(blobs.put(bytes(100_000))))) for _ in range(16)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert left(blobs) == {hashlib.sha256(bytes(100_000)).hexdigest()}
    assert read == [bytes(100_000)] * 16


def test_a_file_that_is_taken_is_a_blob_and_nowhere_else(blobs: Blobs) -> None:
    with blobs.temporary() as path:
        path.write_bytes(b"tree")
        blobs.take(path, hashlib.sha256(b"tree").hexdigest())
        assert not path.exists()
    assert blobs.get(hashlib.sha256(b"tree").hexdigest()) == b"tree"
    assert list((blobs.data / "tmp").iterdir()) == []


def test_blobs_are_their_teams_own(opened: Blobs, database: Database) -> None:
    mine, theirs = opened.of(LOCAL), opened.of(OAKS)
    name = mine.put(b"tree")
    with pytest.raises(Damaged, match="missing"):
        theirs.get(name)
    assert theirs.put(b"tree") == name
    assert set(rows(database)) == {("local", name), ("team_oaks", name)}
    assert sorted(team for team, sizes in opened.objects.pages() if name in sizes) == ["local", "team_oaks"]
    opened.objects.remove("local", [name])
    assert theirs.get(name) == b"tree"
    with pytest.raises(Foreign):
        opened.of(SERVICE).put(b"tree")


def test_files_of_the_only_team_are_where_they_always_were(in_folder: Blobs) -> None:
    name = in_folder.put(b"tree")
    assert in_folder.path(name) == in_folder.data / "blobs" / name[:2] / name
    assert in_folder.of(OAKS).path(name) == in_folder.data / "blobs" / "team_oaks" / name[:2] / name


def test_a_damaged_blob_is_not_read(blobs: Blobs) -> None:
    name = blobs.put(b"tree")
    for content, said in ((b"trie", "damaged"), (None, "missing")):
        harm(blobs, name, content)
        for read in (blobs.get, blobs.check, blobs.verify):
            with pytest.raises(Damaged, match=f"{name}: {said}"):
                read(name)
    blobs.put(b"tree")
    blobs.verify(name)
    assert blobs.get(name) == b"tree"


@pytest.mark.parametrize(
    ("harm", "said"), [(Path.mkdir, "Is a directory"), (lambda path: path.symlink_to(path), "symbolic links")]
)
def test_what_cannot_be_read_is_damaged(in_folder: Blobs, harm: Callable[[Path], None], said: str) -> None:
    path = in_folder.path(in_folder.put(b"tree"))
    path.unlink()
    harm(path)
    for read in (in_folder.get, in_folder.check, in_folder.verify):
        with pytest.raises(Damaged, match=f"{path.name}: .*{said}"):
            read(path.name)


def test_a_lack_of_descriptors_is_no_damage(in_folder: Blobs) -> None:
    name = in_folder.put(b"tree")
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (0, before[1]))
    try:
        for read in (in_folder.get, in_folder.check):
            with pytest.raises(OSError, match="Too many open files"):
                read(name)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


def test_a_blob_that_was_checked_is_checked_again_once_it_was_written_to(in_folder: Blobs) -> None:
    name = in_folder.put(bytes(100_000))
    path, settled = in_folder.path(name), time.time() + 1.1
    while time.time() < settled:
        time.sleep(0.05)
    assert in_folder.check(name) == in_folder.check(name) == path
    times = path.stat()
    path.write_bytes(bytes(99_999) + b"1")
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
    with pytest.raises(Damaged):
        in_folder.check(name)


def test_checking_takes_no_more_memory_than_a_piece(blobs: Blobs) -> None:
    name = blobs.put(bytes(32 * 2**20))
    blobs.put(b"")  # what is loaded at the first use
    tracemalloc.start()
    try:
        blobs.check(name)
        blobs.verify(name)
        assert tracemalloc.get_traced_memory()[1] < 8 * 2**20
    finally:
        tracemalloc.stop()


def test_pages_are_all_files_half_written_ones_too(in_folder: Blobs) -> None:
    assert list(in_folder.objects.pages()) == []
    names = {in_folder.put(b"%d" % at) for at in range(20)}
    half = in_folder.path(min(names)).with_name(".treestroke-0011")
    half.write_bytes(b"half")
    assert left(in_folder) == {*names, f"{half.parent.name}/{half.name}"}
    in_folder.objects.remove("local", [f"{half.parent.name}/{half.name}"])
    assert not half.exists()
