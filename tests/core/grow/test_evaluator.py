import sys

import pytest
from tests.core.grow.crowns import trunk_case

from treestroke.core.grow.compiled import CompiledEvaluator
from treestroke.core.grow.evaluator import evaluator_for
from treestroke.core.grow.growing import rules_for
from treestroke.core.grow.growth_space import GrowthSpace
from treestroke.core.grow.library import TYPE_1
from treestroke.core.grow.params import GrowthParams
from treestroke.core.grow.reference import PlainEvaluator


@pytest.fixture
def crown() -> GrowthSpace:
    case = trunk_case()
    return case.space()


def test_the_extension_is_used_where_it_was_built(crown: GrowthSpace) -> None:
    assert isinstance(evaluator_for(crown, TYPE_1, rules_for(GrowthParams(1), crown.unit)), CompiledEvaluator)


def test_without_the_extension_growth_goes_on_by_the_plain_evaluator(
    crown: GrowthSpace, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "treestroke.core.grow._engine", None)
    monkeypatch.delitem(sys.modules, "treestroke.core.grow.compiled")
    assert isinstance(evaluator_for(crown, TYPE_1, rules_for(GrowthParams(1), crown.unit)), PlainEvaluator)
