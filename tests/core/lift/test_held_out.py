"""Depth retrieval judged on pairs that none of its costs were tuned on."""

from functools import cache

import numpy as np
import pytest
from tests.projected import Recovery, arched, crossed_planes, drawn_from, recovery, spiral, whorled
from tests.sketched import held_out_pairs

from treestroke.core.lift.retrieval import PAIRED, retrieve_depth
from treestroke.core.survey.fidelity import Fidelity, fidelity

DRAWN = held_out_pairs(101) | held_out_pairs(301)
KNOWN = [
    (build, limbs, seed)
    for build, limbs in ((spiral, 9), (spiral, 14), (whorled, 4), (arched, 9))
    for seed in (1, 2, 3)
]


@cache
def fidelities() -> dict[str, Fidelity]:
    found = {}
    for name, pair in DRAWN.items():
        retrieved = retrieve_depth(*pair)
        found[name] = fidelity(*pair, retrieved.tree, retrieved.origin == PAIRED)
    return found


@cache
def recoveries() -> list[tuple[Recovery, Recovery]]:
    """Measure for each known tree what is recovered by retrieval, and by two crossed planes."""
    found = []
    for build, limbs, seed in KNOWN:
        true = build(limbs, seed)
        pair = drawn_from(true, seed + 50)
        found.append((recovery(true, retrieve_depth(*pair).tree), recovery(true, crossed_planes(pair))))
    return found


@pytest.mark.parametrize("name", DRAWN)
def test_the_tree_shows_all_of_two_unseen_sketches_and_little_else(name: str) -> None:
    shares = fidelities()[name]
    assert min(shares.front_covered, shares.side_covered) >= 0.98
    assert min(shares.front_true, shares.side_true) >= 0.94
    assert shares.paired >= 0.8


def test_on_average_three_quarters_of_the_limbs_stand_out_of_the_planes_of_view() -> None:
    planes = [shares.in_planes for shares in fidelities().values()]
    assert np.mean(planes) <= 0.25
    assert max(planes) <= 0.6


def test_the_depth_of_known_trees_is_recovered() -> None:
    recalled, precise = np.array([(found.recalled, found.precise) for found, _ in recoveries()]).T
    assert recalled.mean() >= 0.88
    assert precise.mean() >= 0.86
    assert min(recalled.min(), precise.min()) >= 0.75


def test_far_more_of_each_known_tree_is_recovered_than_by_two_crossed_planes() -> None:
    gains = np.array([found.recalled - flat.recalled for found, flat in recoveries()])
    assert gains.min() >= 0.2
    assert gains.mean() >= 0.4
