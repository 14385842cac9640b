from dataclasses import replace

import numpy as np
import pytest
from tests.core.grow.crowns import limbed_case

from treestroke.core.grow.compiled import CompiledEvaluator
from treestroke.core.grow.growing import Growing, rules_for
from treestroke.core.grow.growth_space import GrowthSpace
from treestroke.core.grow.library import TYPE_1, TYPE_2, visible_subtrees
from treestroke.core.grow.params import GrowthParams, growth_for
from treestroke.core.grow.placements import Evaluator
from treestroke.core.grow.reference import PlainEvaluator
from treestroke.core.grow.stem import foot_of
from treestroke.core.progress import silent
from treestroke.core.types import TreeForm

EVALUATORS = (CompiledEvaluator, PlainEvaluator)


def growing(params: GrowthParams, make: type[CompiledEvaluator] | type[PlainEvaluator]) -> Growing:
    case = limbed_case()
    px = case.visible
    crown = case.space(foot_of(px, case.mask))
    library = (*visible_subtrees(case.skeleton)[:1], *TYPE_1[:2], *TYPE_2[:2])
    return Growing(px, crown, library, params, make(crown, library, rules_for(params, crown.unit)))


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.nightly) for seed in (1, 2))])
@pytest.mark.parametrize("mode", ["image", "space", "alternating"])
def test_the_engine_chooses_what_the_plain_reference_chooses(mode: str, seed: int) -> None:
    params = GrowthParams(20, attractors=500, candidates=6, mode=mode)
    fast, plain = (growing(params, make) for make in EVALUATORS)
    chosen, expected = (growth.run(np.random.default_rng(seed), silent) for growth in (fast, plain))
    assert chosen == expected
    assert len(chosen) >= 15
    np.testing.assert_array_equal(fast.tips[: fast.count], plain.tips[: plain.count])


@pytest.mark.parametrize("form", ["spire", "weeping", "vase"])
def test_both_steer_shoots_alike(form: TreeForm) -> None:
    params = replace(growth_for("leaves", 20, form), attractors=500, candidates=6)
    fast, plain = (growing(params, make) for make in EVALUATORS)
    chosen, expected = (growth.run(np.random.default_rng(0), silent) for growth in (fast, plain))
    assert chosen == expected
    assert len(chosen) >= 15
    np.testing.assert_array_equal(fast.tips[: fast.count], plain.tips[: plain.count])


def test_both_measure_the_same_gains_and_distances() -> None:
    growths = [growing(GrowthParams(6, attractors=300, candidates=3), make) for make in EVALUATORS]
    for growth in growths:
        growth.run(np.random.default_rng(3), silent)
    candidates = np.flatnonzero(growths[0].open)[:4]
    for in_space in (False, True):
        gains = [growth.evaluator.best(candidates, in_space).gain for growth in growths]
        assert gains[0] == pytest.approx(gains[1], rel=1e-12)
    order = [np.sort(growth.evaluator.image_distances()) for growth in growths]
    np.testing.assert_allclose(order[0], order[1], rtol=1e-12, atol=1e-9)


def tied(crown: GrowthSpace, make: type[CompiledEvaluator] | type[PlainEvaluator]) -> Evaluator:
    params = GrowthParams()
    evaluator = make(crown, TYPE_2[:1] * 3, rules_for(params, crown.unit))
    base = np.array([[160.0, 260.0, 0.0], [160.0, 260.0, 0.0]])
    evaluator.add_branches(base, base - [[0, 60.0, 0]], np.array([[0.0, 1.0, 1.0]] * 2), np.array([[1.0, 0.0]] * 2))
    evaluator.add_attractors(crown.grid(400))
    return evaluator


@pytest.mark.parametrize("make", EVALUATORS)
def test_of_equal_gains_the_smallest_branch_subtree_and_angle_wins(
    make: type[CompiledEvaluator] | type[PlainEvaluator],
) -> None:
    case = limbed_case()
    crown = case.space((160.0, 280.0, 0.0))
    choice = tied(crown, make).best(np.array([0, 1]), in_space=False)
    assert (choice.branch, choice.subtree) == (0, 1)


@pytest.mark.parametrize("make", EVALUATORS)
def test_without_candidates_nothing_is_chosen(make: type[CompiledEvaluator] | type[PlainEvaluator]) -> None:
    assert growing(GrowthParams(1, attractors=50), make).evaluator.best(np.zeros(0, dtype=np.int64), False).branch == -1
