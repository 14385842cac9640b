"""Bad files, small and large screens, dark and light: what everyone meets."""

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import expect
from tests.api.corpora import saved
from tests.e2e.conftest import OpenPage
from tests.e2e.visitor import ROOT, Visitor

EXAMPLE = ROOT / "examples" / "oak_02.jpg"
OVERFLOW = "() => document.documentElement.scrollWidth - document.documentElement.clientWidth"


def test_a_file_that_is_no_photo_is_told_in_place(visitor: Visitor, tmp_path: Path) -> None:
    visitor.expect_complaint("422")
    bad = tmp_path / "tree.jpg"
    bad.write_text("no picture")
    visitor.give(visitor.page.locator("body"), bad)
    expect(
        visitor.page.get_by_role("alert").filter(has_text="not a photo that can be read; save it as JPEG, PNG")
    ).to_be_visible()
    visitor.shot("bad-file")


def test_a_bad_file_leaves_an_open_drawing_as_it_was(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.page
    visitor.expect_complaint("422")
    page.get_by_role("button", name="Osage orange").click()
    visitor.wait_for_preview("model")
    bad = tmp_path / "tree.png"
    bad.write_bytes(b"\x89PNG no picture")
    visitor.give(page.locator("body"), bad, how="paste", media_type="image/png")
    expect(page.get_by_text("not a photo that can be read").filter(visible=True)).to_be_visible()
    expect(page.get_by_role("textbox", name="Name of the drawing")).to_have_value("Osage orange")
    visitor.wait_for_preview("model")


@pytest.mark.parametrize("media_type", ["image/heic", ""], ids=["typed", "untyped"])
def test_a_phones_photo_is_shown_though_the_browser_cannot_draw_it(
    visitor: Visitor, tmp_path: Path, media_type: str
) -> None:
    photo = tmp_path / "Old oak.heic"
    photo.write_bytes(saved(Image.open(EXAMPLE), "HEIF"))
    visitor.give(visitor.page.locator("body"), photo, media_type=media_type)
    expect(visitor.page.get_by_role("textbox", name="Name of the drawing")).to_have_value("Old oak")
    visitor.sketch.wait_for()
    visitor.until(lambda: shown(visitor).std() > 30)
    visitor.shot(f"heic-{media_type.count('/')}")


def test_a_phones_photo_lies_under_the_side_sheet(visitor: Visitor, tmp_path: Path) -> None:
    photo = tmp_path / "left.heic"
    photo.write_bytes(saved(Image.open(EXAMPLE), "HEIF"))
    visitor.page.get_by_role("button", name="Draw it yourself").click()
    visitor.sheet = "side"
    visitor.sketch.wait_for()
    before = shown(visitor).std()
    visitor.give(visitor.sketch, photo, media_type="", down=0.2)
    visitor.until(lambda: shown(visitor).std() > before + 20)
    visitor.shot("heic-under-the-side")


def test_a_photo_that_lacks_its_last_bytes_is_opened_and_that_is_said(visitor: Visitor, tmp_path: Path) -> None:
    photo = tmp_path / "short.jpg"
    photo.write_bytes(EXAMPLE.read_bytes()[:-2])
    visitor.give(visitor.page.locator("body"), photo)
    visitor.sketch.wait_for()
    expect(visitor.page.get_by_text("file is cut short, but nothing of its picture is missing").first).to_be_visible()
    visitor.shot("cut-short")


def shown(visitor: Visitor) -> np.ndarray:
    """Take a picture of the sheet."""
    return np.asarray(Image.open(io.BytesIO(visitor.sketch.screenshot())).convert("L"), dtype=float)


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_axe_finds_nothing_from_the_welcome_to_the_gallery(open_page: OpenPage, dark: bool) -> None:
    visitor = open_page(dark=dark)
    page = visitor.page
    assert visitor.violations() == []
    page.get_by_role("button", name="Sugar maple in autumn").click()
    visitor.wait_for_preview("model")
    expect(page.get_by_role("link", name="Download GLB")).to_be_visible()
    assert visitor.violations() == []
    for name in ("Settings", "Details", "More downloads", "Gallery", "Shortcuts"):
        page.get_by_role("button", name=name, exact=True).first.click()
        visitor.pause(300)
        visitor.shot(f"{name.lower().replace(' ', '-')}-{'dark' if dark else 'light'}")
        assert visitor.violations() == [], name
        page.keyboard.press("Escape")


@pytest.mark.parametrize(
    ("size", "percent"),
    [((360, 640), 100), ((390, 844), 100), ((360, 740), 200), ((1440, 900), 200), ((2560, 1440), 100)],
)
def test_nothing_is_cut_off_at_any_size(open_page: OpenPage, size: tuple[int, int], percent: int) -> None:
    visitor = open_page(viewport=size)
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
