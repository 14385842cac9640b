import io
import json
import struct
import tracemalloc
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from tests.api import sketched
from tests.api.corpora import saved
from tests.clips import clip_bytes

import treestroke
from treestroke.cli import main
from treestroke.codec.image import MAX_PIXELS, MAX_STORED_BYTES, decode_photo, encode_stored
from treestroke.codec.inputs import PARTS, SOURCES, Part, Source
from treestroke.codec.project import Project, read_project, stored_inputs, write_project
from treestroke.core.errors import TreestrokeError
from treestroke.limits import MAX_PHOTO_BYTES


def packed(how: int = zipfile.ZIP_STORED, **members: bytes) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", how) as archive:
        for name, data in members.items():
            archive.writestr(name.replace("_", "."), data)
    return out.getvalue()


def opened(data: bytes) -> Project:
    return read_project(io.BytesIO(data), "oak.treestroke")


def project_of(settings: dict[str, Any], **parts: bytes) -> Project:
    return Project(stored_inputs(parts), settings)


def written(project: Project) -> bytes:
    out = io.BytesIO()
    write_project(out, {name: io.BytesIO(part) for name, part in project.inputs.parts.items()}, project.settings)
    return out.getvalue()


def test_a_project_gives_back_its_parts() -> None:
    settings = json.dumps({"height": 12, "seed": 3}).encode()
    project = opened(packed(photo_jpg=b"P", strokes_json=b"S", settings_json=settings))
    assert project == project_of({"height": 12, "seed": 3}, photo=b"P", strokes=b"S")
    assert project.inputs.source == "photo"


def test_settings_may_be_absent() -> None:
    assert opened(packed(photo_png=b"P", strokes_json=b"S")).settings == {}


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
        opened(data)


def png_of(width: int, height: int, size: int) -> bytes:
    """Begin a PNG of so many pixels, and go on with nothing up to a size."""
    head = b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sII", 13, b"IHDR", width, height)
    return head + bytes(size - len(head))


def test_a_photo_may_be_as_large_as_a_stored_one_of_its_pixels() -> None:
    size = 3 * 5000 * 5000
    assert len(opened(packed(photo_png=png_of(5000, 5000, size), strokes_json=b"S")).inputs.parts["photo"]) == size


@pytest.mark.parametrize("photo", [png_of(2000, 2000, MAX_PHOTO_BYTES + 1), b"\xff\xd8\xff" + bytes(MAX_PHOTO_BYTES)])
def test_a_photo_larger_than_its_pixels_need_is_refused(photo: bytes) -> None:
    with pytest.raises(
        TreestrokeError, match=r"^oak\.treestroke: photo\.png has 25\.0 MB, more than the 25\.0"
    ) as refused:
        opened(packed(zipfile.ZIP_DEFLATED, photo_png=photo, strokes_json=b"S"))
    assert refused.value.code == "project_too_large"


@pytest.mark.parametrize(
    "padded",
    [
        {"settings_json": 100_001},
        {"leaf_png": 4_000_001},
        {"side_png": 25_000_001},
        {"strokes_json": 64_000_001},
        {"strokes_json": 40_000_000, "side_json": 24_000_001},
    ],
)
def test_what_would_unpack_to_more_than_a_project_needs_is_not_unpacked(padded: dict[str, int]) -> None:
    members = {"photo_png": b"P", "strokes_json": b"S"} | {name: b" " * size for name, size in padded.items()}
    data = packed(zipfile.ZIP_DEFLATED, **members)
    del members
    tracemalloc.start()
    with pytest.raises(TreestrokeError, match="make it smaller") as refused:
        opened(data)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert refused.value.code == "project_too_large"
    assert peak < 3_000_000


def test_more_than_a_part_s_size_says_is_not_unpacked() -> None:
    data = bytearray(packed(zipfile.ZIP_DEFLATED, photo_png=png_of(64, 64, 50_000), strokes_json=b"S"))
    struct.pack_into("<I", data, data.index(b"PK\x01\x02") + 24, 10)
    with pytest.raises(TreestrokeError, match="not a readable project file") as refused:
        opened(bytes(data))
    assert refused.value.code == "project_unreadable"


def test_a_table_of_many_members_is_not_read() -> None:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for at in range(25_000):
            archive.writestr(zipfile.ZipInfo(f"{at}"), b"")
    with pytest.raises(TreestrokeError, match="its table of members is too long"):
        opened(out.getvalue())


def test_a_member_that_is_packed_in_another_way_is_refused() -> None:
    with pytest.raises(TreestrokeError, match="neither stored nor deflated"):
        opened(packed(zipfile.ZIP_LZMA, photo_png=b"P", strokes_json=b"S"))


@pytest.mark.parametrize("side", [64, 1000])
def test_no_stored_photo_is_larger_than_is_allowed(side: int) -> None:
    noise = np.random.default_rng(0).integers(0, 256, (side, 1000, 4), dtype=np.uint8)
    assert len(encode_stored(noise)) / noise.size < MAX_STORED_BYTES / (4 * MAX_PIXELS)


def test_what_is_written_is_read_back() -> None:
    project = project_of({"height": 12.0, "seed": 3}, photo=b"\xff\xd8P", strokes=b"S")
    assert opened(written(project)) == project


@pytest.mark.parametrize(
    "project",
    [
        project_of({}, front=b"{}"),
        project_of({"seed": 1}, front=b"\x89PNG", side=b"{}", leaf=b"L", fruit=b"F"),
        project_of({}, photo=b"P", front=b"{}", side=b"\x89PNG"),
        project_of({}, photo=b"P", strokes=b"S", side=b"{}", fruit=b"F"),
    ],
)
def test_sketches_are_read_back_with_or_without_a_photo(project: Project) -> None:
    assert opened(written(project)) == project


def test_a_sketch_is_named_by_its_content() -> None:
    data = written(project_of({}, front=b"{}", side=b"\x89PNG", leaf=b"\x89PNG"))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert archive.namelist() == ["front.json", "side.png", "settings.json", "leaf.png"]


def test_either_command_opens_a_project_of_sketches(tmp_path: Path) -> None:
    front, side = (json.dumps(one).encode() for one in (sketched.FRONT, sketched.SIDE))
    project, settings = tmp_path / "drawn.treestroke", {"iterations": 5, "leaf_density": 0.1}
    project.write_bytes(written(project_of({**settings, "seed": 4}, front=front, side=side)))
    for command in ("model", "sketch"):
        assert main([command, str(project), "--out", str(tmp_path / f"{command}.glb")]) == 0
    by_library = treestroke.sketch(front, side, settings, 4).glb
    assert (tmp_path / "model.glb").read_bytes() == (tmp_path / "sketch.glb").read_bytes() == by_library


def test_a_source_of_many_files_needs_no_more_than_its_description(monkeypatch: pytest.MonkeyPatch) -> None:
    photos = Part("photos", "photos", "photo", PARTS["photo"].formats, TreestrokeError, "", many=True)
    monkeypatch.setitem(PARTS, "photos", photos)
    monkeypatch.setitem(SOURCES, "photos", Source("photos", "photos", "photos", ("photos",), ("leaf",), "photos"))
    project = project_of({}, **{"photos/2": b"B", "leaf": b"\x89PNG", "photos/1": b"\xff\xd8A"})
    assert opened(written(project)) == project
    assert (project.inputs.source, set(project.inputs.parts)) == ("photos", {"photos/1", "photos/2", "leaf"})
    with pytest.raises(ValueError, match="not a part"):
        project_of({}, photos=b"A")


def test_equal_projects_give_equal_bytes_whenever_they_are_written() -> None:
    one, other = (
        project_of(settings, photo=b"P", strokes=b"S")
        for settings in ({"height": 1, "seed": 2}, {"seed": 2, "height": 1})
    )
    assert written(one) == written(other)
    with zipfile.ZipFile(io.BytesIO(written(one))) as archive:
        assert {info.date_time for info in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}


@pytest.mark.parametrize(
    ("kind", "ending"), [("JPEG", "jpg"), ("PNG", "png"), ("WEBP", "webp"), ("HEIF", "heic"), ("AVIF", "avif")]
)
def test_a_photo_is_named_by_its_content_and_not_compressed_again(kind: str, ending: str) -> None:
    content = saved(Image.new("RGB", (64, 64)), kind)
    with zipfile.ZipFile(io.BytesIO(written(project_of({}, photo=content, strokes=b"S")))) as archive:
        photo = archive.infolist()[0]
    assert (photo.filename, photo.compress_type) == (f"photo.{ending}", zipfile.ZIP_STORED)


def test_the_command_line_opens_what_is_written(
    tmp_path: Path, maple_photo: Path, maple_strokes: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stored = encode_stored(decode_photo(maple_photo.read_bytes(), "photo"))
    settings = {"iterations": 3, "leaf_density": 0.1}
    project = tmp_path / "maple.treestroke"
    project.write_bytes(written(project_of({**settings, "seed": 4}, photo=stored, strokes=maple_strokes.read_bytes())))
    monkeypatch.setattr("treestroke.codec.image.MAX_PHOTO_BYTES", len(stored) - 1)
    assert main(["model", str(project), "--out", str(tmp_path / "a.glb")]) == 0
    assert (tmp_path / "a.glb").read_bytes() == treestroke.model(stored, maple_strokes, settings, 4).glb


def test_a_project_keeps_a_clip_as_it_was_given(tmp_path: Path) -> None:
    clip = clip_bytes(tmp_path)
    project = project_of({"seed": 2}, clip=clip, frame_strokes=b'{"crown": {}}')
    assert project.inputs.source == "clip"
    again = opened(written(project))
    assert again == project
    with zipfile.ZipFile(io.BytesIO(written(project))) as archive:
        assert archive.namelist() == ["clip.avi", "frame_strokes.json", "settings.json"]
        assert archive.getinfo("clip.avi").compress_type == zipfile.ZIP_STORED
