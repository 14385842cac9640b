"""A tree that moves as it was filmed: a video chosen, sent, outlined, grown, and watched beside the tree."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, Route, expect
from tests.clips import STROKES, SYNTHETIC_ASH, film, swaying
from tests.e2e.conftest import OpenPage, Service
from tests.e2e.visitor import Visitor

CROWN = [
    *([330, 55], [375, 140], [385, 200], [470, 215], [440, 300], [370, 330]),
    *([260, 325], [250, 270], [190, 240], [220, 180], [290, 130]),
]
"""Around the leaves of the synthetic ash, px."""
TRUNK = [[326, 438], [326, 300], [328, 180]]


@pytest.fixture(scope="module")
def clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A second and a half of a crown that sways, in a form that no browser plays."""
    return film(tmp_path_factory.mktemp("clips") / "swaying.avi", swaying())


def opened(visitor: Visitor, video: Path) -> Page:
    """Choose a video and have it used."""
    page = visitor.page
    visitor.choose(page.get_by_role("button", name="Choose a video"), video)
    page.get_by_role("button", name="Use this video").click()
    expect(page.get_by_role("slider", name="Frame that is drawn on")).to_be_visible()
    return page


def test_a_video_becomes_a_tree_that_moves_in_step_with_it(open_page: OpenPage, service: Service) -> None:
    visitor = open_page()
    page = opened(visitor, SYNTHETIC_ASH)
    visitor.draw(CROWN, close=True)
    visitor.draw(TRUNK, button="right")
    visitor.wait_for_preview("live")
    page.get_by_role("button", name="Watch").click()
    expect(page.get_by_text(re.compile("points of the tree are followed"))).to_be_visible()
    visitor.shot("tracks")
    page.get_by_role("button", name="Grow", exact=True).click()
    visitor.wait_for_preview("model")
    motions = page.get_by_role("group", name="Motion")
    expect(motions.get_by_role("button", name="Measured")).to_have_attribute("aria-pressed", "true")
    place = page.get_by_role("slider", name="Place in time")
    expect(place).to_have_count(1)
    place.fill("1")
    expect(page.get_by_text("31 / 120")).to_be_visible()
    visitor.wait_for_rest()
    visitor.shot("in-step")
    assert not visitor.violations()
    assert service.models()[0]["clip"]
    visitor.reload()
    visitor.wait_for_preview("model")
    expect(page.get_by_role("button", name="Draw", exact=True)).to_be_visible()


def test_a_frame_is_chosen_by_keys_and_the_outline_stays(visitor: Visitor, clip: Path) -> None:
    page = opened(visitor, clip)
    visitor.draw(STROKES["crown"]["points"], close=True)
    frames = page.get_by_role("slider", name="Frame that is drawn on")
    frames.press("PageUp")
    frames.press("ArrowRight")
    expect(page.get_by_text("Frame 12 of 45")).to_be_visible()
    visitor.until(lambda: visitor.traced[-1]["frame"] == 11)
    assert visitor.traced[-1]["crown"]["points"] == visitor.traced[0]["crown"]["points"]
    page.keyboard.press("Control+z")
    expect(page.get_by_text("Frame 1 of 45")).to_be_visible()


def test_a_video_that_the_browser_cannot_play_is_shown_frame_by_frame(visitor: Visitor, clip: Path) -> None:
    page = opened(visitor, clip)
    with page.expect_response(re.compile(r"/frames/\d+\?height=480")):
        page.get_by_role("button", name="Watch").click()
    expect(page.get_by_role("slider", name="Place in time")).to_be_visible()
    page.get_by_role("button", name="Pause").click()
    visitor.shot("frame-by-frame")


def test_sending_goes_on_after_a_lost_connection(visitor: Visitor, clip: Path) -> None:
    lost: list[Route] = []

    def lose(route: Route) -> None:
        if lost or route.request.method != "PATCH":
            route.continue_()
        else:
            lost.append(route)
            route.abort()

    visitor.page.route("**/v1/uploads/*", lose)
    visitor.expect_complaint("ERR_FAILED")
    opened(visitor, clip)
    assert lost


def test_a_clip_in_which_nothing_moves_gets_a_sentence(visitor: Visitor, tmp_path: Path) -> None:
    page = visitor.page
    still = film(tmp_path / "still.avi", swaying(1) * 45)
    visitor.expect_complaint("status of 4")
    visitor.choose(page.get_by_role("button", name="Choose a video"), still)
    page.get_by_role("button", name="Use this video").click()
    expect(page.get_by_role("dialog").get_by_role("alert")).to_contain_text("moves")
    visitor.shot("nothing-moves")


def test_a_project_with_a_video_opens_again(visitor: Visitor, open_page: OpenPage, clip: Path, tmp_path: Path) -> None:
    opened(visitor, clip)
    visitor.draw(STROKES["crown"]["points"], close=True)
    visitor.until(lambda: bool(visitor.traced))
    with visitor.page.expect_download() as download:
        visitor.page.keyboard.press("Control+s")
    kept = tmp_path / download.value.suggested_filename
    download.value.save_as(kept)
    other = open_page()
    other.give(other.page.locator("body"), kept, media_type="application/octet-stream")
    expect(other.page.get_by_text("Frame 1 of 45")).to_be_visible()
    other.until(lambda: bool(other.traced))
    assert other.traced[-1]["crown"] == visitor.traced[-1]["crown"]
