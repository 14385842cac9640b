"""Somebody at the page: draws by mouse or fingers, looks, and hears every complaint of the browser."""

import base64
import json
import re
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from playwright.sync_api import ConsoleMessage, Locator, Page, Request, expect

ROOT = Path(__file__).parents[2]
SHOTS = ROOT / "out" / "e2e"
AXE = ROOT / "frontend" / "node_modules" / "axe-core" / "axe.min.js"
PATIENCE_MS = 150_000
"""For one thing to happen: without a GPU a frame of a tree takes seconds, and on a busy machine a tree a minute."""
REST_MS = 250
"""By the page's clock: longer than the preview waits before it draws its last frame again, with all pixels."""
STILL_MS = 100
"""By the page's clock: longer than the sheet takes from one step of a movement to the next."""
JSON = {"Content-Type": "application/json"}
expect.set_options(timeout=PATIENCE_MS)
Point = Sequence[float]
Path2D = Sequence[Point]

_LISTEN = """addEventListener('securitypolicyviolation', event =>
    console.error(`policy: ${event.violatedDirective} ${event.blockedURI} ${event.sourceFile}:${event.lineNumber}`))"""
_DROP = """(target, file) => {
    const bytes = Uint8Array.from(atob(file.content), one => one.charCodeAt(0))
    const dataTransfer = new DataTransfer()
    dataTransfer.items.add(new File([bytes], file.name, { type: file.type }))
    const events = file.how === 'paste'
        ? [new ClipboardEvent('paste', { clipboardData: dataTransfer, bubbles: true, cancelable: true })]
        : ['dragenter', 'dragover', 'drop'].map(name =>
            new DragEvent(name, { dataTransfer, bubbles: true, cancelable: true, clientY: file.y }))
    for (const event of events) target.dispatchEvent(event)
}"""
_PAUSE = """ms => new Promise(over =>
    setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(over)), ms))"""
"""Timers and frames that the page has asked for by then come first, however slow the machine is."""
_AXE = """async () => (await axe.run()).violations.map(one =>
    `${one.impact} ${one.id}: ${one.help}: ${one.nodes.map(node => node.target.join(' ')).join(', ')}`)"""


@dataclass(frozen=True)
class View:
    """Where the photo lies on the page: pixels of the page for each of the photo's, and the photo's corner."""

    scale: float
    left: float
    top: float

    def at(self, point: Point) -> tuple[float, float]:
        """Turn a point of the photo into one of the page."""
        return self.left + point[0] * self.scale, self.top + point[1] * self.scale


class Visitor:
    """One page in a browser, and whoever sits before it.

    Everything that a page must not do is a complaint: errors in the console, exceptions, breaches of the content's
    policy, requests to anywhere but its service, a crash. The fixture that made the visitor fails on any.
    """

    def __init__(self, page: Page, url: str) -> None:
        self.page, self.url = page, url
        self.complaints: list[str] = []
        self.traced: list[dict[str, Any]] = []
        """What was asked to be traced, in the order of asking."""
        self.sheet = "front"
        """The one that is drawn on: the front's, or the side's."""
        self._trace = ""
        self._expected: list[str] = []
        page.on("console", self._said)
        page.on("pageerror", lambda error: self.complaints.append(f"exception: {error}"))
        page.on("crash", lambda _: self.complaints.append("the page crashed"))
        page.on("request", self._asked)
        page.on("filechooser", lambda _: None)  # from now on, or the first key might come before it is listened to
        page.add_init_script(_LISTEN)

    def _said(self, message: ConsoleMessage) -> None:
        if message.type == "error":
            self.complaints.append(f"console: {message.text} ({message.location['url']})")

    def _asked(self, request: Request) -> None:
        if not request.url.startswith((f"{self.url}/", "blob:", "data:")):
            self.complaints.append(f"asked elsewhere: {request.url}")
        if request.url.endswith("/trace"):
            self._trace = request.url
            self.traced.append(request.post_data_json)

    def expect_complaint(self, pattern: str) -> None:
        """Take complaints of this form as what the test is about: a refused file is told in the console, too."""
        self._expected.append(pattern)

    def unexpected(self) -> list[str]:
        """Give the complaints that no test foresaw."""
        return [one for one in self.complaints if not any(re.search(pattern, one) for pattern in self._expected)]

    # Looking

    def open(self, path: str = "/") -> None:
        """Go to the page and wait until it can be used."""
        self.page.goto(self.url + path)
        self.wait_until_ready()

    def reload(self) -> None:
        self.page.reload()
        self.wait_until_ready()

    def wait_until_ready(self) -> None:
        self.page.locator("[data-ready]").wait_for(state="attached")

    @property
    def sketch(self) -> Locator:
        """The sheet over the photo, or of paper, which says how it lies."""
        return self.page.locator(f'.canvas > [data-sheet="{self.sheet}"]')

    @property
    def preview(self) -> Locator:
        """What shows the tree; it says how it stands."""
        return self.page.locator("[data-state]")

    def wait_for_preview(self, state: str) -> None:
        """Wait until the preview is empty, live, growing or a model."""
        expect(self.preview).to_have_attribute("data-state", state)

    def drawn(self) -> tuple[int, int]:
        """Count the frames that the preview has drawn so far, and the draw calls of the last."""
        frames, calls = (self.preview.get_attribute(f"data-{name}") for name in ("frames", "calls"))
        return int(frames or 0), int(calls or 0)

    def wait_for_rest(self) -> None:
        """Wait until the preview has drawn what it has to draw."""
        began = time.monotonic()
        before = (-1, 0)
        while self.drawn() != before:
            assert time.monotonic() - began < PATIENCE_MS / 1000, "the preview draws on and on"
            before = self.drawn()
            self.pause(REST_MS)

    def wait_until_still(self) -> None:
        """Wait until the wheel or a drag has moved the sheet to its place."""
        before = ""
        while not before or before != self.sketch.get_attribute("data-view"):
            before = self.sketch.get_attribute("data-view") or ""
            self.pause(STILL_MS)

    def pause(self, page_ms: int) -> None:
        """Let time pass on the page's clock, and two frames."""
        self.page.evaluate(_PAUSE, page_ms)

    def until(self, holds: Callable[[], bool]) -> None:
        """Wait until something holds."""
        began = time.monotonic()
        while not holds():
            assert time.monotonic() - began < PATIENCE_MS / 1000, "it never came to hold"
            self.page.wait_for_timeout(50)

    def wait_until_traced(self) -> None:
        """Wait until the page shows what was traced along the strokes as they are now.

        An undo before that leads back to strokes that it still has a trace of, and asks for nothing.
        """
        expect(self.page.locator(".sketch-stale")).to_have_count(0)

    def skeleton(self) -> dict[str, Any]:
        """Ask the service for what it traced last, once more."""
        answer = self.page.request.post(self._trace, data=json.dumps(self.traced[-1]), headers=JSON)
        skeleton: dict[str, Any] = answer.json()["skeleton"]
        return skeleton

    def view(self) -> View:
        """Find where the photo lies now."""
        box = self.sketch.bounding_box()
        scale, x, y = (float(part) for part in (self.sketch.get_attribute("data-view") or "").split(","))
        assert box is not None
        return View(scale, box["x"] + x, box["y"] + y)

    def shot(self, name: str) -> Path:
        """Keep a picture of the page as an artefact."""
        SHOTS.mkdir(parents=True, exist_ok=True)
        path = SHOTS / f"{name}.png"
        self.page.screenshot(path=path, animations="disabled", timeout=PATIENCE_MS)
        return path

    def violations(self) -> list[str]:
        """Let axe judge how usable the page is to everyone, as it stands."""
        self.page.evaluate(f"{AXE.read_text()}; null")
        found: list[str] = self.page.evaluate(_AXE)
        return found

    # Drawing and giving

    def tab_to(self, target: Locator, most: int = 60) -> None:
        """Press Tab until something has the focus."""
        for _ in range(most):
            if target.evaluate("element => element === document.activeElement"):
                return
            self.page.keyboard.press("Tab")
        raise AssertionError(f"{most} tabs do not lead to {target}")

    def walk(self, key: str, steps: int) -> None:
        """Press a key again and again."""
        for _ in range(steps):
            self.page.keyboard.press(key)

    def draw(self, points: Path2D, button: str = "left", close: bool = False) -> None:
        """Draw a stroke by mouse through points of the photo; `close` leads it back to where it began."""
        view, mouse = self.view(), self.page.mouse
        way = [view.at(point) for point in (*points, *points[: 1 if close else 0])]
        mouse.move(*way[0])
        mouse.down(button="right" if button == "right" else "left")
        for x, y in way[1:]:
            mouse.move(x, y, steps=3)
        mouse.up(button="right" if button == "right" else "left")

    def draw_tree(self, strokes: dict[str, Any]) -> None:
        """Draw the crown with the left button and every branch with the right one, as the paper has it."""
        self.draw(strokes["crown"]["points"], close=True)
        for branch in strokes["branches"]:
            self.draw(branch["points"], button="right")

    def touch(self, *fingers: Path2D) -> None:
        """Move fingers over points of the photo at once; each has a point for every moment from its first to the end.

        A finger with fewer points than the first comes down later; all are lifted together.
        """
        view, moments = self.view(), len(fingers[0])
        session = self.page.context.new_cdp_session(self.page)
        down = 0
        for moment in range(moments):
            touching = [one[moment - moments + len(one)] for one in fingers if moment >= moments - len(one)]
            points = [
                {"x": x, "y": y, "id": number} for number, (x, y) in enumerate(view.at(point) for point in touching)
            ]
            kind = "touchStart" if len(points) > down else "touchMove"
            session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
            down = len(points)
        session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        session.detach()

    def choose(self, opener: Locator, *files: Path | dict[str, Any]) -> None:
        """Press what opens the choice of a file, and choose."""
        with self.page.expect_file_chooser() as chooser:
            opener.click()
        chooser.value.set_files(list(files))  # type: ignore[arg-type]

    def give(
        self, target: Locator, file: Path, how: str = "drop", media_type: str = "image/jpeg", down: float = 0
    ) -> None:
        """Drop a file on a part of the page, or paste it there; ``down`` is where, as a share of the part's height."""
        content, box = base64.b64encode(file.read_bytes()).decode(), target.bounding_box()
        assert box is not None
        y = box["y"] + down * box["height"]
        target.evaluate(_DROP, {"content": content, "name": file.name, "type": media_type, "how": how, "y": y})


def strokes_of(photo: Path) -> dict[str, Any]:
    """Read the strokes that lie beside a photo."""
    read: dict[str, Any] = json.loads(photo.with_suffix(".strokes.json").read_text())
    return read
