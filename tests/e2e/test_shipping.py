"""What a tree is taken away with: wind, several trees, a leaf of one's own, a known length, further files."""

import io
import zipfile
from typing import Any

from PIL import Image, ImageDraw
from playwright.sync_api import Locator, expect
from tests.e2e.conftest import Service
from tests.e2e.visitor import Visitor

ROUNDS = "40"
"""Of growth: the tree need not be full."""
POST = [[80.0, 600.0], [80.0, 500.0]]
"""A line over the photo of the example."""


def grown(visitor: Visitor) -> Visitor:
    """Open an example, which is grown at once."""
    visitor.page.get_by_role("button", name="Osage orange").click()
    visitor.wait_for_preview("model")
    return visitor


def settings(visitor: Visitor, group: str) -> Locator:
    """Open the settings of one group."""
    panel = visitor.page.get_by_role("dialog", name="How it grows")
    if not panel.is_visible():
        visitor.page.locator(".settings-opener").click()
    panel.get_by_role("tab", name=group).click()
    return panel


def grow_again(visitor: Visitor, service: Service) -> dict[str, Any]:
    """Have the tree grown as it is wished for now, and wait until it stands; give the service's word of it."""
    settings(visitor, "Tree").get_by_label("Growth", exact=True).fill(ROUNDS)
    visitor.page.keyboard.press("Escape")
    count = len(service.models())
    visitor.page.get_by_role("button", name="Grow again").click()
    visitor.until(lambda: len(service.models()) > count)
    visitor.until(lambda: service.models()[0]["status"] not in ("queued", "running"))
    visitor.wait_for_preview("model")
    expect(visitor.page.get_by_text("match with the foliage and branches").first).to_be_visible()
    model: dict[str, Any] = service.client.get(f"/v1/models/{service.models()[0]['id']}").json()
    assert model["status"] == "succeeded", model["error"]
    return model


def leaf() -> bytes:
    """A leaf cut out, its stalk down."""
    picture = Image.new("RGBA", (120, 160), (0, 0, 0, 0))
    pen = ImageDraw.Draw(picture)
    pen.ellipse((20, 10, 100, 130), fill=(180, 40, 60, 255))
    pen.line((60, 120, 60, 158), fill=(90, 60, 30, 255), width=5)
    file = io.BytesIO()
    picture.save(file, "PNG")
    return file.getvalue()


def picture(visitor: Visitor) -> bytes:
    return visitor.preview.locator("canvas").first.screenshot()


def test_wind_is_chosen_grown_and_blows_until_it_is_still(visitor: Visitor, service: Service) -> None:
    page = grown(visitor).page
    page.get_by_role("button", name="Add wind").click()
    settings(visitor, "File").get_by_label("Wind").select_option("all")
    expect(page.get_by_text("the tree stays the same").first).to_be_visible()
    grow_again(visitor, service)
    winds = page.get_by_role("group", name="Motion")
    winds.get_by_role("button", name="Breeze").click()
    expect(winds.get_by_role("button", name="Breeze")).to_have_attribute("aria-pressed", "true")
    frames, _ = visitor.drawn()
    blown = picture(visitor)
    visitor.until(lambda: visitor.drawn()[0] > frames + 3)
    assert picture(visitor) != blown
    visitor.shot("breeze")
    winds.get_by_role("button", name="Still").click()
    visitor.wait_for_rest()


def test_of_several_trees_one_is_looked_at_and_taken_home(visitor: Visitor, service: Service) -> None:
    page = grown(visitor).page
    settings(visitor, "Tree").get_by_label("Trees").first.fill("2")
    model = grow_again(visitor, service)
    assert "tree.v2.glb" in model["files"]
    visitor.wait_for_rest()
    first = picture(visitor)
    page.get_by_role("button", name="Tree 2 of 2").click()
    link = page.get_by_role("link", name="Download GLB")
    expect(link).to_have_attribute("href", model["files"]["tree.v2.glb"])
    visitor.until(lambda: picture(visitor) != first)
    visitor.shot("second-tree")
    with page.expect_download() as download:
        link.click()
    assert download.value.suggested_filename.endswith(".v2.glb")


def test_a_leaf_of_ones_own_is_seen_sent_and_kept(visitor: Visitor, service: Service) -> None:
    page = grown(visitor).page
    panel = settings(visitor, "Leaves")
    photo = {"name": "leaf.jpg", "mimeType": "image/jpeg", "buffer": b"\xff\xd8 no PNG"}
    visitor.choose(panel.get_by_role("button", name="Choose a picture"), photo)
    expect(panel.get_by_text("This is not a PNG.")).to_be_visible()
    cut_out = {"name": "leaf.png", "mimeType": "image/png", "buffer": leaf()}
    visitor.choose(panel.get_by_role("button", name="Choose a picture"), cut_out)
    expect(panel.get_by_role("img", name="Your leaf")).to_be_visible()
    visitor.shot("own-leaf")
    model = grow_again(visitor, service)
    project = service.client.get(model["files"]["project"]).content
    assert zipfile.ZipFile(io.BytesIO(project)).read("leaf.png") == leaf()
    visitor.reload()
    visitor.wait_for_preview("model")
    expect(settings(visitor, "Leaves").get_by_role("img", name="Your leaf")).to_be_visible()
    page.keyboard.press("Escape")


def test_a_line_of_known_length_sets_how_high_the_tree_is(visitor: Visitor, service: Service) -> None:
    page = grown(visitor).page
    before = service.client.get(f"/v1/models/{service.models()[0]['id']}").json()["report"]["measures"]["height"]
    page.keyboard.press("m")
    visitor.draw(POST)
    field = page.get_by_label("Length of the measured line")
    expect(field).to_be_focused()
    field.fill("3")
    page.keyboard.press("Enter")
    visitor.until(lambda: visitor.traced[-1].get("scale") == {"points": POST, "metres": 3})
    expect(settings(visitor, "Tree").get_by_label("Height").first).to_be_disabled()
    visitor.shot("measured")
    height = grow_again(visitor, service)["report"]["measures"]["height"]
    assert height["value"] > 1.3 * before["value"]
    page.get_by_role("button", name="Details").click()
    measure = page.locator("[data-measure=height]")
    expect(measure).to_contain_text(f"{height['value']:.1f} m")
    expect(measure).to_contain_text(height["basis"])
    page.keyboard.press("Escape")
    page.keyboard.press("v")
    page.mouse.click(*visitor.view().at([80.0, 550.0]))
    page.keyboard.press("Delete")
    visitor.until(lambda: visitor.traced[-1].get("scale") is None)


def test_further_files_are_listed_by_what_they_are_and_taken_home(visitor: Visitor, service: Service) -> None:
    page = grown(visitor).page
    page.locator(".downloads-opener").click()
    page.get_by_role("button", name="More formats").click()
    panel = settings(visitor, "File")
    panel.get_by_label("Levels of detail").select_option("files")
    panel.get_by_label("Compress the GLB").check()
    for name in ("Wavefront OBJ", "Skeleton, SWC"):
        panel.get_by_label(name).check()
    grow_again(visitor, service)
    page.locator(".downloads-opener").click()
    downloads = page.get_by_role("dialog", name="Downloads")
    shelves = downloads.locator(".tree-downloads h3").all_inner_texts()
    assert shelves == ["This tree", "Levels of detail", "Other formats", "Skeleton"]
    visitor.shot("downloads")
    for label, ending in (("Middle distance", ".lod1.glb"), ("Wavefront OBJ", ".obj.zip"), ("Skeleton, SWC", ".swc")):
        with page.expect_download() as download:
            downloads.get_by_role("link", name=label).click()
        assert download.value.suggested_filename.endswith(ending)
        assert download.value.path().stat().st_size > 100
