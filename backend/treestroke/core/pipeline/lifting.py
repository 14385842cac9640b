"""Which method gives the limbs of one picture their depth."""

import numpy as np

from treestroke.core.lift.posterior import lift_by_posterior
from treestroke.core.lift.spread import FrontCrown, FrontTree, lift
from treestroke.core.skeleton.skeleton import Skeleton


def method_for(setting: str, few: bool) -> str:
    """Return spread or posterior for the setting ``lift``; ``few`` tells whether the picture shows few of the limbs.

    Where all are known, the posterior puts them at depths nearer to those of true trees; a few that are seen among
    leaves are better kept apart (docs/decisions/0018).
    """
    if setting != "auto":
        return setting
    return "spread" if few else "posterior"


def lift_front(tree: FrontTree, crown: FrontCrown, method: str, rng: np.random.Generator) -> Skeleton:
    """Lift a traced tree to the world (3D, metres) by a method, spread or posterior."""
    return lift(tree, crown, rng) if method == "spread" else lift_by_posterior(tree, crown, rng)
