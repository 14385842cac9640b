"""What a photo's tree is taken for: the chip beside the tree, and the click that changes it."""

import pytest
from playwright.sync_api import Locator, expect
from tests.e2e.conftest import OpenPage, Service
from tests.e2e.visitor import ROOT, Visitor, strokes_of

PHOTO = ROOT / "examples" / "sugar_maple_autumn.jpg"


def drawn(visitor: Visitor) -> Visitor:
    """Open a photo and draw its tree, without growing it."""
    visitor.choose(visitor.page.get_by_role("button", name="Choose a photo"), PHOTO)
    visitor.sketch.wait_for()
    visitor.draw_tree(strokes_of(PHOTO))
    visitor.wait_for_preview("live")
    return visitor


def chip(visitor: Visitor) -> Locator:
    return visitor.page.get_by_role("group", name="What the tree is taken for")


def change(visitor: Visitor, name: str, menu: str = "Kind of tree") -> None:
    """Open the chip's choices and choose one."""
    chip(visitor).get_by_title(menu).click()
    visitor.page.get_by_role("radiogroup", name=menu).get_by_role("radio", name=name).click()


def test_one_click_changes_the_kind_and_the_live_tree_follows(visitor: Visitor) -> None:
    drawn(visitor)
    expect(chip(visitor)).to_contain_text("Taken for: leaves")
    visitor.wait_for_rest()
    before = visitor.preview.screenshot()
    change(visitor, "Needles")
    expect(chip(visitor)).to_contain_text("Chosen: needles")
    visitor.until(lambda: visitor.traced[-1].get("settings", {}).get("foliage") == "needles")
    visitor.until(lambda: visitor.preview.screenshot() != before)
    visitor.shot("taken-needles")
    change(visitor, "As in the photo")
    expect(chip(visitor)).to_contain_text("Taken for: leaves")


def test_a_model_that_is_shown_is_made_again_as_the_kind_that_was_chosen(visitor: Visitor, service: Service) -> None:
    drawn(visitor)
    visitor.page.get_by_role("button", name="Grow", exact=True).click()
    visitor.wait_for_preview("model")
    count = len(service.models())
    change(visitor, "Bare")
    visitor.until(lambda: len(service.models()) == count + 1)
    assert service.models()[0]["settings"]["foliage"] == "bare"
    expect(visitor.page.get_by_role("progressbar")).to_be_hidden()
    expect(chip(visitor)).to_contain_text("Chosen: bare")
    visitor.reload()
    expect(chip(visitor)).to_contain_text("Chosen: bare")


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_the_choices_are_reached_by_keys_and_axe_finds_nothing_in_them(open_page: OpenPage, dark: bool) -> None:
    visitor = drawn(open_page(dark=dark))
    keyboard = visitor.page.keyboard
    opener = chip(visitor).get_by_title("Kind of tree")
    visitor.tab_to(opener)
    keyboard.press("Enter")
    radios = visitor.page.get_by_role("radiogroup", name="Kind of tree")
    visitor.tab_to(radios.get_by_role("radio", name="As in the photo"))
    assert visitor.violations() == []
    visitor.shot(f"taken-menu-{'dark' if dark else 'light'}")
    keyboard.press("ArrowDown")
    keyboard.press("ArrowDown")
    keyboard.press("Enter")
    expect(radios).to_be_hidden()
    expect(chip(visitor)).to_contain_text("Chosen: needles")
    expect(opener).to_be_focused()
