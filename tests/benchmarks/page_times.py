"""What somebody at the page waits for: its start, and from the pen's lift to the picture; `make bench` prints it.

A real browser, without a GPU, before a service on the same machine: a photo of 1200 x 1541 px with its crown and trunk,
to which short branches are drawn by mouse, one after another, each when the preview is at rest.
"""

import json
import random
import shutil
import tempfile
import time
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, ViewportSize, sync_playwright
from tests.benchmarks.service_times import PHOTO, STROKES, say
from tests.e2e.conftest import FLAGS
from tests.e2e.visitor import Visitor
from tests.running import serving

COUNT, STARTS = 16, 7
SIZE: ViewportSize = {"width": 1440, "height": 900}
_WATCH = """
    window.traced = []
    window.grown = []
    let lifted = 0
    addEventListener('pointerup', () => { lifted = performance.now() }, true)
    // Two frames later what an answer changed is on the screen.
    const painted = told => requestAnimationFrame(() => requestAnimationFrame(() => told(performance.now() - lifted)))
    const { json } = Response.prototype
    Response.prototype.json = async function () {
        const answer = await json.call(this)
        if (answer.skeleton) painted(time => (answer.grown ? grown : traced).push(time / 1000))
        return answer
    }
"""


def stroke(strokes: dict[str, Any]) -> list[list[float]]:
    """Choose a short stroke off the trunk, somewhere in the crown."""
    x, y = random.choice(strokes["branches"][0]["points"][6:])
    side = random.choice((-1, 1))
    return [[x, y], [x + side * random.uniform(40, 90), y - 40], [x + side * random.uniform(100, 200), y - 110]]


def start_seconds(data: Path) -> float:
    """Time `treestroke serve` from the command to the line that names the page, which responds by then."""
    began = time.perf_counter()
    with serving(data):
        return time.perf_counter() - began


def first_paint(browser: Browser, url: str) -> float:
    """Open the page with nothing cached; return the seconds until something of it is seen."""
    context = browser.new_context(viewport=SIZE)
    visitor = Visitor(context.new_page(), url)
    visitor.open()
    (painted,) = visitor.page.evaluate("performance.getEntriesByName('first-contentful-paint').map(e => e.startTime)")
    context.close()
    return float(painted) / 1000


def draw_branches(browser: Browser, url: str) -> None:
    """Draw, and say how long each stroke took to show."""
    strokes = json.loads(STROKES.read_text())
    context = browser.new_context(viewport=SIZE)
    context.add_init_script(_WATCH)
    visitor = Visitor(context.new_page(), url)
    visitor.open()
    visitor.choose(visitor.page.get_by_role("button", name="Choose a photo"), PHOTO)
    visitor.draw(strokes["crown"]["points"], close=True)
    visitor.until(lambda: visitor.page.evaluate("traced.length") == 1)
    crown = visitor.page.evaluate("traced[0]")
    visitor.draw(strokes["branches"][0]["points"], button="right")
    visitor.wait_for_preview("live")
    visitor.page.evaluate("traced.length = grown.length = 0")
    for number in range(COUNT):
        visitor.wait_for_rest()
        visitor.draw(stroke(strokes), button="right")
        visitor.until(lambda done=number + 1: visitor.page.evaluate("grown.length") == done)
    traced, grown = visitor.page.evaluate("[traced, grown]")
    say("page: pen up to the overlay's paint", traced)
    say("page: pen up to the live tree's paint", grown)
    say("page: the same for a photo's first crown", [crown])


def main() -> None:
    """Start the service, open the page and draw."""
    random.seed(1)
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        data = Path(folder) / "data"
        start_seconds(data)  # makes the tables, and Python's bytecode where it is missing
        say("service: command to the line with its address", [start_seconds(data) for _ in range(STARTS)])
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=list(FLAGS))
        with serving(data) as url:
            say("page: first contentful paint, nothing cached", [first_paint(browser, url) for _ in range(STARTS)])
            draw_branches(browser, url)
        browser.close()


if __name__ == "__main__":
    main()
