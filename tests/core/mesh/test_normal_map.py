import numpy as np
import pytest

from treestroke.core.mesh.bark_pattern import bark_pattern
from treestroke.core.mesh.normal_map import NormalMapParams, bark_normal_map

SIZE = (128, 64)


def noisy(seed: int = 0) -> np.ndarray:
    grey = 110 + 30 * bark_pattern(SIZE, np.random.default_rng(seed))
    return np.clip(grey, 0, 255).astype(np.uint8)[..., None].repeat(3, axis=2)


def normals(normal_map: np.ndarray) -> np.ndarray:
    return (normal_map.astype(np.float64) - 128) / 127


def test_normals_are_of_unit_length_and_point_outward():
    found = normals(
        bark_normal_map(noisy(), bark_pattern(SIZE, np.random.default_rng(1), "plated"), NormalMapParams(0.03))
    )
    assert np.linalg.norm(found, axis=2) == pytest.approx(1, abs=0.01)
    assert found[..., 2].min() > 0.5


def test_a_normal_map_repeats_without_seam_in_both_directions():
    found = normals(bark_normal_map(noisy(), bark_pattern(SIZE, np.random.default_rng(1)), NormalMapParams(0.02)))
    for lines in (found, found.transpose(1, 0, 2)):
        step = np.abs(np.diff(lines, axis=0)).mean(axis=(1, 2))
        assert np.abs(lines[0] - lines[-1]).mean() < 1.5 * step.max()


def test_a_dark_furrow_lies_deep_and_its_sides_face_each_other():
    texture = np.full((*SIZE, 3), 150, np.uint8)
    texture[:, 30:34] = 40
    found = normals(bark_normal_map(texture, np.zeros(SIZE), NormalMapParams(0.02, from_texture=1.0)))
    assert found[:, 29, 0].mean() > 0.1
    assert found[:, 34, 0].mean() < -0.1


def test_the_upper_edge_of_a_high_band_faces_up():
    pattern = np.zeros(SIZE)
    pattern[50:60] = 1.0
    found = normals(
        bark_normal_map(np.full((*SIZE, 3), 120, np.uint8), pattern, NormalMapParams(0.03, from_texture=0.0))
    )
    assert found[50, :, 1].mean() > 0.1
    assert found[59, :, 1].mean() < -0.1


def test_deeper_bark_is_steeper():
    def tilt(depth: float) -> float:
        return float(1 - normals(bark_normal_map(noisy(), np.zeros(SIZE), NormalMapParams(depth)))[..., 2].mean())

    assert tilt(0.0) == pytest.approx(0, abs=0.001)
    assert tilt(0.02) > 2 * tilt(0.004)


def test_a_pattern_of_another_size_is_refused():
    with pytest.raises(ValueError, match="one size"):
        bark_normal_map(noisy(), np.zeros((64, 64)), NormalMapParams())


@pytest.mark.parametrize("wrong", [{"depth": -0.1}, {"depth": 0.2}, {"from_texture": 1.5}])
def test_params_out_of_range_are_refused(wrong):
    with pytest.raises(ValueError, match="must be"):
        NormalMapParams(**wrong)
