"""2,000 small branches, against the same copies turned and tested point by point, as the paper tells it."""

import math
import time

import numpy as np
from pytest_benchmark.fixture import BenchmarkFixture
from tests.core.grow.sketched import crown, tree

from treestroke.core.geometry.outline_volume import TwoOutlines
from treestroke.core.grow.self_similar import TRIED, SelfSimilarParams, grow_small

PIECES = 5
"""Of a small branch, on average."""


def plain_copy(start: list[float], axis: list[float], turn: float, length: float) -> list[list[float]]:
    """Copy a straight part of a branch, turned."""
    x, y, z = axis
    level = math.hypot(x, z) or 1.0
    across, other = (-z / level, 0.0, x / level), (y * x / level, -level, y * z / level)
    out = [math.cos(turn) * a + math.sin(turn) * b for a, b in zip(across, other, strict=True)]
    way = [0.7 * a + 0.714 * b for a, b in zip(axis, out, strict=True)]
    return [[s + length * (k + 1) / PIECES * w for s, w in zip(start, way, strict=True)] for k in range(PIECES)]


def plain_inside(points: list[list[float]], volume: TwoOutlines) -> int:
    """Count the points up to the first that one of the silhouettes does not show."""
    for kept, point in enumerate(points):
        place = np.array([point])
        if not all(silhouette.shows(place)[0] for silhouette in volume.silhouettes):
            return kept
    return len(points)


def plain_growth(volume: TwoOutlines, count: int) -> float:
    """Seconds to grow so many small branches one by one, of as many copies tried each."""
    main = tree().skeleton.points.tolist()
    begun = time.process_time()
    for bud in range(count):
        start, before = main[36 + bud % (len(main) - 36)], main[35 + bud % (len(main) - 36)]
        step = [a - b for a, b in zip(start, before, strict=True)]
        axis = [a / (math.hypot(*step) or 1.0) for a in step]
        tried = [plain_copy(start, axis, 2.4 * bud + one, 0.4) for one in range(TRIED)]
        max(plain_inside(points, volume) for points in tried)
    return time.process_time() - begun


def test_2000_small_branches_take_a_tenth_of_the_time_that_they_take_one_by_one(benchmark: BenchmarkFixture) -> None:
    main, volume, params = tree(), crown(), SelfSimilarParams()

    def run() -> int:
        return len(grow_small(main, volume, params, np.random.default_rng(0)).skeleton)

    assert benchmark.pedantic(run, rounds=5, warmup_rounds=1) > 5000
    plain = 20 * plain_growth(volume, 100)
    assert benchmark.stats.stats.median <= 1.0
    assert benchmark.stats.stats.min <= 0.1 * plain
