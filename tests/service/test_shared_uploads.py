"""A clip in pieces that reach two web processes, which share a Postgres and a bucket and nothing else."""

import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest
from sqlalchemy import func, select
from tests.bucket import S3Server
from tests.clips import clip_bytes
from tests.postgres import PostgresServer

from treestroke.core.errors import ClipError
from treestroke.service import clips
from treestroke.service.photos import NotFound, Resources
from treestroke.service.tracing_pool import TracingPool
from treestroke.store.blobs import open_blobs
from treestroke.store.database import Database
from treestroke.store.objects import StorageAway
from treestroke.store.scope import LOCAL
from treestroke.store.tables import BlobRow, ClipRow, PieceRow
from treestroke.store.upload_pieces import open_uploads


def at_once(_: str, work: Callable[..., Any], *args: Any) -> Any:
    """Do the work of a tracing process here, which is as good for what is stored, and needs no time to start."""
    return work(*args)


@pytest.fixture
def webs(tmp_path: Path, postgres: PostgresServer, bucket_url: str) -> Iterator[list[Resources]]:
    """What two web processes have, each on a machine of its own."""
    tracers = cast("TracingPool", at_once)
    url, made = postgres.fresh_with_tables(), list[Resources]()
    for name in ("one", "two"):
        database = Database(tmp_path / name, url).of(LOCAL)
        blobs = open_blobs(database, tmp_path / name, bucket_url)
        uploads = open_uploads(database, blobs)
        made.append(Resources(database, blobs, tracers, tracers, tracers, uploads).of(LOCAL))
    yield made
    for web in made:
        web.database.close()


def send(web: Resources, id: str, offset: int, piece: bytes) -> None:
    assert clips.goes_on(web, id, offset)
    with web.uploads.adding(id, offset) as writer:
        writer.write(piece)


def count(web: Resources, table: type[ClipRow | PieceRow | BlobRow]) -> int:
    with web.database.reading() as session:
        return session.scalar(select(func.count()).select_from(table)) or 0


def test_pieces_reach_either_and_both_finish_one_clip(webs: list[Resources], tmp_path: Path) -> None:
    one, two = webs
    video = clip_bytes(tmp_path)
    half = len(video) // 2
    id = clips.begin_upload(one, "ash.avi", len(video)).id
    send(one, id, 0, video[:half])
    assert clips.get_upload(two, id)[1] == half
    send(two, id, half, video[half:])
    found: list[str] = []
    both = [threading.Thread(target=lambda web=web: found.append(clips.finish_upload(web, id).id)) for web in webs]
    for thread in both:
        thread.start()
    for thread in both:
        thread.join()
    assert len(found) == 2
    assert len(set(found)) == count(one, ClipRow) == 1
    assert clips.get_upload(one, id)[0].clip == found[0]
    assert count(one, PieceRow) == 0
    for web in webs:
        assert clips.get_clip(web, found[0]).bytes == len(video)
        assert clips.frame_jpeg(web, found[0], 7, 60).startswith(b"\xff\xd8")
        assert list((web.blobs.data / "tmp").rglob("*")) == []


def test_what_is_no_clip_is_removed_for_both(webs: list[Resources]) -> None:
    one, two = webs
    id = clips.begin_upload(one, "ash.avi").id
    send(two, id, 0, b"no video at all")
    with pytest.raises(ClipError):
        clips.finish_upload(one, id)
    with pytest.raises(NotFound):
        clips.get_upload(two, id)
    assert count(two, PieceRow) == 0


def test_a_piece_that_the_bucket_did_not_take_has_not_arrived(webs: list[Resources], mortal_s3: S3Server) -> None:
    """Takes over 20 s: a server starts twice."""
    database, folder = webs[0].database, webs[0].blobs.data
    blobs = open_blobs(database, folder, mortal_s3.fresh())
    web = replace(webs[0], blobs=blobs, uploads=open_uploads(database, blobs)).of(LOCAL)
    id = clips.begin_upload(web, "ash.avi").id
    send(web, id, 0, b"abc")
    mortal_s3.kill()
    with pytest.raises(StorageAway):
        send(web, id, 3, b"def")
    assert clips.get_upload(web, id)[1] == 3
    mortal_s3.start()
    send(web, id, 3, b"def")
    with web.uploads.whole(id) as path:
        assert path.read_bytes() == b"abcdef"
