import json

import numpy as np
import pytest
from tests.builders import oak, stick

from treestroke.codec.skeleton import plain_grown
from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.pipeline.grown_tree import LiveTree
from treestroke.core.skeleton.skeleton import Skeleton

CAMERA = OrthographicCamera(1200, 1500, 10 / 1500, (600.0, 1450.5))


def test_a_live_tree_is_columns_of_one_length_and_its_camera() -> None:
    tree = LiveTree(oak(), np.arange(121), CAMERA)
    plain = plain_grown(tree)
    assert {len(plain[key]) for key in ("points", "radii", "parents", "born")} == {121}
    assert plain["photo"] == {"width": 1200, "height": 1500, "metres_per_pixel": 10 / 1500, "root": [600.0, 1450.5]}
    assert json.loads(json.dumps(plain)) == plain


@pytest.mark.parametrize("height_m", [0.1, 10.0, 150.0])
def test_rounding_loses_a_hundred_thousandth_of_the_height_at_most(height_m: float) -> None:
    base = oak()
    skeleton = Skeleton(base.points * height_m / 10, base.radii * height_m / 10, base.parents)
    plain = plain_grown(
        LiveTree(skeleton, np.zeros(121, np.int64), OrthographicCamera(9, 1500, height_m / 1500, (0.0, 0.0)))
    )
    assert np.array(plain["points"]) == pytest.approx(skeleton.points, abs=0.5e-5 * height_m)
    assert np.array(plain["radii"]) == pytest.approx(skeleton.radii, abs=0.5e-5 * height_m)


def test_a_tree_of_ten_metres_is_given_to_a_tenth_of_a_millimetre() -> None:
    plain = plain_grown(LiveTree(stick(2, 4.000123), np.zeros(2, np.int64), CAMERA))
    assert plain["points"][1] == [0.0, 4.0001, 0.0]
