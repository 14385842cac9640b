import numpy as np
import pytest

from treestroke.core.mesh.grain import bark_grain
from treestroke.core.mesh.normal_map import ReliefParams, bark_relief

SIZE = (128, 64)


def noisy(seed: int = 0) -> np.ndarray:
    grey = 110 + 30 * bark_grain(SIZE, np.random.default_rng(seed))
    return np.clip(grey, 0, 255).astype(np.uint8)[..., None].repeat(3, axis=2)


def normals(relief: np.ndarray) -> np.ndarray:
    return (relief.astype(np.float64) - 128) / 127


def test_normals_are_of_unit_length_and_point_outward():
    found = normals(bark_relief(noisy(), bark_grain(SIZE, np.random.default_rng(1), "plated"), ReliefParams(0.03)))
    assert np.linalg.norm(found, axis=2) == pytest.approx(1, abs=0.01)
    assert found[..., 2].min() > 0.5


def test_relief_repeats_without_seam_in_both_directions():
    found = normals(bark_relief(noisy(), bark_grain(SIZE, np.random.default_rng(1)), ReliefParams(0.02)))
    for lines in (found, found.transpose(1, 0, 2)):
        step = np.abs(np.diff(lines, axis=0)).mean(axis=(1, 2))
        assert np.abs(lines[0] - lines[-1]).mean() < 1.5 * step.max()


def test_a_dark_furrow_lies_deep_its_sides_face_each_other():
    texture = np.full((*SIZE, 3), 150, np.uint8)
    texture[:, 30:34] = 40
    found = normals(bark_relief(texture, np.zeros(SIZE), ReliefParams(0.02, own=1.0)))
    assert found[:, 29, 0].mean() > 0.1
    assert found[:, 34, 0].mean() < -0.1


def test_the_upper_edge_of_a_high_band_faces_up():
    grain = np.zeros(SIZE)
    grain[50:60] = 1.0
    found = normals(bark_relief(np.full((*SIZE, 3), 120, np.uint8), grain, ReliefParams(0.03, own=0.0)))
    assert found[50, :, 1].mean() > 0.1
    assert found[59, :, 1].mean() < -0.1


def test_deeper_bark_is_steeper():
    def tilt(depth: float) -> float:
        return float(1 - normals(bark_relief(noisy(), np.zeros(SIZE), ReliefParams(depth)))[..., 2].mean())

    assert tilt(0.0) == pytest.approx(0, abs=0.001)
    assert tilt(0.02) > 2 * tilt(0.004)


def test_a_pattern_of_another_size_is_refused():
    with pytest.raises(ValueError, match="one size"):
        bark_relief(noisy(), np.zeros((64, 64)), ReliefParams())


@pytest.mark.parametrize("wrong", [{"depth": -0.1}, {"depth": 0.2}, {"own": 1.5}])
def test_params_out_of_range_are_refused(wrong):
    with pytest.raises(ValueError, match="must be"):
        ReliefParams(**wrong)
