import hashlib
import io
import json
import os
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import httpx
import pytest
from PIL import Image
from tests.api import drawn
from tests.api.conftest import Service
from tests.running import BACKEND

from treestroke.store.data_folder import _SERVICE_NAMES

KINDS = {
    "tree.glb": "model/gltf-binary",
    "preview.png": "image/png",
    "strokes.json": "application/json",
    "project": "application/zip",
}


@pytest.fixture(params=KINDS)
def file(request: pytest.FixtureRequest, client: httpx.Client, made: dict[str, Any]) -> tuple[str, httpx.Response]:
    place = made["files"][request.param]
    return place, client.get(place)


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., bytes]:
    """Run the command line on something and give its GLB."""

    def run(*arguments: object) -> bytes:
        out = tmp_path_factory.mktemp("ran") / "tree.glb"
        command = [sys.executable, "-m", "treestroke", "model", *map(str, arguments), "--out", str(out)]
        subprocess.run(command, check=True, env={**os.environ, "PYTHONPATH": str(BACKEND)})
        return out.read_bytes()

    return run


def test_a_file_has_its_type_and_its_sha256_as_its_tag(file: tuple[str, httpx.Response]) -> None:
    place, answer = file
    assert answer.status_code == 200
    assert answer.headers["content-type"] == KINDS[place.rpartition("/")[2]]
    assert answer.headers["etag"] == f'"{hashlib.sha256(answer.content).hexdigest()}"'
    assert answer.headers["accept-ranges"] == "bytes"
    assert answer.headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize(
    ("asked", "wanted"),
    [
        ("bytes=0-3", slice(0, 4)),
        ("bytes=5-", slice(5, None)),
        ("bytes=-7", slice(-7, None)),
        ("bytes=9-999999999", slice(9, None)),
    ],
)
def test_a_part_is_sent(client: httpx.Client, file: tuple[str, httpx.Response], asked: str, wanted: slice) -> None:
    place, whole = file
    answer = client.get(place, headers={"Range": asked})
    assert (answer.status_code, answer.content) == (206, whole.content[wanted])
    first = range(len(whole.content))[wanted][0]
    told = f"bytes {first}-{first + len(answer.content) - 1}/{len(whole.content)}"
    assert answer.headers["content-range"] == told
    assert answer.headers["etag"] == whole.headers["etag"]


@pytest.mark.parametrize("asked", ["bytes=999999999-", "bytes=-0"])
def test_a_part_that_there_is_not_is_refused(
    client: httpx.Client, file: tuple[str, httpx.Response], asked: str
) -> None:
    place, whole = file
    answer = client.get(place, headers={"Range": asked})
    assert (answer.status_code, answer.headers["content-type"]) == (416, "application/problem+json")
    assert answer.headers["content-range"] == f"bytes */{len(whole.content)}"


@pytest.mark.parametrize(
    "asked", ["bytes=3-1", "bytes=a-b", "lines=0-3", "bytes", "bytes=0-1,3-4", "bytes=" + "9" * 30 + "-"]
)
def test_a_range_that_is_none_is_passed_over(client: httpx.Client, made: dict[str, Any], asked: str) -> None:
    answer = client.get(made["files"]["preview.png"], headers={"Range": asked})
    assert (answer.status_code, len(answer.content)) == (200, int(answer.headers["content-length"]))


def test_a_part_of_another_version_is_sent_whole(client: httpx.Client, file: tuple[str, httpx.Response]) -> None:
    place, whole = file
    same, other = (
        client.get(place, headers={"Range": "bytes=0-3", "If-Range": tag}) for tag in (whole.headers["etag"], '"other"')
    )
    assert (same.status_code, other.status_code) == (206, 200)


@pytest.mark.parametrize("known", ["{0}", '"other", {0}', "W/{0}", "*"])
def test_a_file_that_is_known_is_not_sent_again(
    client: httpx.Client, file: tuple[str, httpx.Response], known: str
) -> None:
    place, whole = file
    answer = client.get(place, headers={"If-None-Match": known.format(whole.headers["etag"])})
    assert (answer.status_code, answer.content) == (304, b"")
    assert answer.headers["etag"] == whole.headers["etag"]


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("The old oak", "The old oak"),
        ('Müller\'s "oak" 🌳', "Müller's _oak_ 🌳"),
        ("../../etc/passwd", ".._.._etc_passwd"),
        ("a\\b:c", "a_b_c"),
        ("..", ".."),
        ("樹" * 200, "樹" * 200),
        ("<script>%0d%0a;filename=x", "_script_%0d%0a;filename=x"),
    ],
)
def test_a_download_is_named_after_the_model(service: Service, photo: str, name: str, wanted: str) -> None:
    model = service.make(**drawn.request(photo, name=name))
    for file, ending in (("tree.glb", "glb"), ("project", "treestroke")):
        told = service.client.get(model["files"][file]).headers["content-disposition"]
        plain = re.sub(r"[^ -~]", "_", wanted)
        first, _, other = told.partition("; filename*=UTF-8''")
        assert first == f'attachment; filename="{plain}.{ending}"'
        assert unquote(other) == (f"{wanted}.{ending}" if plain != wanted else "")
        assert other.isascii()


def test_a_download_without_a_name_is_named_after_the_id(service: Service, photo: str) -> None:
    model = service.make(**drawn.request(photo))
    told = service.client.get(model["files"]["tree.glb"]).headers["content-disposition"]
    assert told == f'attachment; filename="{model["id"]}.glb"'


@pytest.mark.parametrize("harm", ["flip", "remove"])
@pytest.mark.parametrize("asked", ["", "Range", "If-None-Match"])
def test_a_damaged_file_is_an_error_and_not_its_old_tag(
    service: Service, made: dict[str, Any], harm: str, asked: str
) -> None:
    place = made["files"]["tree.glb"]
    sha256 = service.client.get(place).headers["etag"].strip('"')
    path = service.data / "blobs" / sha256[:2] / sha256
    whole = path.read_bytes()
    path.unlink()
    if harm == "flip":
        path.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]))
    headers = {"Range": "bytes=0-3", "If-None-Match": f'"{sha256}"'}
    try:
        answer = service.client.get(place, headers={asked: headers[asked]} if asked else {})
    finally:
        path.write_bytes(whole)
    assert (answer.status_code, answer.json()["code"]) == (500, "file_damaged")
    assert answer.headers["content-type"] == "application/problem+json"
    assert "etag" not in answer.headers
    assert service.client.get(place).content == whole


def test_the_pictures_open_and_the_strokes_are_those_that_were_sent(client: httpx.Client, made: dict[str, Any]) -> None:
    preview = Image.open(io.BytesIO(client.get(made["files"]["preview.png"]).content))
    assert preview.width > preview.height
    strokes = client.get(made["files"]["strokes.json"]).json()
    assert strokes == {**drawn.STROKES, "erase": []}


def test_the_tree_is_the_command_lines_byte_by_byte(
    service: Service, tmp_path: Path, ran: Callable[..., bytes]
) -> None:
    content = drawn.encoded("JPEG", seed=41, quality=80)
    (tmp_path / "photo.jpg").write_bytes(content)
    (tmp_path / "strokes.json").write_text(json.dumps(drawn.STROKES))
    settings = {"iterations": 40, "height": 12.5, "leaf_density": 0.3}
    model = service.make(**drawn.request(service.add_photo(content), settings=settings, seed=5))
    flags = [f"--{key}={value}".replace("_", "-") for key, value in {**settings, "seed": 5}.items()]
    wanted = ran(tmp_path / "photo.jpg", "--strokes", tmp_path / "strokes.json", *flags)
    assert service.client.get(model["files"]["tree.glb"]).content == wanted


def test_the_project_opens_on_the_command_line_and_gives_the_same_tree(
    service: Service, photo: str, tmp_path: Path, ran: Callable[..., bytes]
) -> None:
    model = service.make(**drawn.request(photo, name="A project", seed=2**63 - 1))
    project = service.client.get(model["files"]["project"]).content
    with zipfile.ZipFile(io.BytesIO(project)) as archive:
        assert archive.namelist() == ["photo.png", "strokes.json", "settings.json"]
        assert json.loads(archive.read("settings.json")) == {**model["settings"], "seed": 2**63 - 1}
    (tmp_path / "tree.treestroke").write_bytes(project)
    assert ran(tmp_path / "tree.treestroke") == service.client.get(model["files"]["tree.glb"]).content


def test_a_part_of_a_project_is_sent_of_the_one_that_was_packed(service: Service, made: dict[str, Any]) -> None:
    place = made["files"]["project"]
    whole = service.client.get(place)
    before = {path: path.stat().st_mtime_ns for path in (service.data / "projects").iterdir()}
    for first in range(3):
        answer = service.client.get(place, headers={"Range": f"bytes={first}-{first}"})
        assert answer.content == whole.content[first : first + 1]
    assert {path: path.stat().st_mtime_ns for path in (service.data / "projects").iterdir()} == before
    assert not (service.data / "blobs" / whole.headers["etag"][1:3] / whole.headers["etag"].strip('"')).exists()


def test_a_served_folder_holds_only_what_the_next_start_knows_as_its_own(
    service: Service, made: dict[str, Any]
) -> None:
    assert service.client.get(made["files"]["project"]).status_code == 200
    names = {path.name for path in service.data.iterdir()}
    assert {"blobs", "projects", "treestroke.sqlite3"} <= names <= _SERVICE_NAMES


def test_the_report_is_the_command_lines(client: httpx.Client, made: dict[str, Any]) -> None:
    needed = {"engine", "seed", "settings", "seconds", "counts", "score", "warnings"}
    assert set(made["report"]) == needed | {"measures", "variants", "siblings", "files", "reading", "taken"}
    assert made["report"]["counts"]["bytes"] == len(client.get(made["files"]["tree.glb"]).content)
