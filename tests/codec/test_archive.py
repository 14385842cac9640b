import io
import tracemalloc
import zipfile
from contextlib import ExitStack
from pathlib import Path

from treestroke.codec.archive import zip_into, zipped


def test_members_come_back_in_their_order() -> None:
    members = {"tree.gltf": b"{}" * 500, "tree.bin": b"\0" * 100, "tree_leaf.png": b"P" * 100}
    with zipfile.ZipFile(io.BytesIO(zipped(members))) as archive:
        assert {name: archive.read(name) for name in archive.namelist()} == members
        kinds = {info.filename: info.compress_type for info in archive.infolist()}
    assert kinds["tree_leaf.png"] == zipfile.ZIP_STORED
    assert kinds["tree.gltf"] == zipfile.ZIP_DEFLATED


def test_equal_members_give_equal_bytes() -> None:
    assert zipped({"a.txt": b"A"}) == zipped({"a.txt": b"A"})


def test_files_are_packed_in_chunks_to_the_same_bytes(tmp_path: Path) -> None:
    members = {"photo.png": bytes(range(256)) * 80_000, "strokes.json": b"[1.5, 2.5], " * 500_000}
    for name, content in members.items():
        (tmp_path / name).write_bytes(content)
    wanted = zipped(members)
    with ExitStack() as files:
        out = files.enter_context((tmp_path / "out").open("w+b"))
        opened = {name: files.enter_context((tmp_path / name).open("rb")) for name in members}
        tracemalloc.start()
        zip_into(out, opened)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert (tmp_path / "out").read_bytes() == wanted
    assert peak < 5_000_000
