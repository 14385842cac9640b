import numpy as np
import pytest

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.clumped_crown import Cells, ClumpedCrown
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import turned_outline

CAMERA = OrthographicCamera(200, 200, 0.1, (100.0, 190.0))


@pytest.fixture
def crown() -> ClumpedCrown:
    """A round crown of 6 m that is half as deep, with foliage in one cube of 2 m about a place 2 m before the stem."""
    y, x = np.mgrid[:200, :200] + 0.5
    outline = turned_outline(Silhouette(np.hypot(x - 100, y - 100) < 60, CAMERA))
    filled = np.zeros((10, 10, 10), dtype=bool)
    filled[4:6, 4:6, 6:8] = True
    cells = Cells(filled, np.array([50.0, 50.0, -50.0]), 10.0)
    return ClumpedCrown(
        CAMERA,
        outline.middle_px,
        outline.radius_px,
        outline.silhouettes,
        near_px=np.zeros(200),
        deep_px=0.5 * outline.radius_px,
        clumps=cells,
    )


def test_foliage_stands_where_cells_are_filled(crown: ClumpedCrown) -> None:
    points = CAMERA.world_from_pixels(np.tile([[100.0, 100.0]], (4, 1)), -np.array([0.5, 1.5, 2.5, 3.5]))
    assert crown.admits(points).tolist() == [False, True, True, False]
    assert crown.inside(points).tolist() == [False, True, True, False]


def test_beyond_its_cells_there_is_nothing(crown: ClumpedCrown) -> None:
    assert not crown.clumps.hold(np.array([[49.0, 100, 20], [500, 100, 20], [100, 100, 50.1], [-1e9, 0, 0]])).any()


def test_its_depth_is_assumed_and_may_differ_from_its_width(crown: ClumpedCrown) -> None:
    assert not crown.depth_seen
    front = CAMERA.world_from_pixels(np.array([[100.0, 100.0]]))
    assert crown.half_depth(front)[0] == pytest.approx(3.0, abs=0.15)
    assert crown.half_width(front[:, 1])[0] == pytest.approx(6.0, abs=0.15)
