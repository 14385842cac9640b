"""Random skeletons for properties that hold for every tree."""

import numpy as np
from hypothesis import strategies as st

from treestroke.core.skeleton.skeleton import Skeleton


@st.composite
def skeletons(draw: st.DrawFn, dimensions: int = 3, most: int = 20, stems: bool = True) -> Skeleton:
    """Draw a tree of any shape, within 50 of the origin; with ``stems`` there may be further roots."""
    chosen = draw(st.lists(st.integers(0, 10_000), max_size=most - 1))
    parents = [-1] + [pick % (joint + stems) - stems for joint, pick in enumerate(chosen, start=1)]
    rng = np.random.default_rng(draw(st.integers(0, 999)))
    return Skeleton(
        rng.uniform(-50, 50, (len(parents), dimensions)), rng.uniform(0, 2, len(parents)), np.array(parents)
    )


@st.composite
def weighed_skeletons(draw: st.DrawFn) -> tuple[Skeleton, np.ndarray]:
    """Draw a tree and a weight for each joint; ties are likely."""
    tree = draw(skeletons())
    return tree, np.random.default_rng(draw(st.integers(0, 999))).integers(0, 4, len(tree)).astype(np.float64)
