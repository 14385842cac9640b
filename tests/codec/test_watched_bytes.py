import io

from treestroke.codec.watched_bytes import WatchedBytes


def test_bytes_are_read_from_anywhere_as_of_a_file() -> None:
    file = io.BufferedReader(WatchedBytes(b"a tall tree", [].append))
    assert (file.read(1), file.seek(-4, io.SEEK_END), file.read(), file.read()) == (b"a", 7, b"tree", b"")


def test_each_further_share_is_told_once() -> None:
    told: list[float] = []
    file = WatchedBytes(bytes(100), told.append)
    for _ in range(2):
        file.seek(0)
        while file.read(4):
            pass
    assert told == [0.08 * step for step in range(1, 13)]
