"""A tree measured from many photos: chosen, sent, solved, drawn over, and grown."""

import json
from pathlib import Path
from typing import Any

import pytest
from PIL import Image
from playwright.sync_api import expect
from tests.e2e.conftest import OpenPage, Service
from tests.e2e.visitor import ROOT, Visitor

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
