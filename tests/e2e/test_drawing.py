"""Drawing over a photo: strokes, undo, zoom, fingers, keys."""

import math
from typing import Any

import pytest
from playwright.sync_api import expect
from tests.e2e.conftest import OpenPage
from tests.e2e.visitor import ROOT, Visitor, strokes_of

PHOTO = ROOT / "examples" / "sugar_maple_autumn.jpg"
STROKES = strokes_of(PHOTO)
LEVEL = [[200.0, 400.0], [420.0, 396.0]]
LIMB = [[300.0, 430.0], [260.0, 380.0], [220.0, 340.0]]


def opened(visitor: Visitor) -> Visitor:
    visitor.choose(visitor.page.get_by_role("button", name="Choose a photo"), PHOTO)
    visitor.sketch.wait_for()
    return visitor


def drawn(visitor: Visitor) -> Visitor:
    opened(visitor).draw_tree(STROKES)
    visitor.wait_for_preview("live")
    return visitor


def last_branches(visitor: Visitor) -> list[Any]:
    return [branch["points"] for branch in visitor.traced[-1]["branches"]]


def a_traced_joint(skeleton: dict[str, Any], crown: list[list[float]]) -> list[float]:
    """Choose the joint of a traced branch that lies farthest from every stroke."""
    ends = zip(crown, [*crown[1:], crown[0]], strict=True)
    line = [[x + (u - x) * t / 20, y + (v - y) * t / 20] for (x, y), (u, v) in ends for t in range(20)]
    joints = list(zip(skeleton["points"], skeleton["stroke"], strict=True))
    strokes = line + [point for point, stroke in joints if stroke >= 0]
    traced = [point for point, stroke in joints if stroke < 0]
    found: list[float] = max(traced, key=lambda point: min(math.dist(point, other) for other in strokes))
    return found


def test_what_is_deleted_comes_back_by_undo(visitor: Visitor) -> None:
    drawn(visitor)
    visitor.draw(LIMB, button="right")
    visitor.until(lambda: len(last_branches(visitor)) == 2)
    both = last_branches(visitor)
    visitor.page.keyboard.press("v")
    visitor.page.mouse.click(*visitor.view().at(LIMB[1]))
    expect(visitor.page.locator(".hint-text", has_text="Selected: Branch 2")).to_be_visible()
    visitor.shot("selected")
    visitor.page.keyboard.press("Delete")
    visitor.until(lambda: len(last_branches(visitor)) == 1)
    visitor.wait_until_traced()
    visitor.page.keyboard.press("Control+z")
    visitor.until(lambda: last_branches(visitor) == both)
    visitor.page.get_by_role("button", name="Clear all strokes").click()
    visitor.wait_for_preview("empty")
    visitor.page.keyboard.press("Control+z")
    visitor.wait_for_preview("live")
    assert last_branches(visitor) == both


def test_a_trunk_that_does_not_go_up_is_told_of_until_it_is_drawn_again(visitor: Visitor) -> None:
    page, told = visitor.page, "The trunk does not go up."
    visitor.expect_complaint("422")
    opened(visitor).draw_tree({**STROKES, "branches": [{"points": LEVEL}]})
    expect(page.get_by_role("alert").filter(has_text=told)).to_be_visible()
    expect(page.get_by_role("button", name="Grow")).to_be_disabled()
    visitor.shot("refused")
    page.get_by_role("button", name="Delete this stroke").click()
    visitor.draw(STROKES["branches"][0]["points"], button="right")
    visitor.wait_for_preview("live")
    expect(page.get_by_text(told)).to_have_count(0)


def test_strokes_and_their_history_survive_a_reload(visitor: Visitor) -> None:
    drawn(visitor)
    visitor.draw(LIMB, button="right")
    visitor.until(lambda: len(last_branches(visitor)) == 2)
    visitor.wait_until_traced()
    both = last_branches(visitor)
    visitor.reload()
    visitor.wait_for_preview("live")
    assert last_branches(visitor) == both
    visitor.page.keyboard.press("Control+z")
    visitor.until(lambda: len(last_branches(visitor)) == 1)


def test_strokes_are_exact_when_the_photo_is_zoomed_and_moved(visitor: Visitor) -> None:
    drawn(visitor)
    page = visitor.page
    page.mouse.move(*visitor.view().at(LIMB[0]))
    for _ in range(4):
        page.mouse.wheel(0, -120)
    visitor.wait_until_still()
    page.keyboard.down("Space")
    x, y = visitor.view().at(LIMB[0])
    page.mouse.move(600, 300)
    page.mouse.down()
    page.mouse.move(660, 345, steps=3)
    page.mouse.up()
    page.keyboard.up("Space")
    visitor.wait_until_still()
    assert visitor.view().at(LIMB[0]) == pytest.approx((x + 60, y + 45), abs=0.6)
    visitor.draw(LIMB, button="right")
    visitor.until(lambda: len(last_branches(visitor)) == 2)
    for sent, meant in ((0, 0), (-1, -1)):
        assert last_branches(visitor)[1][sent] == pytest.approx(LIMB[meant], abs=0.3)


def test_a_traced_branch_that_is_deleted_is_gone_and_comes_back(visitor: Visitor) -> None:
    page = visitor.page
    page.get_by_role("button", name="Young oak").click()
    visitor.wait_for_preview("live")
    page.keyboard.press("v")
    joint = a_traced_joint(visitor.skeleton(), visitor.traced[-1]["crown"]["points"])
    page.mouse.click(*visitor.view().at(joint))
    expect(page.locator(".hint-text", has_text="Selected: Traced branch")).to_be_visible()
    visitor.shot("traced-selected")
    page.keyboard.press("Delete")
    visitor.until(lambda: len(visitor.traced[-1]["erase"]) == 1)
    visitor.wait_until_traced()
    assert joint not in visitor.skeleton()["points"]
    page.keyboard.press("Control+z")
    visitor.until(lambda: len(visitor.traced[-1]["erase"]) == 0)
    assert joint in visitor.skeleton()["points"]


def test_a_stroke_at_fault_is_told_in_place_and_can_be_taken_back(visitor: Visitor) -> None:
    opened(visitor).draw(STROKES["crown"]["points"], close=True)
    visitor.expect_complaint("422")
    visitor.draw([[20.0, 590.0], [60.0, 560.0], [80.0, 590.0]], button="right")
    expect(visitor.page.get_by_text("The trunk does not reach the crown.")).to_be_visible()
    expect(visitor.page.get_by_role("button", name="Grow", exact=True)).to_have_attribute("aria-disabled", "true")
    visitor.shot("fault")
    visitor.page.get_by_role("button", name="Delete this stroke").click()
    expect(visitor.page.get_by_text("The trunk does not reach the crown.")).to_be_hidden()
    assert visitor.traced[-1]["branches"] == [] or visitor.page.get_by_text("Now draw up the trunk").is_visible()


def test_fingers_draw_and_pinch_on_a_phone(open_page: OpenPage) -> None:
    visitor = opened(open_page(viewport=(390, 844), touch=True))
    crown = STROKES["crown"]["points"]
    visitor.touch([*crown, crown[0]])
    expect(visitor.page.get_by_text("Now draw up the trunk")).to_be_visible()
    scale, asked = visitor.view().scale, len(visitor.traced)
    visitor.touch([[300, 300], [290, 300], [260, 300], [230, 300]], [[400, 300], [440, 300], [480, 300]])
    assert visitor.view().scale > 1.2 * scale
    assert len(visitor.traced) == asked
    visitor.shot("phone-pinched")
    visitor.page.get_by_role("button", name="Fit").click()
    visitor.touch(STROKES["branches"][0]["points"])
    visitor.wait_for_preview("live")
    visitor.shot("phone-live")
    assert len(last_branches(visitor)) == 1


def test_the_whole_way_goes_by_keyboard(open_page: OpenPage) -> None:
    visitor = open_page()
    page, keys = visitor.page, visitor.page.keyboard
    visitor.tab_to(page.get_by_role("button", name="Choose a photo"))
    with page.expect_file_chooser() as chooser:
        keys.press("Enter")
    chooser.value.set_files(PHOTO)
    visitor.sketch.wait_for()
    visitor.tab_to(visitor.sketch)
    visitor.walk("ArrowUp", 20)
    keys.press("Enter")
    for key, steps in (("ArrowRight", 16), ("ArrowDown", 26), ("ArrowLeft", 32), ("ArrowUp", 26), ("ArrowRight", 14)):
        visitor.walk(key, steps)
    keys.press("Enter")
    expect(page.get_by_text("Now draw up the trunk")).to_be_visible()
    visitor.walk("ArrowDown", 40)
    keys.press("Enter")
    visitor.walk("ArrowUp", 16)
    keys.press("Enter")
    visitor.wait_for_preview("live")
    visitor.shot("by-keyboard")
    keys.press("g")
    visitor.wait_for_preview("model")
    visitor.tab_to(page.get_by_role("link", name="Download GLB"))
    with page.expect_download() as download:
        keys.press("Enter")
    assert download.value.suggested_filename.endswith(".glb")
