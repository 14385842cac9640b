"""Films a page: its clock moves only from frame to frame, so that slow drawing gives a smooth film."""

import io
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from PIL import Image, ImageDraw
from playwright.sync_api import BrowserContext, Locator
from tests.e2e.visitor import PATIENCE_MS, Path2D, Point, Visitor

from treestroke.core.types import Floats

Button = Literal["left", "right"]

STEP_MS = 120
"""Time on the page from one frame to the next."""
FRAME_MS = 66
"""How long a frame is shown: the film runs faster than the page."""
WIDTH = 900
KEY_FRAMES = 24, 32
"""A whole frame comes at least and at most so many frames after another; what encoding has left behind goes with it."""
_DOT, _PRESSED_DOT, _RIM = 7.5, 5.5, 1.7
"""Radii of the pointer, and the width of its rim, px of the film."""
_FINENESS = 4
"""The pointer is drawn so many times larger and reduced, which smooths its edge."""
_OPENED, _FILMED = "2026-10-10T10:00:00", "2026-10-10T11:00:00"
"""What the page's clock shows when the page opens, and where it stops."""


class Film:
    """Opens the page by a clock that only the film moves; takes frames of it, with the pointer drawn over them."""

    def __init__(self, context: BrowserContext, url: str) -> None:
        context.clock.install(time=_OPENED)
        self.page = context.new_page()
        self.visitor = Visitor(self.page, url)
        self.frames: list[Image.Image] = []
        self.shown_ms: list[int] = []
        self._pressed = False
        self.visitor.open()
        self.page.clock.pause_at(_FILMED)
        self.size = self.page.viewport_size or {"width": 0, "height": 0}
        self._go((0.6 * self.size["width"], 0.85 * self.size["height"]))

    def shoot(self, frames: int = 1) -> None:
        """Let the page's time pass, and take a frame at each step."""
        for _ in range(frames):
            self.page.clock.fast_forward(STEP_MS)
            self.frames.append(self._frame())
            self.shown_ms.append(FRAME_MS)

    def hold(self, seconds: float) -> None:
        """Take one frame that is shown for some seconds."""
        self.skip(3)
        self.shoot()
        self.shown_ms[-1] = round(1000 * seconds)

    def skip(self, steps: int = 1) -> None:
        """Let the page's time pass without a frame."""
        for _ in range(steps):
            self.page.clock.fast_forward(STEP_MS)

    def cut_until(self, holds: Callable[[], bool]) -> None:
        """Let the page's time pass, without frames, until something holds."""

        def held() -> bool:
            self.skip()
            return holds()

        self.visitor.until(held)

    def shoot_until(self, holds: Callable[[], bool]) -> None:
        """Take frames until something holds."""
        most = PATIENCE_MS // STEP_MS
        for _ in range(most):
            self.shoot()
            if holds():
                return
        raise AssertionError(f"it did not come to hold within {most} frames")

    def move_to(self, target: Locator | Point, frames: int = 5) -> None:
        """Move the pointer to the middle of a control, or to a point of the page; it starts and ends slowly."""
        end = middle_of(target) if isinstance(target, Locator) else target
        start = np.array(self._pointer)
        if np.allclose(start, end):
            return
        for number in range(1, frames + 1):
            share = (1 - np.cos(np.pi * number / frames)) / 2
            self._go(start + (np.array(end) - start) * share)
            self.shoot()

    def click(self, target: Locator) -> None:
        """Move the pointer to a control and click it."""
        self.move_to(target)
        self._press("left")
        self.shoot()
        self._release("left")

    def drag(self, way: Path2D, frames: int, button: Button = "left") -> None:
        """Draw a line through points of the page at an even pace."""
        self.move_to(way[0])
        self._press(button)
        stops = spaced(way, frames * 4)
        for number, stop in enumerate(stops, start=1):
            self._go(stop)
            if number % 4 == 0:
                self.shoot()
        self._release(button)

    def save(self, path: Path, quality: int) -> None:
        """Write the film as an animated WebP that begins again when it ends."""
        first, *others = self.frames
        first.save(
            path,
            save_all=True,
            append_images=others,
            duration=self.shown_ms,
            loop=0,
            quality=quality,
            kmin=KEY_FRAMES[0],
            kmax=KEY_FRAMES[1],
        )

    def _go(self, to: Sequence[float] | Floats) -> None:
        self._pointer = (float(to[0]), float(to[1]))
        self.page.mouse.move(*self._pointer)

    def _press(self, button: Button) -> None:
        self._pressed = True
        self.page.mouse.down(button=button)

    def _release(self, button: Button) -> None:
        self._pressed = False
        self.page.mouse.up(button=button)

    def _frame(self) -> Image.Image:
        shot = self.page.screenshot(animations="disabled", timeout=PATIENCE_MS)
        large = Image.open(io.BytesIO(shot)).convert("RGB")
        frame = large.resize((WIDTH, round(WIDTH * large.height / large.width)), Image.Resampling.LANCZOS)
        self._draw_pointer(frame)
        return frame

    def _draw_pointer(self, frame: Image.Image) -> None:
        """Draw a dark dot with a light rim; it is smaller while a button is down."""
        radius = _PRESSED_DOT if self._pressed else _DOT
        half = math.ceil(_DOT + _RIM) + 1
        layer = Image.new("RGBA", (2 * half * _FINENESS,) * 2)
        pen = ImageDraw.Draw(layer)
        place = [axis * WIDTH / self.size["width"] for axis in self._pointer]
        corner = (int(place[0]) - half, int(place[1]) - half)
        x, y = (_FINENESS * (at - edge) for at, edge in zip(place, corner, strict=True))
        for reach, colour in ((radius + _RIM, (255, 255, 255, 235)), (radius, (40, 44, 52, 225))):
            r = reach * _FINENESS
            pen.ellipse((x - r, y - r, x + r, y + r), fill=colour)
        small = layer.resize((2 * half, 2 * half), Image.Resampling.BOX)
        frame.paste(small, corner, small)


def middle_of(target: Locator) -> tuple[float, float]:
    """Find the middle of a control on the page, px."""
    box = target.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def spaced(way: Path2D, count: int) -> Floats:
    """Choose ``count`` points on a smooth line through ``way`` after its first, evenly spaced (count, 2), px."""
    points = np.array(way, float)
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    at = np.linspace(0.0, lengths[-1], count + 1)[1:]
    return np.stack([np.interp(at, lengths, axis) for axis in points.T], axis=1)
