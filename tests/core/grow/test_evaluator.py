import sys

import numpy as np
import pytest
from tests.core.grow.crowns import trunk_case
from treestroke.core.grow.crown import Crown, crown_of

from treestroke.core.grow.compiled import CompiledEvaluator
from treestroke.core.grow.evaluator import evaluator_for
from treestroke.core.grow.growing import rules_for
from treestroke.core.grow.library import TYPE_1
from treestroke.core.grow.params import GrowthParams
from treestroke.core.grow.reference import PlainEvaluator


@pytest.fixture
def crown() -> Crown:
    case = trunk_case()
    return crown_of(case.mask, case.envelope, np.array([160.0, 275.0, 0.0]))


def test_the_extension_is_used_where_it_was_built(crown: Crown) -> None:
    assert isinstance(evaluator_for(crown, TYPE_1, rules_for(GrowthParams(1), crown.unit)), CompiledEvaluator)


def test_without_the_extension_growth_goes_on_by_the_plain_evaluator(
    crown: Crown, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "treestroke.core.grow._engine", None)
    monkeypatch.delitem(sys.modules, "treestroke.core.grow.compiled")
    assert isinstance(evaluator_for(crown, TYPE_1, rules_for(GrowthParams(1), crown.unit)), PlainEvaluator)
