"""A tree under way: reload, cancel, a lost connection; and what becomes of it in the gallery."""

from playwright.sync_api import expect
from tests.e2e.conftest import OpenPage, Service
from tests.e2e.visitor import Visitor

NO_WEBGL = """HTMLCanvasElement.prototype.getContext = new Proxy(HTMLCanvasElement.prototype.getContext, {
    apply: (get, canvas, [kind, ...how]) => (kind.startsWith('webgl') ? null : get.call(canvas, kind, ...how)),
})"""
LONG = "1500"
"""Rounds of growth that last long enough to do something meanwhile."""


def begin(visitor: Visitor, service: Service, seed: str) -> int:
    """Have a large tree grown of an example's strokes; say how many models there are then."""
    page = visitor.page
    page.get_by_role("button", name="Young oak").click()
    visitor.wait_for_preview("model")
    page.get_by_role("button", name="Settings").click()
    page.get_by_label("Growth", exact=True).first.fill(LONG)
    page.get_by_label("Seed").first.fill(seed)
    page.keyboard.press("Escape")
    count = len(service.models())
    page.get_by_role("button", name="Grow again").click()
    expect(page.get_by_role("progressbar")).to_be_visible()
    visitor.until(lambda: len(service.models()) == count + 1)
    return count + 1


def test_a_page_that_is_loaded_anew_finds_its_growing_tree(visitor: Visitor, service: Service) -> None:
    count = begin(visitor, service, "11")
    visitor.shot("growing")
    visitor.reload()
    expect(visitor.page.get_by_role("progressbar")).to_be_visible()
    visitor.wait_for_preview("model")
    assert len(service.models()) == count
    assert service.models()[0]["settings"]["iterations"] == int(LONG)


def test_a_tree_that_is_canceled_stops_and_the_strokes_stay(visitor: Visitor, service: Service) -> None:
    begin(visitor, service, "12")
    visitor.page.get_by_role("button", name="Cancel").click()
    expect(visitor.page.get_by_text("Growing was canceled.").first).to_be_visible()
    visitor.shot("canceled")
    assert service.models()[0]["status"] == "canceled"
    expect(visitor.page.get_by_role("button", name="Grow again")).to_be_enabled()
    expect(visitor.page.get_by_role("button", name="Grow again")).to_be_focused()


def test_a_lost_connection_is_told_and_mends_itself(visitor: Visitor) -> None:
    visitor.page.get_by_role("button", name="Young oak").click()
    visitor.wait_for_preview("model")
    visitor.expect_complaint("ERR_INTERNET_DISCONNECTED")
    visitor.page.context.set_offline(True)
    visitor.draw([[700.0, 800.0], [760.0, 700.0], [800.0, 620.0]], button="right")
    expect(visitor.page.get_by_text("The connection is lost.").first).to_be_visible()
    visitor.shot("offline")
    asked = len(visitor.traced)
    visitor.page.context.set_offline(False)
    visitor.wait_for_preview("live")
    assert len(visitor.traced) > asked
    expect(visitor.page.get_by_text("The connection is lost.").first).to_be_hidden()


def test_the_gallery_names_deletes_brings_back_and_opens(visitor: Visitor, service: Service) -> None:
    page = visitor.page
    page.get_by_role("button", name="Osage orange").click()
    visitor.wait_for_preview("model")
    page.get_by_role("button", name="Gallery").click()
    gallery = page.get_by_role("dialog")
    gallery.get_by_role("button", name="Rename Osage orange").first.click()
    gallery.get_by_role("textbox").first.fill("The old hedge")
    page.keyboard.press("Enter")
    expect(gallery.get_by_role("button", name="Open The old hedge")).to_be_visible()
    visitor.shot("gallery")
    gallery.get_by_role("button", name="Delete The old hedge").click()
    expect(gallery.get_by_text("The old hedge is deleted.")).to_be_visible()
    visitor.until(lambda: service.models()[0]["name"] != "The old hedge")
    gallery.get_by_role("button", name="Undo").click()
    expect(gallery.get_by_role("button", name="Open The old hedge")).to_be_visible()
    gallery.get_by_role("button", name="Open The old hedge").click()
    expect(gallery).to_be_hidden()
    visitor.wait_for_preview("model")
    expect(page.get_by_role("textbox", name="Name of the drawing")).to_have_value("The old hedge")


def test_the_3d_view_comes_back_after_its_context_was_lost(visitor: Visitor) -> None:
    visitor.page.get_by_role("button", name="Osage orange").click()
    visitor.wait_for_preview("model")
    visitor.wait_for_rest()
    canvas = visitor.preview.locator("canvas").first
    frames, _ = visitor.drawn()
    lose = (
        "canvas => { window.held = canvas.getContext('webgl2').getExtension('WEBGL_lose_context'); held.loseContext() }"
    )
    canvas.evaluate(lose)
    expect(visitor.page.get_by_text("The 3D view was lost and is coming back.").first).to_be_visible()
    canvas.evaluate("() => held.restoreContext()")
    expect(visitor.page.get_by_text("The 3D view was lost and is coming back.").first).to_be_hidden()
    visitor.until(lambda: visitor.drawn()[0] > frames)


def test_without_webgl_a_tree_is_grown_shown_as_a_picture_and_taken_home(open_page: OpenPage) -> None:
    visitor = open_page(script=NO_WEBGL)
    page = visitor.page
    page.get_by_role("button", name="Osage orange").click()
    expect(page.get_by_text("This browser shows no 3D").first).to_be_visible()
    expect(page.get_by_role("img", name="The grown tree")).to_be_visible()
    visitor.shot("without-webgl")
    with page.expect_download() as download:
        page.get_by_role("link", name="Download GLB").click()
    assert download.value.suggested_filename.endswith(".glb")
