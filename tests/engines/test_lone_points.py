import numpy as np

from treestroke.engines.lone_points import confirmed

CENTRES = np.array([[0.0, 0, 1], [1, 0, 0], [0, 0, -1]])


def test_points_of_two_photos_need_others_near() -> None:
    near = np.random.default_rng(1).normal(0, 0.003, (6, 3))
    points = np.concatenate([near, [[0.3, 0.3, 0.3], [-0.3, 0.2, 0.1]]])
    seen = np.array([[True, True, False]] * 7 + [[True, True, True]])
    assert confirmed(points, seen, CENTRES).tolist() == [True] * 6 + [False, True]


def test_few_points_need_three_photos() -> None:
    seen = np.array([[True, True, False], [True, True, True]])
    assert confirmed(np.zeros((2, 3)), seen, CENTRES).tolist() == [False, True]
