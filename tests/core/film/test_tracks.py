import numpy as np
import pytest
from tests.swaying import crown_mask, sway_px, swaying

from treestroke.core.film.tracks import follow


@pytest.mark.parametrize("chosen", [0, 20, 47])
def test_points_are_followed_from_the_chosen_frame_both_ways(chosen: int) -> None:
    tracks = follow(swaying(), chosen, _where(chosen))
    assert len(tracks) > 100
    truth = sway_px(tracks.rest, np.arange(48))
    truth = truth - truth[chosen]
    error = np.abs(tracks.moved[..., 0] - truth)[tracks.seen]
    assert np.median(error) < 0.2
    assert tracks.moved[chosen][tracks.seen[chosen]] == pytest.approx(0.0)
    assert tracks.seen.mean() > 0.6


def test_tracks_of_both_directions_are_one_each() -> None:
    frames = swaying()
    tracks = follow(frames, 20, _where(20))
    begun = tracks.seen[20]
    assert (tracks.seen[19] & begun).sum() > 0.9 * begun.sum()
    assert (tracks.seen[21] & begun).sum() > 0.9 * begun.sum()


def test_points_begin_anew_where_others_are_lost() -> None:
    frames = swaying()
    frames[24:, 20:110, 50:100] = np.random.default_rng(1).integers(0, 255, (24, 90, 50), dtype=np.uint8)
    frames[30:, 20:110, 50:100] = swaying()[30:, 20:110, 50:100]
    tracks = follow(frames, 0, crown_mask())
    late = ~tracks.seen[0] & tracks.seen[-1]
    assert late.sum() > 20
    truth = sway_px(tracks.rest[late], np.arange(48))
    now = tracks.moved[-1, late, 0]
    assert np.median(np.abs(now - truth[-1])) < 1.5


def test_nothing_is_followed_where_nothing_has_texture() -> None:
    tracks = follow(np.full((30, 80, 90), 120, np.uint8), 0, np.ones((80, 90), dtype=bool))
    assert len(tracks) == 0
    assert tracks.points.shape == (30, 0, 2)


def test_enlarged_tracks_are_those_of_a_larger_picture() -> None:
    tracks = follow(swaying(10), 0, crown_mask())
    larger = tracks.enlarged(3.0)
    assert larger.moved == pytest.approx(3.0 * tracks.moved)


def test_the_same_frames_give_the_same_tracks() -> None:
    first, second = (follow(swaying(12), 4, crown_mask()) for _ in range(2))
    assert first.points.tobytes() == second.points.tobytes()


def _where(chosen: int) -> np.ndarray:
    """Return where the crown is in a frame."""
    rows = np.stack([np.zeros(160), np.arange(160)], axis=1)
    moved = np.rint(sway_px(rows, np.array([chosen]))[0]).astype(int)
    return np.array([np.roll(row, step) for row, step in zip(crown_mask(), moved, strict=True)])
