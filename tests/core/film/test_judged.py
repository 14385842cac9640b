from collections.abc import Sequence

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from tests.clips import swaying

from treestroke.core.errors import ClipError
from treestroke.core.film.judged import Part, check_light, check_motion, cuts_of, judged, require_frame

RATE = 30.0


def greys(frames: Sequence[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    return np.array([cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY) for frame in frames], dtype=np.uint8)


@pytest.fixture(scope="module")
def tree() -> NDArray[np.uint8]:
    return greys(swaying(60))


@pytest.fixture(scope="module")
def other() -> NDArray[np.uint8]:
    """Another scene: stripes that move, darker."""
    x, y = np.meshgrid(np.arange(160), np.arange(120))
    return np.array([80 + 60 * np.sin((x + y + 2 * n) / 7) for n in range(60)]).astype(np.uint8)


def test_a_clip_of_one_take_is_used_whole(tree: NDArray[np.uint8]) -> None:
    assert judged(tree, RATE, 30) == Part(0, 60)


@pytest.mark.parametrize(("chosen", "part"), [(0, (0, 60)), (59, (0, 60)), (60, (60, 120)), (100, (60, 120))])
def test_the_part_that_holds_the_chosen_frame_is_used(
    tree: NDArray[np.uint8], other: NDArray[np.uint8], chosen: int, part: tuple[int, int]
) -> None:
    found = judged(np.concatenate([tree, other]), RATE, chosen)
    assert (found.start, found.stop) == part
    (note,) = found.notes
    assert note.code == "clip_cut"
    assert "cut at 2.0 s" in note.detail


def test_a_part_that_is_too_short_is_refused_and_the_cut_named(
    tree: NDArray[np.uint8], other: NDArray[np.uint8]
) -> None:
    with pytest.raises(ClipError, match=r"cut at 2\.0 s, and the part with frame 65 lasts 1\.0 s") as refusal:
        judged(np.concatenate([tree, other[:30]]), RATE, 65)
    assert refusal.value.code == "clip_cut"


def test_a_flash_is_no_cut(tree: NDArray[np.uint8]) -> None:
    flashed = tree.copy()
    flashed[30] = 255
    assert cuts_of(flashed) == []


def test_a_camera_that_sweeps_makes_no_cuts(other: NDArray[np.uint8]) -> None:
    swept = np.array([np.roll(frame, 12 * n, axis=1) for n, frame in enumerate(other)])
    assert cuts_of(swept) == []


def test_a_cut_at_either_end_is_found(tree: NDArray[np.uint8], other: NDArray[np.uint8]) -> None:
    assert cuts_of(np.concatenate([other[:1], tree, other[:1]])) == [1, 61]


def test_darkness_is_refused_and_dusk_is_not(tree: NDArray[np.uint8]) -> None:
    check_light((tree // 3).astype(np.uint8))
    with pytest.raises(ClipError, match="film it by day") as refusal:
        check_light((tree // 12).astype(np.uint8))
    assert refusal.value.code == "clip_dark"


@pytest.mark.parametrize("noise", [0.0, 2.0, 5.0])
def test_a_still_tree_is_refused_however_noisy_the_picture_is(tree: NDArray[np.uint8], noise: float) -> None:
    grain = np.random.default_rng(0).normal(0.0, noise, tree.shape)
    with pytest.raises(ClipError, match="treestroke model") as refusal:
        check_motion(np.clip(tree[0] + grain, 0, 255).astype(np.uint8))
    assert refusal.value.code == "clip_still"


def test_a_light_wind_is_motion() -> None:
    check_motion(greys(swaying(60, (640, 480), px=1.0)))


def test_a_frame_must_be_among_those_of_the_clip() -> None:
    require_frame(59, 60)
    with pytest.raises(ClipError, match="there is no frame 60, the clip has 60; choose one from 0 to 59"):
        require_frame(60, 60)
