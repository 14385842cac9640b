"""Drawing a tree from two sides: on paper, over photos, beside a photo's strokes, from pictures, on a phone."""

import json
import struct
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import expect
from tests.e2e.conftest import OpenPage, Service
from tests.e2e.visitor import ROOT, Path2D, Visitor

PHOTO = ROOT / "examples" / "oak_02.jpg"
DRAWINGS = {sheet: ROOT / "examples" / "sketches" / f"imagined.{sheet}.png" for sheet in ("front", "side")}
FRONT: list[Path2D] = [
    [(450, 1080), (446, 800), (455, 500), (450, 160)],
    [(449, 760), (340, 640), (210, 560)],
    [(452, 620), (560, 520), (680, 430)],
    [(453, 460), (380, 380), (320, 290)],
]
SIDE: list[Path2D] = [
    [(450, 1080), (452, 700), (446, 400), (450, 160)],
    [(451, 770), (560, 660), (650, 560)],
    [(450, 610), (330, 520), (240, 430)],
    [(447, 450), (500, 370), (560, 290)],
]


def on_paper(visitor: Visitor) -> Visitor:
    visitor.page.get_by_role("button", name="Draw it yourself").click()
    visitor.sketch.wait_for()
    return visitor


def draw_all(visitor: Visitor, sheet: str, lines: list[Path2D]) -> None:
    visitor.sheet = sheet
    for line in lines:
        visitor.draw(line)


def branches(visitor: Visitor, sheet: str) -> list[Any]:
    drawn = visitor.traced[-1].get(sheet) or {"branches": []}
    return [branch["points"] for branch in drawn.get("branches", ())]


def lined_up(visitor: Visitor) -> tuple[float, float]:
    """Tell how much higher the front's sheet lies than the side's, and how much larger it is."""
    visitor.sheet = "front"
    front = visitor.view()
    visitor.sheet = "side"
    side = visitor.view()
    return side.top - front.top, front.scale / side.scale


def glb_of(path: Path) -> dict[str, Any]:
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    read: dict[str, Any] = json.loads(data[20 : 20 + length])
    return read


def test_a_tree_drawn_from_both_sides_on_paper_is_grown_and_taken_away(open_page: OpenPage, service: Service) -> None:
    visitor = on_paper(open_page(viewport=(1440, 800)))
    page = visitor.page
    draw_all(visitor, "front", FRONT[:1])
    visitor.wait_for_preview("live")
    expect(page.get_by_text("Only the front is drawn")).to_be_visible()
    draw_all(visitor, "front", FRONT[1:])
    page.get_by_role("button", name="Medium brush").click()
    draw_all(visitor, "side", SIDE)
    visitor.until(lambda: len(branches(visitor, "side")) == len(SIDE) and visitor.traced[-1]["grow"])
    expect(page.get_by_text("Only the front is drawn")).to_be_hidden()
    assert lined_up(visitor) == pytest.approx((0, 1), abs=0.01)
    assert visitor.traced[-1]["side"]["branches"][0]["width"] > 10
    assert "width" not in visitor.traced[-1]["front"]["branches"][0]
    visitor.wait_for_rest()
    visitor.shot("two-sheets")
    page.get_by_role("button", name="Grow", exact=True).click()
    visitor.wait_for_preview("model")
    expect(page.get_by_text("are in the tree").first).to_be_visible()
    with page.expect_download() as download:
        page.get_by_role("link", name="Download GLB").click()
    photo = glb_of(download.value.path())["scenes"][0]["extras"]["photo"]
    assert (photo["width"], photo["height"]) == (900, 1200)
    assert service.models()[0]["photo"] is None


def test_both_sheets_are_looked_at_alike_and_have_one_history(visitor: Visitor) -> None:
    page = on_paper(visitor).page
    draw_all(visitor, "front", FRONT[:2])
    draw_all(visitor, "side", SIDE[:2])
    page.mouse.move(*visitor.view().at((450, 600)))
    page.mouse.wheel(0, -300)
    visitor.wait_until_still()
    assert lined_up(visitor) == pytest.approx((0, 1), abs=0.01)
    visitor.until(lambda: len(branches(visitor, "side")) == 2)
    visitor.wait_until_traced()
    for _ in range(3):
        page.keyboard.press("Control+z")
    visitor.until(lambda: [len(branches(visitor, sheet)) for sheet in ("front", "side")] == [1, 0])
    visitor.wait_until_traced()
    page.keyboard.press("s")
    expect(page.locator("[data-sheet=front]:focus")).to_be_visible()
    page.keyboard.press("Control+Shift+z")
    visitor.until(lambda: len(branches(visitor, "front")) == 2)


def test_a_sketch_and_its_photo_survive_a_reload(visitor: Visitor) -> None:
    page = on_paper(visitor).page
    draw_all(visitor, "front", FRONT[:2])
    draw_all(visitor, "side", SIDE[:2])
    visitor.until(lambda: len(branches(visitor, "side")) == 2)
    visitor.sheet = "front"
    before = visitor.view().at(FRONT[1][-1])
    visitor.give(visitor.sketch, PHOTO)
    expect(page.get_by_role("button", name="Remove the photo")).to_be_visible()
    visitor.until(lambda: visitor.traced[-1]["front"]["canvas"] != [900, 1200])
    assert visitor.view().at(branches(visitor, "front")[1][-1])[1] == pytest.approx(before[1], abs=40)
    visitor.shot("sketch-over-photo")
    drawn = [branches(visitor, sheet) for sheet in ("front", "side")]
    visitor.reload()
    visitor.wait_for_preview("live")
    assert [branches(visitor, sheet) for sheet in ("front", "side")] == drawn
    expect(page.get_by_role("button", name="Remove the photo")).to_be_visible()


def test_a_side_sketch_says_how_deep_the_tree_of_a_photo_is(visitor: Visitor, service: Service) -> None:
    page = visitor.page
    page.get_by_role("button", name="Young oak").click()
    visitor.wait_for_preview("model")
    guessed = service.models()[0]
    page.get_by_role("button", name="Draw its left side, too").click()
    visitor.sheet = "side"
    visitor.wait_until_still()
    box, view = visitor.sketch.bounding_box(), visitor.view()
    assert box is not None
    middle = (box["x"] + box["width"] / 2 - view.left) / view.scale
    visitor.draw([(middle, 1100), (middle, 700), (middle, 250)])
    visitor.draw([(middle, 800), (middle + 60, 660), (middle + 90, 500)])
    visitor.until(
        lambda: visitor.traced[-1]["grow"] and len(visitor.traced[-1].get("side", {}).get("branches", ())) == 2
    )
    visitor.shot("photo-and-side")
    page.get_by_role("button", name="Grow again").click()
    expect(page.get_by_text("are in the tree").first).to_be_visible()
    told = service.models()[0]
    assert told["id"] != guessed["id"]
    assert told["score"]["depth_over_width"] < 0.8 * guessed["score"]["depth_over_width"]


def test_a_pair_of_pictures_is_an_example_that_is_grown_and_drawn_on(
    visitor: Visitor, open_page: OpenPage, service: Service
) -> None:
    page = visitor.page
    page.get_by_role("button", name="Imagined tree").click()
    visitor.wait_for_preview("model")
    expect(page.get_by_text("are in the tree").first).to_be_visible()
    expect(page.get_by_text("loops of branches were cut open")).to_be_visible()
    read = {sheet: branches(visitor, sheet) for sheet in DRAWINGS}
    assert all(len(lines) > 10 for lines in read.values())
    assert all("crown" in visitor.traced[-1][sheet] for sheet in DRAWINGS)
    widths = [branch["width"] for branch in visitor.traced[-1]["front"]["branches"]]
    assert widths[0] == max(widths) > 3 * min(widths)
    visitor.shot("imagined")
    other = open_page(f"/#{service.models()[0]['id']}")
    other.wait_for_preview("model")
    assert {sheet: branches(other, sheet) for sheet in DRAWINGS} == read


def test_a_picture_from_the_disk_is_opened_drawn_on_and_grown(visitor: Visitor, service: Service) -> None:
    page = visitor.page
    visitor.choose(page.get_by_role("button", name="Open a drawing").first, DRAWINGS["front"])
    visitor.wait_for_preview("live")
    read = len(branches(visitor, "front"))
    visitor.sheet = "side"
    field = page.locator("[data-of=side] .canvas")
    visitor.give(field, DRAWINGS["side"], media_type="image/png", down=0.75)
    visitor.until(lambda: len(branches(visitor, "side")) > 10 and visitor.traced[-1]["grow"])
    page.keyboard.press("Control+z")
    visitor.until(lambda: branches(visitor, "side") == [])
    visitor.wait_until_traced()
    page.keyboard.press("Control+Shift+z")
    visitor.until(lambda: len(branches(visitor, "side")) > 10 and visitor.traced[-1]["grow"])
    visitor.sheet = "front"
    visitor.draw([(640, 500), (760, 470), (850, 500)])
    visitor.until(lambda: len(branches(visitor, "front")) == read + 1 and visitor.traced[-1]["grow"])
    page.get_by_role("button", name="Grow", exact=True).click()
    visitor.wait_for_preview("model")
    assert service.models()[0]["name"] == "imagined.front"


def test_a_picture_of_no_tree_is_refused_and_loses_nothing(visitor: Visitor) -> None:
    page = on_paper(visitor).page
    draw_all(visitor, "front", FRONT[:2])
    visitor.until(lambda: len(branches(visitor, "front")) == 2)
    heading = page.locator("[data-of=front]").get_by_role("button", name="Open a drawing")
    visitor.choose(heading, PHOTO)
    notice = page.locator(".notice")
    expect(notice).to_contain_text("Save it as a PNG")
    page.get_by_role("button", name="Close this message").click()
    visitor.expect_complaint("422")
    leaf = DRAWINGS["front"].with_name("orange.leaf.png")
    visitor.choose(heading, leaf)
    expect(notice).to_contain_text("draw branches as lines")
    visitor.draw(FRONT[2])
    visitor.until(lambda: len(branches(visitor, "front")) == 3)


def test_on_a_phone_one_sheet_is_seen_at_a_time(open_page: OpenPage) -> None:
    visitor = on_paper(open_page(viewport=(390, 844), touch=True))
    page = visitor.page
    visitor.touch(FRONT[0])
    chooser = page.get_by_role("group", name="What is shown")
    chooser.get_by_role("button", name="Left side").click()
    visitor.sheet = "side"
    visitor.wait_until_still()
    visitor.touch(SIDE[0])
    visitor.until(lambda: len(branches(visitor, "side")) == 1)
    expect(page.get_by_label("Paper to draw the front on")).to_be_hidden()
    visitor.shot("phone-side")
    chooser.get_by_role("button", name="Tree").click()
    visitor.wait_for_preview("live")
    assert visitor.violations() == []
