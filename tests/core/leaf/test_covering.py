"""The two forms of lowering depths: the compiled one says what the plain one says, bit by bit."""

import numpy as np
import pytest

from treestroke.core.leaf import _covering as covering
from treestroke.core.leaf import plain_covering

ROWS, COLUMNS = 40, 60


def cards_of(number: int, rng: np.random.Generator) -> np.ndarray:
    """Cards about the grid, some of them out of it."""
    middles = rng.uniform((-9, -9), (COLUMNS + 9, ROWS + 9), (number, 2))
    return np.hstack([middles, rng.normal(0, 4, (number, 6)), rng.uniform(5, 9, (number, 1))]).astype(np.float32)


@pytest.mark.parametrize("seed", range(5))
def test_both_forms_say_the_same(seed: int) -> None:
    rng = np.random.default_rng(seed)
    starts = np.array([0, 30, 31, 31, 300])
    dots = rng.uniform(-1, 1, (300, 2)).astype(np.float32)
    cards, kinds = cards_of(80, rng), rng.integers(0, 4, 80)
    compiled, plain = np.full((2, ROWS, COLUMNS), np.inf, dtype=np.float32)
    compiled[:2] = plain[:2] = 6
    covering.lower(compiled, cards, kinds, dots, starts)
    plain_covering.lower(plain, cards, kinds, dots, starts)
    assert np.isfinite(compiled).sum() > 500
    assert compiled.tobytes() == plain.tobytes()


def test_a_card_that_lies_nowhere_changes_nothing_out_of_the_grid() -> None:
    around = np.full((3, ROWS, COLUMNS), 9, dtype=np.float32)
    cards = np.full((1, 9), np.nan, dtype=np.float32)
    cards[0, 8] = 5
    dots = np.zeros((4, 2), dtype=np.float32)
    covering.lower(around[1], cards, np.array([0]), dots, np.array([0, 4]))
    assert around[1, 0, 0] == 5
    assert (around == 9).sum() == around.size - 1


@pytest.mark.parametrize("wrong", ["size", "type", "order", "read", "cards", "kinds", "negative", "starts", "beyond"])
def test_arrays_that_do_not_fit_together_are_refused(wrong: str) -> None:
    rng = np.random.default_rng(0)
    nearest, cards, kinds = np.zeros((ROWS, COLUMNS), np.float32), cards_of(3, rng), np.array([0, 1, 1])
    dots, starts = rng.uniform(-1, 1, (9, 2)).astype(np.float32), np.array([0, 4, 9])
    match wrong:
        case "size":
            nearest = nearest.ravel()
        case "type":
            nearest = nearest.astype(np.float64)
        case "order":
            nearest = np.asfortranarray(nearest)
        case "read":
            nearest.flags.writeable = False
        case "cards":
            cards = cards[:2]
        case "kinds":
            kinds = np.array([0, 1, 2])
        case "negative":
            kinds = np.array([0, -1, 1])
        case "starts":
            starts = np.array([0, 10, 9])
        case "beyond":
            starts = np.array([0, 4, 10])
    with pytest.raises(ValueError, match="fit together"):
        covering.lower(nearest, cards, kinds, dots, starts)
