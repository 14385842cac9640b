"""The pictures of the page: a photo's tree with its wipe, and a tree that was sketched from two sides."""

import io
import json
from pathlib import Path
from typing import Any

from docs.pictures.browser import window
from PIL import Image
from playwright.sync_api import Browser
from tests.e2e.visitor import PATIENCE_MS, ROOT, Visitor

from treestroke.client import Client
from treestroke.schemas import ModelInfo

EXAMPLES = ROOT / "examples"
SIZE, SCALE = (1440, 900), 2.0
QUALITY = 88


def show_page(browser: Browser, url: str, path: Path) -> None:
    """Show the oak of a photo at dusk in summer leaves, half behind the photo."""
    photo = EXAMPLES / "burr_oak_dusk.jpg"
    with Client(url) as client:
        settings = {"season": "summer", "wind": "all"}
        model = client.grow(client.upload(photo), photo.with_suffix(".strokes.json"), settings, name="Bur oak at dusk")
        client.wait(model)
    show(browser, url, model, "Photo", path)


def show_sketching(browser: Browser, url: str, path: Path) -> None:
    """Show the two sketches of an orange tree, and the tree with its oranges."""
    front, side, leaf, fruit, settings = (
        EXAMPLES / "sketches" / f"orange.{part}"
        for part in ("front.json", "side.json", "leaf.png", "fruit.png", "settings.json")
    )
    given: dict[str, Any] = json.loads(settings.read_text())
    with Client(url) as client:
        model = client.grow_sketches(front, side, given, leaf=leaf, fruit=fruit, name="Orange tree")
        client.wait(model)
    show(browser, url, model, "Front", path)


def show(browser: Browser, url: str, model: ModelInfo, view: str, path: Path) -> None:
    """Open a tree by its link, look at it from a side, and write a picture of the page."""
    with window(browser, SIZE, SCALE) as context:
        visitor = Visitor(context.new_page(), url)
        visitor.open(f"/#{model.id}")
        visitor.wait_for_preview("model")
        visitor.page.get_by_role("button", name=view, exact=True).click()
        visitor.wait_for_rest()
        shot = visitor.page.screenshot(animations="disabled", timeout=PATIENCE_MS)
    with Image.open(io.BytesIO(shot)) as large:
        large.convert("RGB").resize(SIZE, Image.Resampling.BOX).save(path, quality=QUALITY, optimize=True)
