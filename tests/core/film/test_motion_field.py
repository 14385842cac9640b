from dataclasses import replace

import numpy as np
import pytest

from treestroke.core.film.motion_field import motion_field
from treestroke.core.film.tracks import Tracks

FRAMES, SECONDS = 60, 2.5


def waves(rest: np.ndarray) -> np.ndarray:
    """Return movements (f, n, 2) of places (n, 2), px: a slow change over the picture of one swing."""
    time = np.linspace(0.0, SECONDS, FRAMES)
    swing = np.sin(2.0 * np.pi * 1.6 * time)[:, None] * (1.0 + rest[:, 0] / 100.0)
    return np.stack([4.0 * swing, swing], axis=2)


def swaying_tracks(count: int = 200) -> Tracks:
    rest = np.random.default_rng(2).uniform(0.0, 100.0, (count, 2))
    return Tracks(rest + waves(rest), np.ones((FRAMES, count), dtype=bool), rest)


PLACES = np.array([[30.0, 40.0], [70.0, 60.0]])


def test_a_place_moves_as_the_tracks_around_it() -> None:
    field = motion_field(swaying_tracks(), PLACES, 200.0, 0, SECONDS)
    truth = waves(PLACES)
    for axis in range(2):
        for place in range(2):
            assert np.corrcoef(field.moved[:, place, axis], truth[:, place, axis])[0, 1] > 0.97
    assert field.moved[0] == pytest.approx(0.0)
    assert (field.error_px < 0.5).all()


def test_tracks_that_jump_to_other_leaves_are_outvoted() -> None:
    tracks = swaying_tracks()
    rng = np.random.default_rng(5)
    points = tracks.points.copy()
    wrong = rng.choice(len(tracks), 60, replace=False)
    points[:, wrong] += np.cumsum(rng.normal(0.0, 1.5, (FRAMES, 60, 2)), axis=0)
    field = motion_field(replace(tracks, points=points), PLACES, 200.0, 0, SECONDS)
    truth = waves(PLACES)
    assert np.corrcoef(field.moved[:, 0, 0], truth[:, 0, 0])[0, 1] > 0.95


def test_the_background_between_leaves_does_not_slow_them() -> None:
    tracks = swaying_tracks()
    points = tracks.points.copy()
    still = np.random.default_rng(6).choice(len(tracks), 60, replace=False)
    points[:, still] = tracks.rest[still]
    field = motion_field(replace(tracks, points=points), PLACES, 200.0, 0, SECONDS)
    ratio = field.moved[..., 0].std(axis=0) / waves(PLACES)[..., 0].std(axis=0)
    assert (ratio > 0.85).all()


def test_gaps_in_time_are_bridged() -> None:
    tracks = swaying_tracks()
    seen = tracks.seen.copy()
    seen[20:24] = False
    field = motion_field(replace(tracks, seen=seen), PLACES, 200.0, 0, SECONDS)
    assert np.isfinite(field.moved).all()
    assert np.corrcoef(field.moved[:, 0, 0], waves(PLACES)[:, 0, 0])[0, 1] > 0.93


def test_nothing_is_known_far_from_all_tracks() -> None:
    field = motion_field(swaying_tracks(), np.array([[50.0, 50.0], [400.0, 400.0]]), 200.0, 0, SECONDS)
    assert np.isfinite(field.error_px).tolist() == [True, False]


def test_without_tracks_nothing_moves_and_nothing_is_known() -> None:
    field = motion_field(swaying_tracks(0), PLACES, 200.0, 0, SECONDS)
    assert not field.moved.any()
    assert np.isinf(field.error_px).all()
