"""Makes the README's pictures of trees, the film of drawing and the pictures of the page: `make pictures`."""

import signal
import sys
import tempfile
from pathlib import Path

from docs.pictures.browser import chromium
from docs.pictures.drawing import film_drawing
from docs.pictures.hero import draw_hero
from docs.pictures.measured import draw_measured
from docs.pictures.page import show_page, show_sketching
from docs.pictures.sides import draw_sides
from tests.running import serving

IMAGES = Path(__file__).parents[1] / "images"


def main() -> None:
    """Make all pictures, those of the page before a service of their own."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # an exception, so that service and browser end, too
    draw_hero(IMAGES / "hero.jpg")
    draw_sides(IMAGES / "sides.jpg")
    draw_measured(IMAGES / "measured.jpg")
    with tempfile.TemporaryDirectory() as folder, serving(Path(folder) / "data") as url, chromium() as browser:
        film_drawing(browser, url, IMAGES / "drawing.webp")
        show_page(browser, url, IMAGES / "page.jpg")
        show_sketching(browser, url, IMAGES / "sketching.jpg")


if __name__ == "__main__":
    main()
