import numpy as np
import pytest
from tests.pictures import disc

from treestroke.core.segment.cues import Cues, crown_cues, standing_cues

ROWS, COLUMNS = np.mgrid[:300, :300].astype(np.float64)
BALL = disc(300, 120)


def cues_of(brightness: np.ndarray, mask: np.ndarray = BALL) -> Cues:
    """Measure a grey picture of this brightness (h, w), -1 to 1."""
    picture = np.rint(128 + 90 * brightness).astype(np.uint8)
    return crown_cues(np.repeat(picture[..., None], 3, axis=2), mask, mask)


def about(x: float, y: float) -> np.ndarray:
    """Twelve dark and light sectors around a point."""
    return np.sin(12 * np.arctan2(ROWS - y, COLUMNS - x))


def test_level_and_upright_lines_are_told_apart() -> None:
    level, upright = cues_of(np.sin(ROWS)), cues_of(np.sin(COLUMNS))
    assert level["level"] > 0.8
    assert upright["level"] < -0.8
    assert min(level["fine_lines"], upright["fine_lines"]) > 0.8


def test_lines_that_radiate_from_the_centre_the_top_or_the_foot_are_seen() -> None:
    assert cues_of(about(150.0, 150.0))["from_centre"] > 0.5
    assert cues_of(about(150.0, 30.0))["from_top"] > 0.5
    assert cues_of(about(150.0, 270.0))["from_foot"] > 0.5
    assert cues_of(np.sin(np.hypot(ROWS - 150, COLUMNS - 150)))["from_centre"] < -0.5


def test_fine_and_coarse_grain_are_told_apart() -> None:
    fine, coarse = cues_of(np.sin(2.5 * ROWS)), cues_of(np.sin(0.8 * ROWS))
    assert fine["fine_grain"] > coarse["fine_grain"] + 0.5
    assert fine["coarse_grain"] > coarse["coarse_grain"] + 0.5


def test_noise_has_no_direction() -> None:
    cues = cues_of(np.random.default_rng(0).uniform(-1, 1, ROWS.shape))
    assert max(abs(cues[name]) for name in ("level", "from_top", "from_centre", "from_foot")) < 0.12


def test_the_outline_is_measured_in_shares_of_its_size() -> None:
    cone = np.abs(COLUMNS - 150) < (ROWS - 20) * 0.3
    cone &= (ROWS > 20) & (ROWS < 280)
    cues = cues_of(np.zeros(ROWS.shape), cone)
    assert np.exp(cues["aspect"]) == pytest.approx(260 / 156, rel=0.05)
    assert cues["taper"] == pytest.approx(0.125 / 0.75, abs=0.05)
    assert cues["widest"] > 0.9
    assert cues["foot"] > 0.9
    assert cues["top"] < 0.1
    assert cues["low"] == pytest.approx(5 / 7, abs=0.05)
    assert cues["top"] < cues["shoulder"] < cues["low"]


def test_a_wavy_outline_turns_more_than_a_round_one() -> None:
    away = np.hypot(ROWS - 150, COLUMNS - 150) / (1 + 0.1 * np.sin(18 * np.arctan2(ROWS - 150, COLUMNS - 150)))
    blank = np.zeros(ROWS.shape)
    assert cues_of(blank, away < 110)["wavy"] > 2 * cues_of(blank)["wavy"]


def test_how_a_crown_stands_on_its_trunk_is_measured() -> None:
    crown = np.array([[0.0, 0.0], [200.0, 0.0], [200.0, 100.0], [0.0, 100.0]])
    low, high = (standing_cues(crown, np.array([[100.0, foot], [100.0, 50.0]])) for foot in (100.0, 300.0))
    assert low == {"slim": pytest.approx(np.log(0.5)), "flat": 0.0}
    assert high == {"slim": pytest.approx(np.log(1.5)), "flat": pytest.approx(np.log(2))}


def test_foliage_too_small_to_be_judged_gives_the_crown_s_cues() -> None:
    none = np.zeros(BALL.shape, dtype=bool)
    photo = np.full((*BALL.shape, 3), 90, dtype=np.uint8)
    assert crown_cues(photo, none, BALL) == crown_cues(photo, BALL, BALL)
