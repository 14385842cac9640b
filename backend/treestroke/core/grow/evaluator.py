"""The choice between the compiled evaluator and the plain one."""

from treestroke.core.grow.growth_space import GrowthSpace
from treestroke.core.grow.library import Subtree
from treestroke.core.grow.placements import Evaluator, Rules


def evaluator_for(space: GrowthSpace, library: tuple[Subtree, ...], rules: Rules) -> Evaluator:
    """Make the compiled evaluator, or the plain one (slow, same choices) where the extension was not built."""
    try:
        from treestroke.core.grow.compiled import CompiledEvaluator
    except ImportError:
        from treestroke.core.grow.reference import PlainEvaluator

        return PlainEvaluator(space, library, rules)
    return CompiledEvaluator(space, library, rules)
