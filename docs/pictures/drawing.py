"""The film of drawing and growing a tree: a photo, a crown, a trunk, a branch, and the tree turns."""

from pathlib import Path

from docs.pictures.browser import window
from docs.pictures.film import Film
from playwright.sync_api import Browser
from tests.e2e.visitor import ROOT, Path2D, strokes_of

PHOTO = ROOT / "examples" / "sugar_maple_autumn.jpg"
LIMB = [[347.0, 430.0], [366.0, 385.0], [398.0, 325.0], [436.0, 268.0]]
"""A branch that the photo shows, px."""
SIZE, SCALE = (1080, 620), 1.0
QUALITY = 36


def film_drawing(browser: Browser, url: str, path: Path) -> None:
    """Film the way from a photo to a tree."""
    with window(browser, SIZE, SCALE, moves=True) as context:
        film = Film(context, url)
        open_photo(film)
        draw_strokes(film)
        grow(film)
        turn(film)
        film.save(path, QUALITY)


def open_photo(film: Film) -> None:
    """Choose the photo on the page's first screen."""
    choose = film.page.get_by_role("button", name="Choose a photo")
    film.hold(0.6)
    film.move_to(choose)
    film.visitor.choose(choose, {"name": "Sugar maple.jpg", "mimeType": "image/jpeg", "buffer": PHOTO.read_bytes()})
    film.visitor.sketch.wait_for()
    film.cut_until(lambda: film.visitor.sketch.get_attribute("data-view") is not None)
    film.hold(0.4)


def draw_strokes(film: Film) -> None:
    """Draw the crown, the trunk and a branch; what is found is shown after each."""
    visitor, strokes = film.visitor, strokes_of(PHOTO)
    crown = strokes["crown"]["points"]
    view = visitor.view()
    film.drag([view.at(point) for point in [*crown, crown[0]]], frames=20)
    film.cut_until(lambda: len(visitor.traced) == 1)
    wait_until_found(film)
    film.hold(0.4)
    film.drag([view.at(point) for point in strokes["branches"][0]["points"]], frames=7, button="right")
    wait_until_found(film)
    film.cut_until(lambda: visitor.preview.get_attribute("data-state") == "live")
    film.hold(0.7)
    before = visitor.drawn()[0]
    film.drag([view.at(point) for point in LIMB], frames=5, button="right")
    wait_until_found(film)
    film.cut_until(lambda: visitor.drawn()[0] > before)
    film.hold(0.4)


def wait_until_found(film: Film) -> None:
    """Cut until the page shows what was found along the strokes."""
    film.cut_until(lambda: film.page.locator(".sketch-stale").count() == 0)


def grow(film: Film) -> None:
    """Have the tree grown: its branches, then its leaves."""
    preview = film.visitor.preview
    film.click(film.page.get_by_role("button", name="Grow", exact=True))
    film.move_to(turning_way(film)[0])
    film.cut_until(lambda: preview.get_attribute("data-state") in ("growing", "model"))
    film.shoot_until(lambda: preview.get_attribute("data-state") != "growing")
    film.cut_until(lambda: preview.get_attribute("data-state") == "model")
    film.shoot(10)
    film.hold(0.9)


def turn(film: Film) -> None:
    """Turn the tree by the pointer, nearly half round."""
    film.drag(turning_way(film), frames=30)
    film.shoot(4)
    film.hold(1.3)


def turning_way(film: Film) -> Path2D:
    """Choose a way to the left below the crown, px of the page."""
    box = film.visitor.preview.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] * 0.86
    return [(x + 105, y), (x, y - 6), (x - 105, y)]
