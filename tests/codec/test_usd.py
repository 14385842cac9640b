import io
import sys
import zipfile

import numpy as np
import pytest
from tests.builders import stick

from treestroke.codec.usd import encode_usdz, package
from treestroke.core.errors import SettingsError
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import Surface
from treestroke.core.mesh.tubes import tubes

CAMERA = OrthographicCamera(640, 480, 0.01, (320.5, 450.25))
FILES = {"tree.usdc": b"scene", "textures/bark.jpg": b"x" * 100, "textures/leaf.png": b"y" * 7}


def test_a_package_is_a_plain_zip_with_the_scene_first() -> None:
    with zipfile.ZipFile(io.BytesIO(package(FILES))) as read:
        assert read.namelist() == list(FILES)
        assert {entry.compress_type for entry in read.infolist()} == {zipfile.ZIP_STORED}
        assert {name: read.read(name) for name in FILES} == FILES


def test_contents_start_at_multiples_of_64_bytes() -> None:
    packed = package(FILES)
    with zipfile.ZipFile(io.BytesIO(packed)) as read:
        for entry in read.infolist():
            head = packed[entry.header_offset : entry.header_offset + 30]
            start = (
                entry.header_offset + 30 + int.from_bytes(head[26:28], "little") + int.from_bytes(head[28:30], "little")
            )
            assert start % 64 == 0
            assert packed[start : start + entry.file_size] == FILES[entry.filename]


def test_equal_files_give_equal_packages() -> None:
    assert package(FILES) == package(dict(FILES))


def test_without_usd_core_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pxr", None)  # as if it were not installed
    bark = Surface(tubes(stick()), np.full((8, 4, 3), 90, np.uint8))
    with pytest.raises(SettingsError, match=r"pip install treestroke\[usd\]") as caught:
        encode_usdz(bark, None, CAMERA, "oak")
    assert (caught.value.code, caught.value.pointer) == ("usd_missing", "/files")
