import json

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.conftest import DATA
from tests.pieces import touching_pieces

from treestroke.core.mesh.tubes import tubes
from treestroke.core.pipeline.evidence import PhotoEvidence, read_photo
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.strokes import Stroke, Strokes
from treestroke.service.loading import load_photo

SCALE = 0.3


@pytest.fixture(scope="module")
def beech() -> tuple[np.ndarray, np.ndarray, np.ndarray, PhotoEvidence]:
    """Give a small photo, its crown and trunk strokes, px, and what is read in the crown."""
    photo = cv2.resize(load_photo(DATA / "beech_round.jpg"), None, fx=SCALE, fy=SCALE, interpolation=cv2.INTER_AREA)
    strokes = json.loads((DATA / "beech_round.strokes.json").read_text())
    crown, trunk = (np.array(s["points"]) * SCALE for s in (strokes["crown"], strokes["branches"][0]))
    return photo, crown, trunk, read_photo(photo, Strokes(Stroke(crown)))


def hasty(crown: np.ndarray, trunk: np.ndarray, rng: np.random.Generator) -> tuple[Stroke, ...]:
    """Draw further strokes near a trunk: beside it, across it, beyond its end, along it, far away or hardly at all."""
    root, size, strokes = trunk[0], np.ptp(crown, axis=0), []
    for _ in range(int(rng.integers(1, 5))):
        place = trunk[0] + rng.random() * (trunk[-1] - trunk[0])
        far = crown.mean(axis=0) + size * rng.uniform(-0.45, 0.45, 2)
        beside = place + rng.uniform((-30, -8), (30, 8))
        start, end = [
            (beside, far),
            (place - 0.3 * (far - place), far),
            (trunk[-1] + rng.uniform(-20, 20, 2), far),
            (place, place + rng.uniform(-0.06, 0.06, 2) * size),
            (far, crown.mean(axis=0)),
            (place, root + rng.uniform((-80, -30), (80, 10))),
        ][int(rng.integers(6))]
        share = np.linspace(0, 1, int(rng.integers(2, 8)))[:, None]
        width = float(rng.uniform(1, 25)) if rng.random() < 0.2 else None
        strokes.append(Stroke(start + share * (end - start) + rng.normal(0, 1.5, (len(share), 2)), width))
    return tuple(strokes)


def grown(beech, more: tuple[Stroke, ...], seed: int = 0, width: float | None = None) -> Skeleton:
    photo, crown, trunk, known = beech
    seen = read_photo(photo, Strokes(Stroke(crown), (Stroke(trunk, width), *more)), known)
    return grow_tree(seen, ModelSettings(iterations=15), np.random.default_rng(seed)).grown.skeleton


@given(st.integers(0, 100_000))
@settings(max_examples=5, deadline=None)
def test_bark_is_one_piece_for_each_stem_whatever_the_strokes(beech, seed: int) -> None:
    _, crown, trunk, _ = beech
    tree = grown(beech, hasty(crown, trunk, np.random.default_rng(seed)), seed, [None, 40.0][seed % 2])
    assert touching_pieces(tubes(tree)) <= (tree.parents < 0).sum()


def test_strokes_within_the_trunk_leave_no_piece_of_their_own(beech) -> None:
    trunk = beech[2]
    place = trunk[0] + 0.15 * (trunk[-1] - trunk[0])
    stub = Stroke(place + np.array([[0, 0], [4, 3]]))
    assert touching_pieces(tubes(grown(beech, (stub,), width=50.0))) == 1


def test_a_second_stem_stands_on_the_ground(beech) -> None:
    _, crown, trunk, _ = beech
    start = trunk[0] + [0.02 * np.ptp(crown[:, 1]), -0.01 * np.ptp(crown[:, 1])]
    tree = grown(beech, (Stroke(np.array([start, crown.mean(axis=0)])),))
    feet = tree.points[tree.parents < 0]
    assert len(feet) == 2
    assert feet[:, 1] == pytest.approx(0.0, abs=0.05)
