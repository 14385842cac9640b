"""Uploads whose pieces reach several web processes, which share a database and a bucket."""

from pathlib import Path

import pytest
from sqlalchemy import delete

from treestroke.store import upload_pieces
from treestroke.store.blobs import Blobs, open_blobs
from treestroke.store.database import Database
from treestroke.store.scope import LOCAL
from treestroke.store.tables import UploadRow
from treestroke.store.upload_pieces import PieceUploads, open_uploads
from treestroke.store.uploads import Superseded, Uploads, WrongOffset

ID = "upl_1"


class Web:
    """What a web process has: its own folder, and the database and the bucket that all share."""

    def __init__(self, database: Database, folder: Path, bucket_url: str) -> None:
        self.blobs: Blobs = open_blobs(database, folder, bucket_url).of(LOCAL)
        self.uploads = PieceUploads(database, self.blobs).of(LOCAL)

    def send(self, offset: int, content: bytes) -> None:
        with self.uploads.adding(ID, offset) as writer:
            writer.write(content)

    def whole(self) -> bytes:
        with self.uploads.whole(ID) as path:
            return path.read_bytes()


@pytest.fixture
def webs(database: Database, tmp_path: Path, bucket_url: str) -> tuple[Web, Web]:
    with database.writing() as session:
        session.add(UploadRow(id=ID, name="", created=0.0))
    return Web(database, tmp_path / "one", bucket_url), Web(database, tmp_path / "two", bucket_url)


def test_pieces_may_reach_any_process_and_are_joined_at_any(webs: tuple[Web, Web]) -> None:
    one, two = webs
    one.send(0, b"abc")
    two.send(3, b"de")
    one.send(5, b"f")
    assert [web.whole() for web in webs] == [b"abcdef"] * 2
    assert (two.uploads.size(ID), two.uploads.total_size(), two.uploads.ids()) == (6, 6, [ID])
    assert list((one.blobs.data / "tmp").iterdir()) == []


@pytest.mark.parametrize("offset", [2, 4])
def test_a_piece_begins_where_the_last_one_ended(webs: tuple[Web, Web], offset: int) -> None:
    webs[0].send(0, b"abc")
    with pytest.raises(WrongOffset) as wrong:
        webs[1].send(offset, b"de")
    assert wrong.value.size == 3


def test_what_arrived_before_an_error_stays_and_what_is_long_is_stored_on_the_way(
    webs: tuple[Web, Web], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(upload_pieces, "_PIECE_BYTES", 4)
    one, two = webs

    def break_off() -> None:
        with one.uploads.adding(ID, 0) as writer:
            assert writer.write(b"abcdefghij") == 10
            assert two.uploads.size(ID) == 8
            raise ConnectionError

    with pytest.raises(ConnectionError):
        break_off()
    assert (two.uploads.size(ID), two.whole()) == (10, b"abcdefghij")


def test_a_request_that_another_process_has_overtaken_writes_no_more(webs: tuple[Web, Web]) -> None:
    one, two = webs

    def be_late() -> None:
        with one.uploads.adding(ID, 0) as lost:
            lost.write(b"abc")
            two.send(0, b"abcdef")

    with pytest.raises(Superseded):
        be_late()
    assert two.whole() == b"abcdef"


def test_asking_how_much_has_arrived_ends_a_request_of_the_same_process(webs: tuple[Web, Web]) -> None:
    with webs[0].uploads.adding(ID, 0) as lost:
        lost.write(b"abc")
        assert webs[0].uploads.size(ID) == 3
        with pytest.raises(Superseded):
            lost.write(b"late")
    assert webs[1].whole() == b"abc"


@pytest.mark.parametrize("by", ["request", "row"])
def test_what_is_removed_is_gone_for_all(webs: tuple[Web, Web], database: Database, by: str) -> None:
    webs[0].send(0, b"abc")
    if by == "request":
        webs[1].uploads.remove(ID)
    else:
        with database.writing() as session:
            session.execute(delete(UploadRow))
        with pytest.raises(Superseded):
            webs[1].send(0, b"abc")
    assert (webs[0].uploads.ids(), webs[0].uploads.size(ID)) == ([], 0)


def test_without_a_bucket_uploads_are_files(database: Database, tmp_path: Path) -> None:
    assert isinstance(open_uploads(database, open_blobs(database, tmp_path)), Uploads)
