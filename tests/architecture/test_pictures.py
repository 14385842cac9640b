"""The pictures at the top of the README, which `make pictures` makes."""

from PIL import Image
from tests.architecture.names import ROOT

IMAGES = ROOT / "docs" / "images"


def test_the_first_picture_is_wide_and_small_enough_to_load_at_once() -> None:
    hero = IMAGES / "hero.jpg"
    assert hero.stat().st_size < 350_000
    with Image.open(hero) as picture:
        picture.load()
        assert picture.format == "JPEG"
        assert 1500 <= picture.width <= 1700
        assert 2 < picture.width / picture.height < 4


def test_the_film_of_drawing_is_short_and_smooth_and_begins_again() -> None:
    film = IMAGES / "drawing.webp"
    assert film.stat().st_size <= 2_000_000
    with Image.open(film) as picture:
        shown_ms = []
        for number in range(picture.n_frames):
            picture.seek(number)
            picture.load()
            shown_ms.append(picture.info["duration"])
        assert picture.size[0] == 900
        assert picture.info["loop"] == 0
    assert len(shown_ms) > 30
    assert 8_000 <= sum(shown_ms) <= 14_000
    assert sorted(shown_ms)[len(shown_ms) // 2] <= 85
