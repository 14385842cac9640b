import numpy as np
import pytest

from treestroke.core.geometry.mesh import Surface
from treestroke.core.geometry.silhouette import Framing, framing, overlap, silhouettes
from treestroke.core.leaf.cards import cards
from treestroke.core.leaf.leaves import Leaves
from treestroke.core.leaf.thinning import Coverage, ThinningParams, thin_leaves
from treestroke.core.paint.atlas import Atlas


@pytest.fixture(scope="module")
def ball() -> Leaves:
    """3,000 cards in a ball of 2 m around 3 m above the root."""
    rng = np.random.default_rng(3)
    middles = rng.normal(0.0, 1.0, (3_000, 3))
    middles *= (2.0 * rng.random(3_000) ** (1 / 3) / np.linalg.norm(middles, axis=1))[:, None]
    turns = np.linalg.qr(rng.normal(0.0, 1.0, (3_000, 3, 3)))[0]
    numbers, flips = rng.integers(0, 16, 3_000), rng.random(3_000) < 0.5
    rights, ups = 0.12 * turns[:, 0], 0.12 * turns[:, 1]
    middles[:, 1] += 3.0
    return Leaves(middles, rights, ups, numbers, flips, np.full(3_000, 0.9), np.arange(3_000))


def seen(leaves: Leaves, atlas: Atlas, view: Framing) -> np.ndarray:
    return silhouettes([Surface(cards(leaves, atlas), atlas.image)], view)


@pytest.fixture(scope="module")
def view(ball: Leaves, atlas: Atlas) -> Framing:
    return framing([Surface(cards(ball, atlas), atlas.image)], 100)


@pytest.fixture(scope="module")
def wanted(ball: Leaves, atlas: Atlas, view: Framing) -> np.ndarray:
    return seen(ball, atlas, view)


def thinned(ball: Leaves, atlas: Atlas, count: int, view: Framing, wanted: np.ndarray) -> Leaves:
    return thin_leaves(ball, atlas, count, Coverage(view, wanted.astype(np.float64)))


@pytest.mark.parametrize("count", [1, 400, 2_999])
def test_as_many_cards_stay_as_are_asked_for(ball, atlas, view, wanted, count):
    assert len(thinned(ball, atlas, count, view, wanted)) == count


def test_all_cards_stay_as_they_are(ball, atlas, view, wanted):
    assert thinned(ball, atlas, 3_000, view, wanted) is ball


def test_those_kept_hang_where_they_hung(ball, atlas, view, wanted):
    kept = thinned(ball, atlas, 400, view, wanted)
    assert np.array_equal(kept.centres, ball.centres[kept.joints])
    assert np.array_equal(kept.tiles, ball.tiles[kept.joints])


def test_cards_grow_by_a_factor_and_within_bounds(ball, atlas, view, wanted):
    kept = thinned(ball, atlas, 400, view, wanted)
    factor = np.linalg.norm(kept.rights, axis=1) / 0.12
    assert np.allclose(kept.rights, ball.rights[kept.joints] * factor[:, None])
    assert np.allclose(kept.ups, ball.ups[kept.joints] * factor[:, None])
    assert 1.0 - 1e-9 < factor.min() < factor.max() <= ThinningParams().most_enlarged + 1e-9


def test_a_quarter_of_the_cards_keeps_the_silhouettes(ball, atlas, view, wanted):
    chosen = seen(thinned(ball, atlas, 750, view, wanted), atlas, view)
    alike = [overlap(*pair) for pair in zip(chosen, wanted, strict=True)]
    any_750 = seen(ball.select(np.arange(3_000) % 4 == 0), atlas, view)
    assert min(alike) > 0.9
    assert min(alike) > max(overlap(*pair) for pair in zip(any_750, wanted, strict=True))


def test_where_nothing_is_wanted_fewest_cards_stay(ball, atlas, view, wanted):
    upper = wanted & (np.arange(view.height) < 0.5 * view.height)[None, :, None]
    kept = thinned(ball, atlas, 400, view, upper)
    assert (kept.centres[:, 1] > 3).mean() > 0.8


def test_params_out_of_range_are_refused():
    with pytest.raises(ValueError, match="shrink"):
        ThinningParams(most_enlarged=0.9)
    with pytest.raises(ValueError, match="shares"):
        ThinningParams(area_kept=1.1)
