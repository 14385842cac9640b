"""A tree measured from many photos: chosen, sent, solved, drawn over, and grown."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from PIL import Image
from playwright.sync_api import expect
from tests.e2e.conftest import OpenPage, Service
from tests.e2e.visitor import ROOT, Point, Visitor

EXAMPLE = ROOT / "examples" / "young_ash"
PHOTOS = 8
SHARE = 2
"""The example's photos are made smaller by this, so that they are solved in seconds."""
SOLVED_MS = 600_000


@pytest.fixture(scope="module")
def photos(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Make the first photos of the example smaller; they look at the tree from nearly half the way around it."""
    folder = tmp_path_factory.mktemp("young ash")
    made = []
    for photo in sorted(EXAMPLE.glob("*.jpg"))[:PHOTOS]:
        with Image.open(photo) as picture:
            picture.reduce(SHARE).save(folder / photo.name, quality=92)
        made.append(folder / photo.name)
    return made


def strokes() -> dict[str, Any]:
    """Return what is drawn over the first photo, px of the smaller one."""
    view = json.loads((EXAMPLE / "strokes.json").read_text())["views"][0]
    lines = [view["crown"], *view.get("branches", ())]
    for line in lines:
        line["points"] = [[value / SHARE for value in point] for point in line["points"]]
    return {"crown": lines[0], "branches": lines[1:]}


def test_many_photos_become_one_measured_tree(open_page: OpenPage, service: Service, photos: list[Path]) -> None:
    visitor = open_page()
    page = visitor.page
    visitor.choose(page.get_by_role("button", name="Choose many photos"), *photos)
    expect(page.get_by_role("heading", name=f"{PHOTOS} photos of one tree?")).to_be_visible()
    assert not service.client.get("/v1/captures").json()["captures"], "nothing is sent before it is said"
    page.get_by_role("button", name=f"Make one tree of {PHOTOS} photos").click()
    expect(page.get_by_text("Draw a loose line around all of the leaves.")).to_be_visible()
    visitor.draw_tree(strokes())
    expect(page.get_by_role("radio", name="Photo ")).to_have_count(PHOTOS)
    expect(page.get_by_role("progressbar", name="Finding the cameras")).to_be_visible()
    visitor.reload()
    expect(page.get_by_text(f"All {PHOTOS} photos are used.").first).to_be_visible(timeout=SOLVED_MS)
    visitor.wait_for_preview("live")
    visitor.shot("measured")
    drawn_on = page.get_by_role("radio", name="Photo ", checked=True)
    drawn_on.press("ArrowRight")
    expect(drawn_on).to_have_accessible_name(f"Photo 2 of {PHOTOS}, 01.jpg, used")
    assert not visitor.violations()
    page.get_by_role("button", name="Grow", exact=True).click()
    visitor.wait_for_preview("model")
    model = service.models()[0]
    assert model["capture"] == service.client.get("/v1/captures").json()["captures"][0]["id"]
    assert len(model["report"]["cameras"]) == PHOTOS


def measured(visitor: Visitor, photos: list[Path]) -> Visitor:
    """Open many photos that the service has solved before, draw their tree, and wait until it is shown."""
    page = visitor.page
    visitor.choose(page.get_by_role("button", name="Choose many photos"), *photos)
    page.get_by_role("button", name=f"Make one tree of {PHOTOS} photos").click()
    visitor.sketch.wait_for()
    visitor.draw_tree(strokes())
    drawing = page.get_by_role("region", name="Drawing")
    expect(drawing.get_by_text(f"All {PHOTOS} photos are used.")).to_be_visible(timeout=SOLVED_MS)
    visitor.wait_for_preview("live")
    return visitor


def test_branches_are_seen_and_edited_over_each_photo(visitor: Visitor, photos: list[Path]) -> None:
    page = measured(visitor, photos).page
    expect(page.get_by_text("More photos would help", exact=False)).to_be_visible()
    page.get_by_role("group", name="View").get_by_role("button", name="Photo").click()
    expect(page.get_by_role("slider", name="Slide between photo and tree")).to_be_visible()
    page.get_by_role("button", name="Edit branches").click()
    thickness = page.get_by_role("spinbutton", name="Thickness")
    expect(thickness).to_be_disabled()
    trunk = strokes()["branches"][0]["points"]
    page.mouse.click(*over_photo(visitor, trunk[len(trunk) // 3]))
    expect(thickness).to_have_value(re.compile(r"\d"))  # the click was on the trunk: tree and photo lie on each other
    page.get_by_role("radio", name="Photo ", checked=True).press("ArrowRight")
    expect(page.get_by_role("slider", name="Slide between photo and tree")).to_be_visible()
    assert not visitor.violations()
    visitor.shot("measured-branches")
    page.get_by_role("button", name="Remove the branch").click()
    visitor.until(lambda: [edit["do"] for edit in visitor.traced[-1].get("edits", [])] == ["remove"])
    page.get_by_role("group", name="Branches").get_by_role("button", name="Undo").click()
    visitor.until(lambda: not visitor.traced[-1].get("edits"))
    page.get_by_role("radio", name="Photo ", checked=True).press("ArrowLeft")
    page.get_by_role("button", name="Add", exact=True).click()
    expect(page.get_by_text("Draw a branch: press on the branch that it leaves", exact=False)).to_be_visible()
    x, y = over_photo(visitor, trunk[len(trunk) // 3])
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 90, y - 40, steps=12)
    page.mouse.up()
    visitor.until(lambda: [edit["do"] for edit in visitor.traced[-1].get("edits", [])] == ["add"])
    page.get_by_role("button", name="Done", exact=True).click()
    expect(page.get_by_role("group", name="Branches")).to_be_hidden()


def over_photo(visitor: Visitor, point: Point) -> tuple[float, float]:
    """Return where the preview shows a point of the photo (px) on the page, while it looks from the photo."""
    photo = visitor.page.locator(".preview-photo")
    expect(photo).not_to_have_class(re.compile("preview-gone"))
    box, width = photo.bounding_box(), photo.evaluate("picture => picture.naturalWidth")
    assert box is not None
    share = box["width"] / width
    return box["x"] + point[0] * share, box["y"] + point[1] * share


def test_too_few_photos_are_told_before_they_are_sent(visitor: Visitor, photos: list[Path]) -> None:
    page = visitor.page
    visitor.choose(page.get_by_role("button", name="Choose many photos"), *photos[:3])
    expect(page.get_by_text("3 photos are too few to measure a tree")).to_be_visible()
    expect(page.get_by_role("button", name="Make one tree")).to_have_count(0)
    page.get_by_role("dialog").get_by_role("button", name="How to photograph a tree").click()
    expect(page.get_by_role("heading", name="How to photograph a tree")).to_be_visible()
    assert not visitor.violations()
    page.keyboard.press("Escape")
    expect(page.get_by_role("heading", name="3 photos of one tree?")).to_be_visible()
