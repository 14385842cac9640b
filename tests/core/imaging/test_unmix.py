import cv2
import numpy as np
import pytest

from treestroke.core.imaging.unmix import unmixed

LEAF, SKY, WALL = np.array([60.0, 110.0, 40.0]), np.array([225.0, 235.0, 250.0]), np.array([160.0, 60.0, 50.0])


def backdrop() -> np.ndarray:
    """White-blue sky above a red wall (200, 200, 3)."""
    return np.where((np.arange(200) < 100)[:, None, None], SKY, WALL) * np.ones((200, 200, 1))


def thin_crown() -> np.ndarray:
    """Opacity (200, 200) of a disc of which every third column is full, the others half."""
    disc = cv2.circle(np.zeros((200, 200), np.float32), (100, 100), 80, 1.0, -1)
    return disc * np.where(np.arange(200) % 3 == 0, np.float32(1.0), np.float32(0.5))


def mixed(colour: np.ndarray, opacity: np.ndarray) -> np.ndarray:
    share = opacity[..., None]
    return np.rint(share * colour + (1 - share) * backdrop()).astype(np.uint8)


def hue(colours: np.ndarray) -> np.ndarray:
    """Share of red, green and blue in colours (n, 3)."""
    return colours / colours.sum(axis=1, keepdims=True)


def test_mixed_pixels_get_the_hue_of_the_leaves_before_sky_and_wall():
    opacity = thin_crown()
    photo = mixed(LEAF, opacity)
    clear = unmixed(photo, opacity, opacity == 1)
    away_from_the_horizon = np.abs(np.arange(200) - 100)[:, None] > 25
    half = (opacity == 0.5) & away_from_the_horizon
    assert np.abs(hue(photo[half]) - hue(LEAF[None])).max() > 0.12
    assert np.abs(hue(clear[half].astype(float)) - hue(LEAF[None])).max() < 0.03


def test_the_background_that_is_taken_out_is_the_one_beside():
    opacity = thin_crown()
    clear = unmixed(mixed(LEAF, opacity), opacity, opacity == 1).astype(float)
    half = opacity == 0.5
    before_sky, before_wall = (clear[rows][half[rows]].mean(axis=0) for rows in (slice(30, 80), slice(120, 170)))
    assert np.abs(hue(before_sky[None]) - hue(before_wall[None])).max() < 0.02


def test_opaque_pixels_and_what_nothing_covers_stay():
    opacity = thin_crown()
    photo = mixed(np.clip(LEAF + np.random.default_rng(0).normal(0, 12, (200, 200, 1)), 0, 255), opacity)
    clear = unmixed(photo, opacity, opacity == 1)
    kept = opacity != 0.5
    assert np.abs(clear[kept].astype(int) - photo[kept]).max() <= 1


def test_light_leaves_that_a_matte_takes_for_thin_ones_stay_rather_light():
    opacity = thin_crown()
    photo, light = mixed(LEAF, (opacity > 0).astype(np.float32)), opacity == 0.5
    photo[light] = (150, 190, 120)
    clear = unmixed(photo, np.where(light, np.float32(0.7), opacity), opacity == 1)
    assert clear[light].mean() > 0.85 * photo[light].mean()


@pytest.mark.parametrize("value", [0.0, 1.0])
def test_all_or_nothing_stays_as_it_is(value):
    photo = mixed(LEAF, thin_crown())
    assert np.array_equal(unmixed(photo, np.full((200, 200), value, np.float32), np.ones((200, 200), bool)), photo)


def test_a_tint_of_the_sky_goes_beside_gaps_and_stays_amid_leaves():
    blue, gap = np.array([60.0, 120.0, 230.0]), np.zeros((200, 200), bool)
    gap[:, 120:] = True
    photo = np.where(gap[..., None], blue, LEAF).astype(np.uint8)
    tinted = np.array([60, 112, 80])
    photo[60:140, 116:119] = photo[60:140, 30:33] = tinted
    clear = unmixed(photo, (~gap).astype(np.float32), ~gap).astype(int)
    assert clear[100, 117, 2] < tinted[2] - 10
    assert clear[100, 118, 2] < clear[100, 117, 2]
    assert np.abs(clear[100, 31] - tinted).max() <= 2
    assert np.abs(clear[100, 100] - LEAF).max() <= 2


def test_leaves_whose_borders_the_sky_tints_get_the_hue_of_their_middles():
    place = np.arange(200) % 8
    opacity = np.where(place < 5, np.float32(1), np.float32(0)) * np.ones((200, 1), np.float32)
    border = (place == 0) | (place == 4)
    blue = np.array([60.0, 120.0, 230.0])
    share = np.where(border, 0.6, opacity)[..., None]
    clear = unmixed(np.rint(share * LEAF + (1 - share) * blue).astype(np.uint8), opacity, opacity > 0)
    away = np.abs(hue(clear[:, border].reshape(-1, 3).astype(float)).mean(axis=0) - hue(LEAF[None])[0])
    assert away.max() < 0.07
