import json
from pathlib import Path

import numpy as np

import treestroke


def test_foliage_and_branches_lie_in_the_photo(maple_photo: Path, maple_strokes: Path) -> None:
    found = treestroke.trace(maple_photo, maple_strokes)
    height, width = found.photo.shape[:2]
    assert found.foliage.shape == (height, width)
    assert found.skeleton is not None
    assert (found.skeleton.points >= 0).all()
    assert (found.skeleton.points <= (width, height)).all()
    assert len(found.stroke) == len(found.skeleton)


def test_the_answer_is_plain_json(maple_photo: Path, maple_strokes: Path) -> None:
    answer = treestroke.trace(maple_photo, maple_strokes).answer()
    assert json.loads(json.dumps(answer)) == answer


def test_without_branches_the_foliage_alone_is_found(maple_photo: Path, maple_strokes: Path) -> None:
    crown = json.loads(maple_strokes.read_text())["crown"]
    found = treestroke.trace(maple_photo, {"crown": crown})
    assert found.skeleton is None
    assert np.count_nonzero(found.foliage) > 1000
