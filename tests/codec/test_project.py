import io
import json
import zipfile

import pytest

from treestroke.codec.project import read_project
from treestroke.core.errors import TreestrokeError


def packed(**members: bytes) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name, data in members.items():
            archive.writestr(name.replace("_", "."), data)
    return out.getvalue()


def test_a_project_gives_back_its_parts() -> None:
    settings = json.dumps({"height": 12, "seed": 3}).encode()
    project = read_project(packed(photo_jpg=b"P", strokes_json=b"S", settings_json=settings), "oak.treestroke")
    assert (project.photo, project.strokes, project.settings) == (b"P", b"S", {"height": 12, "seed": 3})


def test_settings_may_be_absent() -> None:
    assert read_project(packed(photo_png=b"P", strokes_json=b"S"), "oak.treestroke").settings == {}


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"no zip",
        packed(strokes_json=b"S"),
        packed(photo_jpg=b"P"),
        packed(photo_jpg=b"P", photo_png=b"P", strokes_json=b"S"),
        packed(photo_jpg=b"P", strokes_json=b"S", settings_json=b"[]"),
        packed(photo_jpg=b"P", strokes_json=b"S", settings_json=b"{"),
        packed(photo_jpg=bytes(26_000_000), strokes_json=b"S"),
    ],
)
def test_what_is_no_project_is_refused_by_name(data: bytes) -> None:
    with pytest.raises(TreestrokeError, match=r"^oak\.treestroke: "):
        read_project(data, "oak.treestroke")
