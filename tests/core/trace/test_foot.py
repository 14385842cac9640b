import numpy as np
import pytest

from treestroke.core.geometry.polyline import resample
from treestroke.core.trace.foot import flared, leaves_photo

LINE = resample(np.array([[100.0, 180.0], [100.0, 20.0]]), 2.0)
RADII = np.full(len(LINE), 12.0)
GRASS, BARK = (90, 140, 60), (70, 55, 45)


def picture(half: np.ndarray, hidden_from: int = 200) -> np.ndarray:
    """Return a trunk with a half-width for each row, before grass that hides it from a row on."""
    rng = np.random.default_rng(0)
    y, x = np.mgrid[:200, :200] + 0.5
    wood = (np.abs(x - 100) < half[:, None]) & (y < hidden_from)
    noise = rng.normal(0, 6, (200, 200, 1))
    return np.clip(np.where(wood[..., None], BARK, GRASS) + noise, 0, 255).astype(np.uint8)


def test_a_foot_widens_as_the_photo_shows_it() -> None:
    rows = np.arange(200) + 0.5
    half = 12 + 8 * np.clip((rows - 155) / 25, 0, 1) ** 2
    radii = flared(LINE, RADII, picture(half))
    assert radii == pytest.approx(np.interp(LINE[:, 1], rows, half), abs=1.5)
    assert radii[0] > 18


@pytest.mark.parametrize("hidden_from", [200, 165])
def test_a_foot_without_flare_or_behind_grass_stays_as_wide_as_the_trunk(hidden_from: int) -> None:
    assert flared(LINE, RADII, picture(np.full(200, 12.0), hidden_from)) == pytest.approx(12.0, abs=1.0)


def test_the_trunk_above_its_foot_stays_as_it_is() -> None:
    radii = np.linspace(12.0, 6.0, len(LINE))
    assert np.array_equal(flared(LINE, radii, picture(np.full(200, 25.0)))[30:], radii[30:])


def test_a_leaning_trunk_without_flare_stays_even() -> None:
    leaning = resample(np.array([[60.0, 180.0], [140.0, 20.0]]), 2.0)
    y, x = np.mgrid[:200, :200] + 0.5
    wood = np.abs(x - (60 + (180 - y) / 2)) < 12 / np.cos(np.arctan(0.5))
    photo = np.where(wood[..., None], BARK, GRASS).astype(np.uint8)
    assert flared(leaning, np.full(len(leaning), 12.0), photo) == pytest.approx(12.0, abs=1.0)


@pytest.mark.parametrize(("rows", "cut"), [(200, False), (182, True)])
def test_a_trunk_that_begins_at_the_lower_edge_leaves_the_photo(rows: int, cut: bool) -> None:
    assert leaves_photo(LINE, RADII, picture(np.full(200, 12.0))[:rows]) is cut
