"""From a photo to a tree, by somebody who has read nothing."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Route, expect
from tests.e2e.conftest import OpenPage, Service
from tests.e2e.visitor import ROOT, Visitor, strokes_of

PHOTO = ROOT / "examples" / "osage_orange_autumn.jpg"
MOST_CALLS = 6
GPU = """
    const { getParameter } = WebGL2RenderingContext.prototype
    WebGL2RenderingContext.prototype.getParameter = function (name) {
        return name === 0x9246 ? 'A graphics processor' : getParameter.call(this, name)
    }
    const now = performance.now.bind(performance)
    performance.now = () => now() / 1000
    window.mostCalls = 0
    new MutationObserver(changes => {
        for (const { target } of changes) mostCalls = Math.max(mostCalls, Number(target.dataset.calls))
    }).observe(document, { subtree: true, attributeFilter: ['data-calls'] })
"""
"""Has the page take the software's WebGL for a graphics processor, and its frames for fast ones; counts their calls."""


def follow_the_hints(visitor: Visitor) -> None:
    """Choose a photo, draw the crown with the left button and the trunk with the right one."""
    page, strokes = visitor.page, strokes_of(PHOTO)
    visitor.shot("welcome")
    visitor.choose(page.get_by_role("button", name="Choose a photo"), PHOTO)
    expect(page.get_by_text("Draw a loose line around all of the leaves.")).to_be_visible()
    visitor.draw(strokes["crown"]["points"], close=True)
    expect(page.get_by_text("Now draw up the trunk")).to_be_visible()
    visitor.shot("crown")
    visitor.draw(strokes["branches"][0]["points"], button="right")
    visitor.wait_for_preview("live")


def test_the_welcome_is_there_before_the_code_that_draws(visitor: Visitor) -> None:
    page = visitor.page
    held: list[Route] = []
    page.route("**/assets/Workspace-*.js", lambda route: held.append(route))
    page.reload()
    page.get_by_role("button", name="Choose a photo").wait_for()
    assert page.locator("[data-ready]").count() == 0
    visitor.until(lambda: len(held) == 1)
    held[0].continue_()
    visitor.wait_until_ready()


def test_a_newcomer_gets_from_a_photo_to_a_tree_and_takes_it_home(
    open_page: OpenPage, service: Service, tmp_path: Path
) -> None:
    visitor = open_page(still=False)
    page = visitor.page
    follow_the_hints(visitor)
    visitor.shot("live")
    page.get_by_role("button", name="Grow", exact=True).click()
    visitor.wait_for_preview("model")
    expect(page.get_by_text("match with the foliage and branches").first).to_be_visible()
    visitor.shot("grown")
    with page.expect_download() as download:
        page.get_by_role("link", name="Download GLB").click()
    glb = Path(download.value.path()).read_bytes()
    model = service.models()[0]
    assert download.value.suggested_filename == "osage_orange_autumn.glb"
    assert glb[:4] == b"glTF"
    assert glb == service.client.get(model["files"]["tree.glb"]).content
    assert re.search(rf"#{model['id']}$", page.url)
    expect(page).to_have_title("osage_orange_autumn – treestroke")


def test_the_strokes_that_arrive_are_those_that_were_drawn(visitor: Visitor) -> None:
    drawn = strokes_of(PHOTO)
    follow_the_hints(visitor)
    crown, trunk = visitor.traced[-1]["crown"]["points"], visitor.traced[-1]["branches"][0]["points"]
    for point in drawn["crown"]["points"]:
        assert min(abs(x - point[0]) + abs(y - point[1]) for x, y in crown) < 1
    assert trunk[0] == pytest.approx(drawn["branches"][0]["points"][0], abs=0.5)
    assert trunk[-1] == pytest.approx(drawn["branches"][0]["points"][-1], abs=0.5)


def test_one_click_on_an_example_shows_a_tree_drawn_in_few_calls_and_only_when_something_changes(
    open_page: OpenPage,
) -> None:
    visitor = open_page(still=False)
    visitor.page.get_by_role("button", name="Sugar maple in autumn").click()
    visitor.wait_for_preview("model")
    visitor.wait_for_rest()
    frames, calls = visitor.drawn()
    assert 1 <= calls <= MOST_CALLS
    visitor.pause(1500)
    assert visitor.drawn()[0] == frames
    visitor.page.get_by_role("button", name="Side", exact=True).click()
    visitor.wait_for_rest()
    visitor.shot("side")
    assert visitor.drawn()[0] > frames


def test_with_shadows_a_tree_takes_no_more_than_six_calls(open_page: OpenPage) -> None:
    visitor = open_page(viewport=(900, 440), script=GPU)
    visitor.page.get_by_role("button", name="Osage orange").click()
    visitor.wait_for_preview("model")
    visitor.page.get_by_role("combobox", name="View").select_option("side")
    for _ in range(2):
        visitor.page.get_by_role("button", name="Leaves", exact=True).click()
        visitor.wait_for_rest()
    visitor.shot("shadows")
    assert visitor.page.evaluate("mostCalls") == MOST_CALLS


def test_a_tree_that_is_slow_to_come_does_not_keep_the_welcome_away(visitor: Visitor) -> None:
    page = visitor.page
    held: list[Route] = []
    page.route("**/v1/models/mdl_*", lambda route: held.append(route))
    page.goto("about:blank")
    page.goto(f"{visitor.url}/#mdl_{'0' * 24}")
    page.get_by_role("button", name="Choose a photo").wait_for()
    visitor.until(lambda: len(held) == 1)
    assert page.locator("[data-ready]").count() == 0
    visitor.expect_complaint("404")
    held[0].continue_()
    visitor.wait_until_ready()
    expect(page.get_by_role("alert").filter(has_text="This tree is no longer there")).to_be_visible()


def test_a_link_opens_the_tree_for_somebody_else(open_page: OpenPage, service: Service) -> None:
    model = next(model for model in service.models() if model["status"] == "succeeded")
    other = open_page(f"/#{model['id']}")
    other.wait_for_preview("model")
    expect(other.page.get_by_role("textbox", name="Name of the drawing")).to_have_value(model["name"])
    assert other.traced[-1]["crown"]["points"]


def test_a_project_that_was_saved_opens_again(visitor: Visitor, open_page: OpenPage, tmp_path: Path) -> None:
    follow_the_hints(visitor)
    with visitor.page.expect_download() as download:
        visitor.page.keyboard.press("Control+s")
    kept = tmp_path / download.value.suggested_filename
    download.value.save_as(kept)
    assert kept.suffix == ".treestroke"
    other = open_page()
    other.give(other.page.locator("body"), kept, media_type="application/octet-stream")
    other.wait_for_preview("live")
    assert other.traced[-1]["crown"] == visitor.traced[-1]["crown"]
    assert other.traced[-1]["branches"] == visitor.traced[-1]["branches"]
