"""Further files of a model, its own leaf and its variants, asked for over HTTP."""

import base64
import io
import json
import zipfile
from typing import Any

import httpx
import numpy as np
import pytest
import trimesh
from PIL import Image
from tests.api import drawn
from tests.api.conftest import Service

FILES = ["gltf", "obj", "ply", "instanced", "collision", "json", "swc", "csv"]
RICH = {**drawn.QUICK, "variants": 2, "wind": "breeze", "files": FILES}
KINDS = {
    "tree.v2.glb": "model/gltf-binary",
    "tree.gltf.zip": "application/zip",
    "tree.obj.zip": "application/zip",
    "tree.ply": "application/octet-stream",
    "tree.instanced.glb": "model/gltf-binary",
    "tree.collision.glb": "model/gltf-binary",
    "tree.skeleton.json": "application/json",
    "tree.swc": "text/plain; charset=utf-8",
    "tree.skeleton.csv": "text/csv; charset=utf-8",
}


@pytest.fixture(scope="module")
def rich(service: Service, photo: str) -> dict[str, Any]:
    """A finished model with most of what can be asked for."""
    model = service.make(**drawn.request(photo, name="Grove", settings=RICH))
    assert model["status"] == "succeeded"
    return model


def leaf_png(colour: tuple[int, int, int] = (200, 20, 180)) -> bytes:
    y, x = np.mgrid[:64, :64] - 31.5
    inside = np.hypot(x / 0.6, y) < 30
    pixels = np.zeros((64, 64, 4), np.uint8)
    pixels[inside] = (*colour, 255)
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "PNG")
    return out.getvalue()


def magenta(glb: bytes) -> float:
    """Share of the leaf texture's opaque part that is more red and blue than green."""
    texture = trimesh.load_scene(io.BytesIO(glb), "glb").geometry["leaf"].visual.material.baseColorTexture
    pixels = np.asarray(texture.convert("RGBA"), dtype=np.int64)
    leaf = pixels[pixels[..., 3] > 127]
    return float(((leaf[:, 0] > leaf[:, 1] + 30) & (leaf[:, 2] > leaf[:, 1] + 30)).mean())


@pytest.mark.parametrize("name", KINDS)
def test_each_further_file_is_named_and_sent_by_its_type(client: httpx.Client, rich: dict[str, Any], name: str) -> None:
    answer = client.get(rich["files"][name])
    assert (answer.status_code, answer.headers["content-type"]) == (200, KINDS[name])
    assert f'filename="Grove{name.removeprefix("tree")}"' in answer.headers["content-disposition"]
    assert len(answer.content) > 100


def test_each_variant_has_each_file(rich: dict[str, Any]) -> None:
    own = {name.removeprefix("tree.") for name in rich["files"] if name.startswith("tree.") and ".v2." not in name}
    second = {name.removeprefix("tree.v2.") for name in rich["files"] if name.startswith("tree.v2.")}
    assert own == second
    assert [one["seed"] for one in rich["report"]["variants"]] == [0, 1]


def test_a_zip_holds_the_files_of_one_format(client: httpx.Client, rich: dict[str, Any]) -> None:
    with zipfile.ZipFile(io.BytesIO(client.get(rich["files"]["tree.obj.zip"]).content)) as archive:
        names = archive.namelist()
    assert names[:2] == ["tree.obj", "tree.mtl"]


@pytest.mark.parametrize("name", ["tree.fbx", "tree.usdz", "tree..glb", "tree.v3.glb", "tree.glb.glb"])
def test_a_file_that_there_is_not_is_not_found(client: httpx.Client, rich: dict[str, Any], name: str) -> None:
    answer = client.get(f"/v1/models/{rich['id']}/{name}")
    assert (answer.status_code, answer.json()["code"]) == (404, "file_not_found")


def test_a_leaf_of_one_s_own_is_borne(service: Service, client: httpx.Client, photo: str) -> None:
    plain, own = (service.make(**drawn.request(photo, **leaf)) for leaf in ({}, {"leaf": text_of(leaf_png())}))
    shares = [magenta(client.get(one["files"]["tree.glb"]).content) for one in (plain, own)]
    assert shares[0] < 0.05
    assert shares[1] > 0.5
    with zipfile.ZipFile(io.BytesIO(client.get(own["files"]["project"]).content)) as project:
        assert project.read("leaf.png") == leaf_png()


def test_a_leaf_comes_by_a_form_too(service: Service, client: httpx.Client) -> None:
    form = drawn.form(drawn.encoded())
    form["files"]["leaf"] = ("leaf.png", leaf_png())
    model = service.finished(client.post("/v1/models", **form))
    assert model["status"] == "succeeded"
    assert magenta(client.get(model["files"]["tree.glb"]).content) > 0.5


def text_of(png: bytes) -> str:
    return base64.b64encode(png).decode()


@pytest.mark.parametrize(
    ("leaf", "code"),
    [
        (5, "wrong_type"),
        ("no base64!", "leaf_unreadable"),
        (text_of(b"no PNG"), "leaf_unreadable"),
        ("A" * 6_000_000, "wrong_type"),
    ],
)
def test_what_is_no_leaf_is_refused(client: httpx.Client, photo: str, leaf: object, code: str) -> None:
    answer = client.post("/v1/models", json=drawn.request(photo, leaf=leaf))
    assert (answer.status_code, answer.json()["code"]) == (422, code)
    assert answer.json()["errors"][0]["pointer"] == "/leaf"


def test_a_known_length_is_taken_and_kept(service: Service, client: httpx.Client, photo: str) -> None:
    (x, y), scale = drawn.ROOT, {"metres": 2.0}
    strokes = {**drawn.STROKES, "scale": {"points": [[x, y], [x, y - 100]], **scale}}
    model = service.make(**drawn.request(photo, strokes=strokes))
    assert model["report"]["measures"]["scale"]["value"] == pytest.approx(0.02)
    assert json.loads(client.get(model["files"]["strokes.json"]).content)["scale"] == strokes["scale"]
