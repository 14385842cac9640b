"""What three.js, in a real browser, reads of a tree's GLBs and of its loose glTF."""

import base64
import shutil
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, Route, sync_playwright
from tests.readers.conftest import ROOT, Shelf, missing

pytestmark = pytest.mark.readers
THREE = ROOT / "frontend" / "node_modules" / "three"
ORIGIN = "http://testserver"
Read = Callable[..., dict[str, Any]]
KINDS = {".html": "text/html", ".js": "text/javascript", ".gltf": "model/gltf+json", ".jpg": "image/jpeg"}


@pytest.fixture(scope="module")
def read(shelf: Shelf) -> Iterator[Read]:
    """Open a file by three.js, and draw it from the front: at rest, or at a moment of its first clip."""
    executable = shutil.which("chromium") or shutil.which("chromium-browser")
    if executable is None or not THREE.is_dir():
        missing("chromium or the page's packages are missing: run `make page chromium`")
    folders = {"three": THREE, "files": shelf.folder, "page": Path(__file__).parent}
    complaints: list[str] = []

    def give(route: Route) -> None:
        first, _, rest = route.request.url.removeprefix(f"{ORIGIN}/").partition("/")
        path = folders[first] / rest
        route.fulfill(body=path.read_bytes(), content_type=KINDS.get(path.suffix, "application/octet-stream"))

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=["--enable-unsafe-swiftshader"])
        page: Page = browser.new_page()
        page.route(f"{ORIGIN}/{{three,files,page}}/**", give)
        page.route(f"{ORIGIN}/favicon.ico", lambda route: route.fulfill(body=""))
        page.on(
            "console", lambda message: complaints.append(message.text) if message.type in ("error", "warning") else 0
        )
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(f"{ORIGIN}/page/three_reads.html")
        page.wait_for_function("window.read !== undefined")
        yield lambda name, seconds=None: page.evaluate("([name, at]) => window.read(name, at)", [name, seconds])
        browser.close()
    assert [text for text in complaints if "GPU stall" not in text] == []


def pixels(found: dict[str, Any]) -> np.ndarray:
    """Give what was drawn (320, 320, 3)."""
    return np.frombuffer(base64.b64decode(found["pixels"]), np.uint8).reshape(320, 320, 4)[..., :3].astype(float)


def by_material(found: dict[str, Any]) -> dict[str, int]:
    counts: Counter[str] = Counter()
    for mesh in found["meshes"]:
        counts[mesh["material"].removesuffix("_twigs")] += round(mesh["triangles"])
    return dict(counts)


@pytest.mark.parametrize(
    "name",
    ["plain.glb", "wind.glb", "compressed.glb", "compressed_wind.glb", "instanced.glb", "loose.gltf", "one.glb"],
)
def test_every_form_has_all_triangles_in_their_place(read: Read, shelf: Shelf, name: str) -> None:
    found = read(name)
    assert by_material(found) == shelf.triangles()
    assert np.allclose(found["box"], shelf.box(), atol=0.01)
    assert found["photo"]["metres_per_pixel"] == shelf.tree.camera.metres_per_pixel


@pytest.mark.parametrize("name", ["plain.glb", "wind.glb", "compressed.glb", "compressed_wind.glb", "loose.gltf"])
def test_materials_are_whole(read: Read, shelf: Shelf, name: str) -> None:
    bark, twigs, leaf = read(name)["meshes"]
    assert shelf.tree.leaf is not None
    assert bark["picture"] == list(shelf.tree.bark.texture.shape[1::-1])
    assert leaf["picture"] == list(shelf.tree.leaf.texture.shape[1::-1])
    assert (bark["relief"], twigs["relief"]) == (shelf.tree.bark.normal_map is not None, False)
    assert twigs["picture"] == bark["picture"]
    assert (leaf["cut"], leaf["sides"], leaf["shaded"]) == (0.3, 2, True)


@pytest.mark.parametrize(("name", "share"), [("levels.lod1.glb", 0.3), ("levels.lod2.glb", 0.08)])
def test_levels_are_the_same_tree_of_fewer_triangles(read: Read, shelf: Shelf, name: str, share: float) -> None:
    found = read(name)
    assert sum(by_material(found).values()) == pytest.approx(share * sum(shelf.triangles().values()), rel=0.15)
    assert np.allclose(found["box"], shelf.box(), atol=0.6)
    assert found["clips"] == ["breeze", "gust"]


def test_the_impostor_is_pictures_seen_from_the_front_only(read: Read, shelf: Shelf) -> None:
    found = read("levels.impostor.glb")
    (pictures,) = found["meshes"]
    assert round(pictures["triangles"]) < 100
    assert (pictures["relief"], pictures["cut"], pictures["sides"]) == (True, 0.3, 1)
    assert np.allclose(found["box"], shelf.box(), atol=0.8)
    plain = pixels(read("plain.glb"))
    assert np.abs((plain == 255).all(axis=2) ^ (pixels(found) == 255).all(axis=2)).mean() < 0.05


def test_the_collision_solid_is_small_and_stands_in_the_tree(read: Read, shelf: Shelf) -> None:
    found = read("levels.collision.glb")
    assert by_material(found).keys() == {"collision"}
    assert round(found["meshes"][0]["triangles"]) <= 1000
    low, high = np.array(found["box"])
    assert (low >= shelf.box()[0] - 0.15).all()
    assert (high <= shelf.box()[1] + 0.1).all()


@pytest.mark.parametrize(("name", "near"), [("compressed.glb", 1.0), ("loose.gltf", 0.01), ("wind.glb", 0.1)])
def test_other_forms_look_as_the_plain_one(read: Read, name: str, near: float) -> None:
    plain, other = pixels(read("plain.glb")), pixels(read(name))
    assert plain.std() > 20
    assert np.abs(plain - other).mean() < near


def test_instances_look_nearly_as_the_plain_one(read: Read) -> None:
    plain, other = pixels(read("plain.glb")), pixels(read("instanced.glb"))
    assert np.abs((plain == 255).all(axis=2) ^ (other == 255).all(axis=2)).mean() < 0.005  # where the sky shows
    assert np.abs(plain.mean(axis=(0, 1)) - other.mean(axis=(0, 1))).max() < 3
    assert np.abs(plain - other).mean() < 8


def test_instances_are_instances_with_their_shades(read: Read, shelf: Shelf) -> None:
    leaves = [mesh for mesh in read("instanced.glb")["meshes"] if mesh["material"] == "leaf"]
    assert shelf.tree.cards is not None
    assert sum(mesh["instances"] for mesh in leaves) == len(shelf.tree.cards)
    assert all(mesh["shaded"] for mesh in leaves)


@pytest.mark.parametrize("name", ["wind.glb", "compressed_wind.glb"])
def test_wind_moves_the_tree_and_ends_where_it_began(read: Read, name: str) -> None:
    found = [read(name, seconds) for seconds in (0.0, 2.0)]
    assert found[0]["clips"] == ["breeze", "gust"]
    assert all(mesh["skinned"] for mesh in found[0]["meshes"])
    assert np.abs(pixels(found[0]) - pixels(found[1])).mean() > 1


def test_compressed_wind_moves_as_the_plain_wind_does(read: Read) -> None:
    plain, other = pixels(read("wind.glb", 1.5)), pixels(read("compressed_wind.glb", 1.5))
    assert np.abs(plain - other).mean() < 1
