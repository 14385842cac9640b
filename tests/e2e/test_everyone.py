"""Bad files, small and large screens, dark and light: what everyone meets."""

from pathlib import Path

import pytest
from playwright.sync_api import expect
from tests.e2e.conftest import OpenPage
from tests.e2e.visitor import Visitor

OVERFLOW = "() => document.documentElement.scrollWidth - document.documentElement.clientWidth"


def test_a_file_that_is_no_photo_is_told_in_place(visitor: Visitor, tmp_path: Path) -> None:
    visitor.expect_complaint("422")
    bad = tmp_path / "tree.jpg"
    bad.write_text("no picture")
    visitor.give(visitor.page.locator("body"), bad)
    expect(visitor.page.get_by_role("alert").filter(has_text="no JPEG, PNG or WebP")).to_be_visible()
    visitor.shot("bad-file")


def test_a_bad_file_leaves_an_open_drawing_as_it_was(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.page
    visitor.expect_complaint("422")
    page.get_by_role("button", name="Osage orange").click()
    visitor.wait_for_preview("model")
    bad = tmp_path / "tree.png"
    bad.write_bytes(b"\x89PNG no picture")
    visitor.give(page.locator("body"), bad, how="paste", media_type="image/png")
    expect(page.get_by_text("no JPEG, PNG or WebP").filter(visible=True)).to_be_visible()
    expect(page.get_by_role("textbox", name="Name of the drawing")).to_have_value("Osage orange")
    visitor.wait_for_preview("model")


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_axe_finds_nothing_from_the_welcome_to_the_gallery(open_page: OpenPage, dark: bool) -> None:
    visitor = open_page(dark=dark, still=True)
    page = visitor.page
    assert visitor.violations() == []
    page.get_by_role("button", name="Sugar maple in autumn").click()
    visitor.wait_for_preview("model")
    expect(page.get_by_role("link", name="Download GLB")).to_be_visible()
    assert visitor.violations() == []
    for name in ("Settings", "Details", "More downloads", "Gallery", "Shortcuts"):
        page.get_by_role("button", name=name, exact=True).first.click()
        page.wait_for_timeout(300)
        visitor.shot(f"{name.lower().replace(' ', '-')}-{'dark' if dark else 'light'}")
        assert visitor.violations() == [], name
        page.keyboard.press("Escape")


@pytest.mark.parametrize(
    ("size", "percent"),
    [((360, 640), 100), ((390, 844), 100), ((360, 740), 200), ((1440, 900), 200), ((2560, 1440), 100)],
)
def test_nothing_is_cut_off_at_any_size(open_page: OpenPage, size: tuple[int, int], percent: int) -> None:
    visitor = open_page(viewport=size, still=True)
    page = visitor.page
    page.evaluate(f"document.documentElement.style.fontSize = '{percent}%'")
    assert page.evaluate(OVERFLOW) <= 0
    visitor.shot(f"welcome-{size[0]}x{size[1]}-{percent}")
    page.get_by_role("button", name="Sugar maple in autumn").click()
    visitor.wait_for_preview("model")
    assert page.evaluate(OVERFLOW) <= 0
    visitor.shot(f"workspace-{size[0]}x{size[1]}-{percent}")
    for name in ("Crown", "Undo", "Grow"):
        button = page.get_by_role("button", name=name).first
        if percent > 100:  # with such letters on a phone the page is scrolled
            button.scroll_into_view_if_needed()
        expect(button).to_be_in_viewport()
