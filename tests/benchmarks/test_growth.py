import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture
from tests.benchmarks.growth_ratio import benchmark_growth, benchmark_library, benchmark_tree, timed

from treestroke.core.grow.compiled import CompiledEvaluator
from treestroke.core.grow.params import GrowthParams
from treestroke.core.grow.reference import PlainEvaluator
from treestroke.core.grow.replacement import Replacement, grow


def test_growth_of_300_iterations_takes_at_most_a_second(benchmark: BenchmarkFixture) -> None:
    skeleton, crown = benchmark_tree()
    method = Replacement(benchmark_library(skeleton), GrowthParams())

    def run() -> int:
        return len(grow(skeleton, crown, method, np.random.default_rng(0)).choices)

    assert benchmark.pedantic(run, rounds=5, warmup_rounds=1) == 300
    assert benchmark.stats.stats.median <= 1.0


@pytest.mark.parametrize("iterations", [20])
def test_the_engine_repeats_the_reference_at_full_size(benchmark: BenchmarkFixture, iterations: int) -> None:
    params = GrowthParams(iterations)
    expected = timed(benchmark_growth(params, PlainEvaluator))[1]
    growths = [benchmark_growth(params, CompiledEvaluator) for _ in range(5)]
    chosen = benchmark.pedantic(lambda: timed(growths.pop())[1], rounds=5)
    assert chosen == expected
