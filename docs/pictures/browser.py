"""A browser that draws without a graphics processor what it would draw with one, however long that takes."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import Browser, BrowserContext, sync_playwright
from tests.e2e.conftest import FLAGS
from tests.e2e.visitor import PATIENCE_MS

_GPU = """
    const { getParameter } = WebGL2RenderingContext.prototype
    WebGL2RenderingContext.prototype.getParameter = function (name) {
        return name === 0x9246 ? 'A graphics processor' : getParameter.call(this, name)
    }
    const now = performance.now.bind(performance)
    performance.now = () => now() / 1000
"""
"""Has the page take the software's WebGL for a graphics processor, and its frames for fast ones."""


@contextmanager
def chromium() -> Iterator[Browser]:
    """Start the browser that the tests use, and end it."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=list(FLAGS))
        yield browser
        browser.close()


@contextmanager
def window(browser: Browser, size: tuple[int, int], scale: float, moves: bool = False) -> Iterator[BrowserContext]:
    """Open a window of a size, CSS px, with so many pixels for each; ``moves`` lets the page move things."""
    context = browser.new_context(
        viewport={"width": size[0], "height": size[1]},
        device_scale_factor=scale,
        color_scheme="light",
        reduced_motion="no-preference" if moves else "reduce",
        locale="en-GB",
        service_workers="block",
    )
    context.set_default_timeout(PATIENCE_MS)
    context.add_init_script(_GPU)
    yield context
    context.close()
