import hashlib
import os
from pathlib import Path

import pytest

from treestroke.store.copies import Copies
from treestroke.store.objects import Damaged


def name_of(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def test_a_copy_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    copies, name = Copies(tmp_path), name_of(b"tree")
    assert copies.find("local", name) is None
    with pytest.raises(Damaged):
        copies.write("local", name, 4, [b"tr", b"ie"])
    assert copies.find("local", name) is None
    path = copies.write("local", name, 4, [b"tr", b"ee"])
    assert path == copies.find("local", name)
    assert path.read_bytes() == b"tree"
    assert [path for path in (tmp_path / "cache").rglob("*") if path.is_file()] == [path]


def test_what_was_used_longest_ago_makes_room(tmp_path: Path) -> None:
    copies, contents = Copies(tmp_path, max_bytes=250), [bytes([at]) * 100 for at in range(3)]
    for age, content in enumerate(contents[:2]):
        os.utime(copies.write("local", name_of(content), 100, [content]), (age, age))
    assert copies.find("local", name_of(contents[0]))  # counts as used
    copies.write("local", name_of(contents[2]), 100, [contents[2]])
    assert [copies.find("local", name_of(content)) is not None for content in contents] == [True, False, True]


def test_a_copy_that_is_larger_than_all_may_be_is_kept_until_the_next(tmp_path: Path) -> None:
    copies = Copies(tmp_path, max_bytes=50)
    large, small = bytes(100), b"tree"
    assert copies.write("local", name_of(large), 100, [large]).exists()
    assert copies.write("local", name_of(small), 4, [small]).exists()
    assert copies.find("local", name_of(large)) is None
