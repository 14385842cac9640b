import json

import numpy as np
from tests.builders import fork

from treestroke.codec.motion import plain_motion
from treestroke.core.film.spectra import Swings
from treestroke.core.pipeline.tree_motion import Measurement, TreeMotion
from treestroke.core.sway.bones import rig_of
from treestroke.core.sway.measured import looped, repeated

RIG = rig_of(fork(), None, 20, tips=True)
TURNS = np.zeros((30, len(RIG.names), 3))
TURNS[:, 1:3, 2] = 0.1 * np.sin(np.arange(30) / 4.0)[:, None]


def test_a_measured_motion_says_how_its_branches_swing() -> None:
    swings = Swings(np.array([1.234567, 0.5]), np.array([0.1, np.nan]), np.array([0.987, 0.0]))
    measured = Measurement(120, 0.91234, np.array([1, 2]), np.array([0.0123456, 0.2]), swings)
    plain = plain_motion(TreeMotion(RIG, looped(TURNS, 30.0), 30.0, TURNS, measured))
    assert (plain["frames_per_second"], plain["frames"]) == (30.0, 30)
    assert plain["loop"] > 1.0
    assert plain["measured"]["followed"] == 0.912
    first, second = plain["measured"]["branches"]
    assert first == {
        "bone": RIG.names[1],
        "sway_m": 0.0123,
        "frequency_hz": 1.235,
        "damping": 0.1,
        "sureness": 0.99,
    }
    assert second["damping"] is None
    json.dumps(plain, allow_nan=False)


def test_a_drawn_motion_says_only_its_frames() -> None:
    plain = plain_motion(TreeMotion(RIG, repeated(TURNS, 30.0), 30.0, TURNS, None))
    assert set(plain) == {"frames_per_second", "frames", "loop"}
    assert plain["loop"] == 1.0
