import io
import zipfile

from treestroke.codec.archive import zipped


def test_members_come_back_in_their_order() -> None:
    members = {"tree.gltf": b"{}" * 500, "tree.bin": b"\0" * 100, "tree_leaf.png": b"P" * 100}
    with zipfile.ZipFile(io.BytesIO(zipped(members))) as archive:
        assert {name: archive.read(name) for name in archive.namelist()} == members
        kinds = {info.filename: info.compress_type for info in archive.infolist()}
    assert kinds["tree_leaf.png"] == zipfile.ZIP_STORED
    assert kinds["tree.gltf"] == zipfile.ZIP_DEFLATED


def test_equal_members_give_equal_bytes() -> None:
    assert zipped({"a.txt": b"A"}) == zipped({"a.txt": b"A"})
