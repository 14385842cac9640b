import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tests.api import sketched
from tests.api.corpora import saved

import treestroke
from treestroke.cli import main
from treestroke.codec.image import MAX_BYTES, MAX_PIXELS, MAX_STORED_BYTES, decode_photo, encode_stored
from treestroke.codec.project import Project, read_project, write_project
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
        packed(side_json=b"S"),
        packed(photo_jpg=b"P", side_json=b"S"),
        packed(strokes_json=b"S", side_json=b"S"),
        packed(strokes_json=b"S", front_json=b"F"),
        packed(photo_jpg=b"P", strokes_json=b"S", front_json=b"F"),
        packed(front_json=b"F", front_png=b"F"),
        packed(front_jpg=b"F"),
        packed(photo_jpg=b"P", strokes_json=b"S", settings_json=b"[]"),
        packed(photo_jpg=b"P", strokes_json=b"S", settings_json=b"{"),
        packed(photo_jpg=b"P", strokes_json=b"S", settings_json=b'{"seed": 1, "seed": 2}'),
    ],
)
def test_what_is_no_project_is_refused_by_name(data: bytes) -> None:
    with pytest.raises(TreestrokeError, match=r"^oak\.treestroke: "):
        read_project(data, "oak.treestroke")


def test_a_photo_may_be_as_large_as_a_stored_one(monkeypatch: pytest.MonkeyPatch) -> None:
    data = packed(photo_png=bytes(MAX_BYTES + 1), strokes_json=b"S")
    assert len(read_project(data, "oak.treestroke").photo) == MAX_BYTES + 1
    monkeypatch.setattr("treestroke.codec.project.MAX_STORED_BYTES", MAX_BYTES)
    with pytest.raises(TreestrokeError, match=r"^oak\.treestroke: photo\.png has more than 25 MB") as refused:
        read_project(data, "oak.treestroke")
    assert refused.value.code == "project_too_large"


@pytest.mark.parametrize("side", [64, 1000])
def test_no_stored_photo_is_larger_than_is_allowed(side: int) -> None:
    noise = np.random.default_rng(0).integers(0, 256, (side, 1000, 3), dtype=np.uint8)
    assert len(encode_stored(noise)) / noise.size < MAX_STORED_BYTES / (3 * MAX_PIXELS)


def test_what_is_written_is_read_back() -> None:
    project = Project(b"\xff\xd8P", b"S", {"height": 12.0, "seed": 3})
    assert read_project(write_project(project), "oak.treestroke") == project


@pytest.mark.parametrize(
    "project",
    [
        Project(None, None, {}, front=b"{}"),
        Project(None, None, {"seed": 1}, front=b"\x89PNG", side=b"{}", leaf=b"L", fruit=b"F"),
        Project(b"P", None, {}, front=b"{}", side=b"\x89PNG"),
        Project(b"P", b"S", {}, side=b"{}", fruit=b"F"),
    ],
)
def test_sketches_are_read_back_with_or_without_a_photo(project: Project) -> None:
    assert read_project(write_project(project), "oak.treestroke") == project


def test_a_sketch_is_named_by_its_content() -> None:
    data = write_project(Project(None, None, {}, front=b"{}", side=b"\x89PNG"))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.namelist() == ["front.json", "side.png", "settings.json"]


def test_either_command_opens_a_project_of_sketches(tmp_path: Path) -> None:
    front, side = (json.dumps(one).encode() for one in (sketched.FRONT, sketched.SIDE))
    project, settings = tmp_path / "drawn.treestroke", {"iterations": 5, "leaf_density": 0.1}
    project.write_bytes(write_project(Project(None, None, {**settings, "seed": 4}, front=front, side=side)))
    for command in ("model", "sketch"):
        assert main([command, str(project), "--out", str(tmp_path / f"{command}.glb")]) == 0
    by_library = treestroke.sketch(front, side, settings, 4).glb
    assert (tmp_path / "model.glb").read_bytes() == (tmp_path / "sketch.glb").read_bytes() == by_library


def test_equal_projects_give_equal_bytes_whenever_they_are_written() -> None:
    one, other = (Project(b"P", b"S", settings) for settings in ({"height": 1, "seed": 2}, {"seed": 2, "height": 1}))
    assert write_project(one) == write_project(other)
    with zipfile.ZipFile(io.BytesIO(write_project(one))) as archive:
        assert {info.date_time for info in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}


@pytest.mark.parametrize(
    ("kind", "ending"), [("JPEG", "jpg"), ("PNG", "png"), ("WEBP", "webp"), ("HEIF", "heic"), ("AVIF", "avif")]
)
def test_a_photo_is_named_by_its_content_and_not_compressed_again(kind: str, ending: str) -> None:
    content = saved(Image.new("RGB", (64, 64)), kind)
    with zipfile.ZipFile(io.BytesIO(write_project(Project(content, b"S", {})))) as archive:
        photo = archive.infolist()[0]
    assert (photo.filename, photo.compress_type) == (f"photo.{ending}", zipfile.ZIP_STORED)


def test_the_command_line_opens_what_is_written(
    tmp_path: Path, maple_photo: Path, maple_strokes: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stored = encode_stored(decode_photo(maple_photo.read_bytes(), "photo"))
    settings = {"iterations": 3, "leaf_density": 0.1}
    project = tmp_path / "maple.treestroke"
    project.write_bytes(write_project(Project(stored, maple_strokes.read_bytes(), {**settings, "seed": 4})))
    monkeypatch.setattr("treestroke.codec.image.MAX_BYTES", len(stored) - 1)
    assert main(["model", str(project), "--out", str(tmp_path / "a.glb")]) == 0
    assert (tmp_path / "a.glb").read_bytes() == treestroke.model(stored, maple_strokes, settings, 4).glb
