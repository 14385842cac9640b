"""A drawn bare tree before the sky: its own branches are in the model's front view, and its depth is filled."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from treestroke.core.pipeline.evidence import PhotoEvidence, read_photo
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.grown_tree import GrownTree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.strokes import Stroke, Strokes

SIZE, FINER = 600, 2
ROOT, FORK = (300.0, 560.0), (300.0, 380.0)
CROWN = np.array([(90.0, 60.0), (510.0, 60.0), (540.0, 260.0), (420.0, 400.0), (180.0, 400.0), (60.0, 260.0)])


def branches(start: np.ndarray, turn: float, length: float, rng: np.random.Generator) -> list[tuple[np.ndarray, float]]:
    """Fork again and again: lines (2, 2), px, with their widths."""
    if length < 16:
        return []
    end = start + length * np.array([np.sin(turn), -np.cos(turn)])
    forks = [branches(end, turn + side * rng.uniform(0.3, 0.6), 0.74 * length, rng) for side in (-1, 1)]
    return [(np.array([start, end]), 0.085 * length), *forks[0], *forks[1]]


def wood() -> np.ndarray:
    """Return a mask (600, 600) of the tree."""
    lines = branches(np.array(FORK), 0.0, 100.0, np.random.default_rng(4))
    drawn = np.zeros((SIZE * FINER, SIZE * FINER), dtype=np.uint8)
    for line, width in [(np.array([ROOT, FORK]), 14.0), *lines]:
        cv2.polylines(drawn, [np.round(line * FINER).astype(np.int32)], False, 255, max(1, round(width * FINER)))
    return np.asarray(cv2.resize(drawn, (SIZE, SIZE), interpolation=cv2.INTER_AREA)) / 255.0


def photo() -> np.ndarray:
    down = np.linspace(0, 1, SIZE)[:, None, None]
    sky = (1 - down) * np.array([110, 160, 220]) + down * np.array([200, 225, 245])
    ground = np.where(np.arange(SIZE)[:, None, None] > 545, np.array([90, 120, 60]), sky)
    cover = wood()[..., None]
    noise = np.random.default_rng(0).normal(0, 3, (SIZE, SIZE, 3))
    return np.clip(cover * np.array([70, 58, 50]) + (1 - cover) * ground + noise, 0, 255).astype(np.uint8)


STROKES = Strokes(Stroke(CROWN), (Stroke(np.array([ROOT, (300.0, 470.0), FORK])),))


@pytest.fixture(scope="module")
def evidence() -> PhotoEvidence:
    return read_photo(photo(), STROKES)


@pytest.fixture(scope="module")
def grown(evidence: PhotoEvidence) -> GrownTree:
    return grow_tree(evidence, ModelSettings(foliage="bare"), np.random.default_rng(0))


def test_it_is_taken_for_bare_and_its_wood_is_traced_whole(evidence: PhotoEvidence) -> None:
    assert evidence.traced is not None
    assert evidence.traced.whole
    assert np.abs(evidence.foliage.alpha - wood())[evidence.foliage.region].mean() < 0.03


def test_every_joint_lies_on_wood_that_the_photo_shows(grown: GrownTree, evidence: PhotoEvidence) -> None:
    places = evidence.working.camera(evidence.foliage.mask, 10.0).pixels_from_world(grown.grown.skeleton.points)
    column, row = np.floor(places[:, :2]).astype(int).T
    near = cv2.dilate((wood() > 0.3).astype(np.uint8), np.ones((5, 5))) > 0
    assert near[row, column].mean() > 0.97


def test_from_the_side_it_is_about_as_wide_as_from_the_front(grown: GrownTree) -> None:
    low, high = np.percentile(grown.grown.skeleton.points[:, [0, 2]], [5, 95], axis=0)
    assert 0.5 < (high - low)[1] / (high - low)[0] < 1.3


def test_without_growth_there_are_no_hidden_limbs(evidence: PhotoEvidence, grown: GrownTree) -> None:
    bare = grow_tree(evidence, ModelSettings(foliage="bare", iterations=0), np.random.default_rng(0))
    assert not bare.grown.born.any()
    assert len(bare.grown.skeleton) == (grown.grown.born == 0).sum()


def test_a_known_crown_and_trunk_give_the_same_wood_with_one_more_stroke(evidence: PhotoEvidence) -> None:
    more = Strokes(STROKES.crown, (*STROKES.branches, Stroke(np.array([FORK, (330.0, 300.0)]))))
    again, fresh = read_photo(photo(), more, known=evidence), read_photo(photo(), more)
    assert again.foliage is evidence.foliage
    assert np.array_equal(again.foliage.alpha, fresh.foliage.alpha)
    assert again.traced is not None
    assert fresh.traced is not None
    assert np.array_equal(again.traced.skeleton.points, fresh.traced.skeleton.points)


def test_leaves_may_be_hung_on_it(evidence: PhotoEvidence) -> None:
    leafy = grow_tree(evidence, ModelSettings(foliage="leaves", iterations=20), np.random.default_rng(0))
    assert len(leafy.grown.choices)


def test_the_score_tells_how_much_of_the_crown_lies_near_its_wood(grown: GrownTree, evidence: PhotoEvidence) -> None:
    assert evidence.traced is not None
    trunk_alone = replace(evidence, traced=replace(evidence.traced.stroked, whole=True))
    poor = grow_tree(trunk_alone, ModelSettings(foliage="bare"), np.random.default_rng(0))
    assert poor.score["attractors_reached"] < 0.7 * grown.score["attractors_reached"] < 0.7
