"""Voxels carry the evidence of several shots, and give it back to each."""

import numpy as np
from tests.core.segment.walked_tree import HEIGHT, WIDTH, camera_at, strokes_on, walk

from treestroke.core.segment.view_mattes_solid import OUTSIDE, projected, solid_around, weighed

CAMERAS = [camera_at(turn) for turn in np.linspace(0, 2 * np.pi, 9, endpoint=False)]


def evidence(share: float) -> np.ndarray:
    return np.full((HEIGHT, WIDTH), share, dtype=np.float32)


def test_the_first_solid_holds_the_tree_from_every_side() -> None:
    shots, trees = walk(4)
    solid = solid_around([strokes_on(shots[0]).crown.points], [shots[0].camera])
    for shot, tree in zip(shots, trees, strict=True):
        above = tree & (np.arange(HEIGHT)[:, None] < 0.5 * HEIGHT)
        assert (projected(solid, shot.camera, tree.shape) > OUTSIDE)[above].all()


def test_one_shot_that_was_not_drawn_cuts_nothing_and_a_drawn_one_does() -> None:
    outline = strokes_on(walk(1)[0][0]).crown.points
    solid = solid_around([outline], CAMERAS[:1])
    maps = [evidence(3.0)] * 4 + [evidence(-3.0)] + [evidence(3.0)] * 4
    twice = [*CAMERAS, *CAMERAS], [*maps, *[evidence(3.0)] * 9]
    assert weighed(solid, *twice, drawn=[0]).odds.min() >= 0
    assert weighed(solid, *twice, drawn=[4]).odds.max() <= -3


def test_a_pixel_gets_the_evidence_of_the_likeliest_voxel_behind_it() -> None:
    solid = solid_around([strokes_on(walk(1)[0][0]).crown.points], CAMERAS[:1])
    half = evidence(-3.0)
    half[:, : WIDTH // 2] = 2.0
    back = projected(weighed(solid, CAMERAS[:1], [half], [0]), CAMERAS[0], half.shape)
    row = int(0.3 * HEIGHT)
    assert back[row, WIDTH // 2 - 10] == 2.0
    assert back[row, WIDTH // 2 + 10] == -3.0
