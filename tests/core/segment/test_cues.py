import numpy as np
import pytest
from tests.pictures import disc

from treestroke.core.segment.cues import Cues, crown_cues

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
    assert level["tiers"] > 1 > -1 > upright["tiers"]


def test_lines_that_radiate_from_the_centre_or_the_top_are_seen() -> None:
    assert cues_of(about(150.0, 150.0))["from_centre"] > 0.5
    assert cues_of(about(150.0, 30.0))["from_top"] > 0.5
    assert cues_of(np.sin(np.hypot(ROWS - 150, COLUMNS - 150)))["from_centre"] < -0.5


def test_lines_that_sink_outward_droop() -> None:
    sinking = ROWS - np.abs(COLUMNS - 150)
    assert cues_of(np.sin(0.4 * sinking))["drooping"] > 0.4
    assert cues_of(np.sin(0.4 * (ROWS + np.abs(COLUMNS - 150))))["drooping"] < -0.4


def test_noise_has_no_direction() -> None:
    cues = cues_of(np.random.default_rng(0).uniform(-1, 1, ROWS.shape))
    assert max(abs(cues[name]) for name in ("level", "from_top", "from_centre", "drooping")) < 0.12


def test_the_outline_is_measured_in_shares_of_its_size() -> None:
    cone = np.abs(COLUMNS - 150) < (ROWS - 20) * 0.3
    cone &= (ROWS > 20) & (ROWS < 280)
    cues = cues_of(np.zeros(ROWS.shape), cone)
    assert np.exp(cues["aspect"]) == pytest.approx(260 / 156, rel=0.05)
    assert cues["taper"] == pytest.approx(0.125 / 0.75, abs=0.05)
    assert cues["widest"] > 0.9
    assert cues["foot"] > 0.9
    assert cues["tip"] < 0.1
    assert cues["cover"] == pytest.approx(1.0)


def test_foliage_too_small_to_be_judged_gives_the_crown_s_cues() -> None:
    none = np.zeros(BALL.shape, dtype=bool)
    photo = np.full((*BALL.shape, 3), 90, dtype=np.uint8)
    assert crown_cues(photo, none, BALL)["cover"] == 1.0
