from pathlib import Path

import pytest

from treestroke.store.uploads import Superseded, Uploads, WrongOffset


@pytest.fixture
def uploads(tmp_path: Path) -> Uploads:
    return Uploads(tmp_path)


def test_pieces_follow_each_other(uploads: Uploads) -> None:
    with uploads.adding("upl_1", 0) as writer:
        assert writer.write(b"abc") == 3
    with uploads.adding("upl_1", 3) as writer:
        assert writer.write(b"de") == 5
    assert uploads.path("upl_1").read_bytes() == b"abcde"
    assert (uploads.size("upl_1"), uploads.total_size(), uploads.ids()) == (5, 5, ["upl_1"])


@pytest.mark.parametrize("offset", [2, 4])
def test_a_piece_begins_where_the_last_one_ended(uploads: Uploads, offset: int) -> None:
    with uploads.adding("upl_1", 0) as writer:
        writer.write(b"abc")
    with pytest.raises(WrongOffset) as wrong, uploads.adding("upl_1", offset):
        pass
    assert wrong.value.size == 3


def test_what_was_written_before_an_error_stays(uploads: Uploads) -> None:
    def break_off() -> None:
        with uploads.adding("upl_1", 0) as writer:
            writer.write(b"abc")
            raise ConnectionError

    with pytest.raises(ConnectionError):
        break_off()
    assert uploads.size("upl_1") == 3


def test_asking_how_much_has_arrived_ends_a_request_that_nobody_sends_any_more(uploads: Uploads) -> None:
    with uploads.adding("upl_1", 0) as lost:
        lost.write(b"abc")
        assert uploads.size("upl_1") == 3
        with pytest.raises(Superseded):
            lost.write(b"late")
    with uploads.adding("upl_1", 3) as writer:
        writer.write(b"def")
    assert uploads.path("upl_1").read_bytes() == b"abcdef"


def test_only_one_request_makes_something_of_an_upload(uploads: Uploads) -> None:
    with uploads.finishing("upl_1"):
        with pytest.raises(Superseded), uploads.finishing("upl_1"):
            pass
        with uploads.finishing("upl_2"):
            pass
    with uploads.finishing("upl_1"):
        pass


def test_what_is_removed_is_gone(uploads: Uploads) -> None:
    with uploads.adding("upl_1", 0) as writer:
        writer.write(b"abc")
    uploads.remove("upl_1")
    uploads.remove("upl_1")
    assert (uploads.ids(), uploads.size("upl_1")) == ([], 0)
