"""A stroke up through a crown: over a stem that is seen, and over shade that is as dark as wood."""

import numpy as np

from treestroke.core.geometry.polyline import resample
from treestroke.core.trace.shaded import shade_under

LINE = resample(np.array([[60.0, 195.0], [60.0, 5.0]]), 2.0)
RADII = np.full(len(LINE), 4.0)
CROWN = np.ones((200, 120), dtype=bool)


def odds(seen: bool) -> np.ndarray:
    """Wood in the upper half as a stem, or everywhere in blotches; below it shade without sides."""
    found = np.random.default_rng(2).choice(np.float32([-3.0, 3.0]), (200, 120))
    if seen:
        found[:100] = -3.0
        found[:100, 56:64] = 3.0
    return found


def test_a_stem_that_is_seen_is_no_shade_and_what_has_no_sides_is() -> None:
    shade = shade_under([(LINE, RADII)], odds(seen=True), CROWN)
    assert not shade[:85].any()
    assert shade[115:190, 58:62].mean() > 0.5
    assert not shade[:, :50].any()


def test_below_the_crown_nothing_is_shade() -> None:
    crown = CROWN.copy()
    crown[120:] = False
    assert not shade_under([(LINE, RADII)], odds(seen=False), crown)[120:].any()
