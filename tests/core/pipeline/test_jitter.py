"""A person's hand shakes: every stroke point moved by up to 0.7 % of the photo's long side changes little."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree
from tests.conftest import DATA, EXAMPLES
from tests.pictures import overlap

from treestroke.core.geometry.polyline import resample
from treestroke.core.pipeline.photo import PhotoTrace, trace_photo
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Stroke, Strokes
from treestroke.service.loading import load_photo, load_strokes

TREMOR = 0.007
HANDS = pytest.mark.parametrize("hands", [4, pytest.param(10, marks=pytest.mark.nightly)])
OAK, MAPLE, OSAGE = (EXAMPLES / name for name in ("burr_oak_dusk", "sugar_maple_autumn", "osage_orange_autumn"))
BARE = DATA / "bigleaf_maple_bare"
FORKED = EXAMPLES / "oak_02"
"""A photo on which limbs without stroke are seen."""


def shaken(strokes: Strokes, amount_px: float, rng: np.random.Generator) -> Strokes:
    def moved(stroke: Stroke) -> Stroke:
        return Stroke(stroke.points + rng.uniform(-amount_px, amount_px, stroke.points.shape), stroke.width)

    return Strokes(moved(strokes.crown), tuple(map(moved, strokes.branches)), tuple(map(moved, strokes.erase)))


@cache
def traces(tree: Path, hands: int) -> tuple[PhotoTrace, list[PhotoTrace]]:
    """Trace a photo once as drawn and several times with a shaking hand."""
    photo, strokes = load_photo(tree.with_suffix(".jpg")), load_strokes(tree.with_suffix(".strokes.json"))
    rng, amount = np.random.default_rng(0), TREMOR * max(photo.shape[:2])
    return trace_photo(photo, strokes), [trace_photo(photo, shaken(strokes, amount, rng)) for _ in range(hands)]


def walked(skeleton: Skeleton | None, chosen: np.ndarray | None = None) -> np.ndarray:
    """Give a point for each px of a skeleton's length, or of the edges to the joints in a mask."""
    assert skeleton is not None
    ends = np.flatnonzero((skeleton.parents >= 0) & (True if chosen is None else chosen)).tolist()
    edges = [(skeleton.points[skeleton.parents[j]], skeleton.points[j]) for j in ends]
    return np.concatenate([resample(np.stack(edge), 1.0)[1:] for edge in edges])


def near_again(line: np.ndarray, steady: PhotoTrace, others: list[PhotoTrace]) -> float:
    """Median share of a line near which the others trace a branch, too, within 1 % of the tree's height."""
    height_px = walked(steady.skeleton)[:, 1].max() - np.flatnonzero(steady.foliage.any(axis=1))[0]
    near = [(cKDTree(walked(o.skeleton)).query(line)[0] <= 0.01 * height_px).mean() for o in others]
    return float(np.median(near))


@HANDS
@pytest.mark.parametrize("tree", [OAK, MAPLE, OSAGE], ids=lambda tree: tree.name)
def test_a_shaking_hand_finds_the_same_foliage(tree: Path, hands: int) -> None:
    steady, others = traces(tree, hands)
    assert np.median([overlap(other.foliage, steady.foliage) for other in others]) >= 0.95


@HANDS
@pytest.mark.parametrize("tree", [OAK, MAPLE, OSAGE, BARE], ids=lambda tree: tree.name)
def test_a_shaking_hand_traces_the_same_branches(tree: Path, hands: int) -> None:
    steady, others = traces(tree, hands)
    assert near_again(walked(steady.skeleton, steady.stroke >= 0), steady, others) >= 0.9


@HANDS
def test_a_shaking_hand_finds_most_limbs_without_stroke_again(hands: int) -> None:
    steady, others = traces(FORKED, hands)
    assert near_again(walked(steady.skeleton, steady.stroke < 0), steady, others) >= 0.75


def test_limbs_without_stroke_are_found_on_a_photo() -> None:
    photo, strokes = load_photo(FORKED.with_suffix(".jpg")), load_strokes(FORKED.with_suffix(".strokes.json"))
    assert (trace_photo(photo, strokes).stroke < 0).sum() > 100
