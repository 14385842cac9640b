import numpy as np
import pytest
from tests.conftest import DATA
from tests.pictures import SKY, disc, leaves_on_sky, noisy, ring

from treestroke.core.imaging.outline import fill_outline
from treestroke.core.pipeline.evidence import read_photo
from treestroke.core.segment.contrast import stands_out
from treestroke.core.strokes import Stroke, Strokes
from treestroke.service.loading import load_photo, load_strokes

STROKES = sorted(DATA.glob("*.strokes.json"))


@pytest.mark.parametrize("leaf", [(60, 90, 40), (200, 60, 40), (240, 220, 225)], ids=["green", "red", "white"])
def test_a_crown_of_leaves_stands_out_from_the_sky(leaf: tuple[int, int, int]) -> None:
    assert stands_out(leaves_on_sky(disc(300, 90), leaf), disc(300, 100), 300)


@pytest.mark.parametrize("flat", [SKY, (70, 110, 50), (150, 90, 70)], ids=["sky", "lawn", "wall"])
def test_a_crown_on_one_surface_does_not(flat: tuple[int, int, int]) -> None:
    assert not stands_out(noisy(np.full((300, 300, 3), flat, np.float64)), disc(300, 100), 300)


def test_what_is_smoother_than_its_surroundings_needs_a_colour_of_its_own() -> None:
    flat = np.full((300, 300, 3), SKY, np.float64)
    rough, smooth = noisy(flat, 16.0), noisy(flat, 5.0)
    other = noisy(np.full((300, 300, 3), (200, 60, 40), np.float64), 5.0)
    inside = disc(300, 100)
    assert not stands_out(np.where(inside[..., None], smooth, rough), inside, 300)
    assert stands_out(np.where(inside[..., None], rough, smooth), inside, 300)
    assert stands_out(np.where(inside[..., None], other, rough), inside, 300)


def test_a_crown_that_is_all_of_the_photo_is_let_pass() -> None:
    assert stands_out(noisy(np.full((80, 80, 3), SKY, np.float64)), np.ones((80, 80), bool), 80)


@pytest.mark.parametrize("strokes", STROKES, ids=lambda path: path.name.removesuffix(".strokes.json"))
def test_crowns_of_real_trees_stand_out(strokes) -> None:
    photo = load_photo(DATA / f"{strokes.name.split('.')[0]}.jpg")
    crown = fill_outline(load_strokes(strokes).crown.points, *photo.shape[:2])
    rows, columns = np.flatnonzero(crown.any(axis=1)), np.flatnonzero(crown.any(axis=0))
    edge = int(0.2 * max(len(rows), len(columns)))
    box = np.s_[max(0, rows[0] - edge) : rows[-1] + edge, max(0, columns[0] - edge) : columns[-1] + edge]
    assert stands_out(photo[box], crown[box], max(photo.shape))


def test_a_crown_in_the_sky_is_warned_of_beside_its_stroke() -> None:
    photo = noisy(np.full((240, 320, 3), SKY, np.float64))
    seen = read_photo(photo, Strokes(Stroke(ring(70, (160.0, 100.0)))))
    assert [(warning.code, warning.stroke) for warning in seen.warnings] == [("crown_unclear", "crown")]
