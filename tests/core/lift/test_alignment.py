import numpy as np
import pytest

from treestroke.core.lift.alignment import align_heights


def chain(heights: np.ndarray | list[float], lengths: np.ndarray | list[float] | None = None) -> np.ndarray:
    """Return the heights and path lengths (n, 2) of a path: of a vertical one unless told."""
    heights = np.asarray(heights, dtype=np.float64)
    walked = np.append(0.0, np.cumsum(np.abs(np.diff(heights)))) if lengths is None else np.asarray(lengths)
    return np.column_stack([heights, walked])


def test_two_that_rise_evenly_stay_at_equal_heights() -> None:
    lead, follow = chain(np.arange(0, 101, 5.0)), chain(np.arange(0, 101, 2.5))
    at = align_heights(lead, follow, 0)
    assert follow[at, 0] == pytest.approx(lead[:, 0], abs=2.5)


def test_the_follower_begins_where_it_is_told() -> None:
    at = align_heights(chain(np.arange(50, 71, 2.0)), chain(np.arange(0, 101, 2.0)), 25)
    assert at == pytest.approx(np.arange(25, 36), abs=1)
    assert at[0] == 25


def test_the_follower_stays_at_its_tip_where_the_leader_goes_higher() -> None:
    at = align_heights(chain(np.arange(0, 201, 10.0)), chain(np.arange(0, 101, 10.0)), 0)
    assert at[:11] == pytest.approx(np.arange(11), abs=1)
    assert (at[12:] == 10).all()


def test_the_follower_turns_back_for_a_deep_dip_but_not_for_a_wiggle() -> None:
    follow = chain(np.arange(0, 101, 2.0))
    deep = np.concatenate([np.arange(0, 80, 2.0), np.arange(80, 20, -2.0), np.arange(20, 100, 2.0)])
    assert follow[align_heights(chain(deep), follow, 0), 0] == pytest.approx(deep, abs=8.0)
    wiggle = np.concatenate([np.arange(0, 50, 2.0), [48.0, 47.0, 48.0], np.arange(50, 100, 2.0)])
    assert (np.diff(align_heights(chain(wiggle), follow, 0)) >= 0).all()


def test_level_chains_go_side_by_side() -> None:
    lead = chain(np.zeros(11), np.arange(0, 101, 10.0))
    follow = chain(np.zeros(41), np.arange(0, 41, 1.0))
    at = align_heights(lead, follow, 0)
    assert follow[at, 1] / 40 == pytest.approx(lead[:, 1] / 100, abs=0.15)


def test_a_chain_of_one_point_leads_nowhere() -> None:
    assert align_heights(chain([0.0]), chain([0.0, 10.0]), 1).tolist() == [1]
    assert align_heights(chain([0.0, 10.0]), chain([0.0]), 0).tolist() == [0, 0]
