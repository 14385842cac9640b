from dataclasses import replace

import cv2
import numpy as np
import pytest
from tests.conftest import DATA
from tests.core.pipeline.recipes import model_photo

from treestroke.core.geometry.silhouette import overlap, silhouette
from treestroke.core.pipeline.completion import completed
from treestroke.core.pipeline.evidence import PhotoEvidence, read_photo
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.strokes import Length, Stroke, Strokes
from treestroke.service.loading import load_photo, load_strokes

TURN = np.linspace(0, 2 * np.pi, 60, endpoint=False)
QUICK = ModelSettings(iterations=30)


def strokes(centre: tuple[float, float], radius: float) -> Strokes:
    """Return the strokes of a round tree."""
    x, y = centre
    ring = np.stack([x + radius * np.cos(TURN), y + radius * np.sin(TURN)], axis=1)
    return Strokes(Stroke(ring), (Stroke(np.array([[x, y + 1.9 * radius], [x, y]])),))


def moved(drawn: Strokes, corner: tuple[int, int]) -> Strokes:
    """Return strokes on a part of the photo that begins at a corner, px."""
    return Strokes(Stroke(drawn.crown.points - corner), tuple(Stroke(s.points - corner) for s in drawn.branches))


def cropped(photo: np.ndarray, drawn: Strokes, box: tuple[int, int, int, int]) -> PhotoEvidence:
    """Read the part of a photo from a column and row up to a column and row, px."""
    left, top, right, bottom = box
    return read_photo(np.ascontiguousarray(photo[top:bottom, left:right]), moved(drawn, (left, top)))


def crown_of(evidence: PhotoEvidence, pointed: bool = False) -> tuple[np.ndarray, tuple[int, int], tuple[str, ...]]:
    """Return the completed foliage, the photo's corner in it, px, and the edges."""
    assert evidence.traced is not None
    mask = evidence.foliage.mask
    whole = completed(evidence.working, evidence.foliage, evidence.traced, mask, pointed)
    if whole is None:
        return mask, (0, 0), ()
    return whole.foliage.mask, whole.working.corner, whole.sides


BOXES = {"left": (80, 0, 300, 400), "right": (0, 0, 220, 400), "top": (0, 80, 300, 400)}


@pytest.mark.parametrize("side", BOXES)
def test_a_round_crown_that_an_edge_cuts_is_round_again(photo: np.ndarray, mask: np.ndarray, side: str) -> None:
    box = BOXES[side]
    evidence = cropped(photo, strokes((150, 150), 124), box)
    found, (x, y), sides = crown_of(evidence)
    assert sides == (side,)
    scale = evidence.working.frame.scale
    back = np.float32([[1 / scale, 0, box[0] - x / scale], [0, 1 / scale, box[1] - y / scale]])
    shown = cv2.warpAffine(found.astype(np.uint8), back, (300, 400))
    part = np.zeros_like(mask)
    part[box[1] : box[3], box[0] : box[2]] = mask[box[1] : box[3], box[0] : box[2]]
    assert overlap(part, mask) < 0.86
    assert overlap(shown > 0, mask) > 0.93


def test_a_crown_inside_the_photo_stays_as_it_is(photo: np.ndarray) -> None:
    assert crown_of(read_photo(photo, strokes((150, 150), 124)))[2] == ()


def test_a_crown_of_which_an_edge_cuts_hardly_anything_stays_as_it_is(photo: np.ndarray) -> None:
    assert crown_of(cropped(photo, strokes((150, 150), 124), (33, 0, 300, 400)))[2] == ()
    assert crown_of(cropped(photo, strokes((150, 150), 124), (45, 0, 300, 400)))[2] == ("left",)


def test_what_the_photo_shows_stays_as_it_is(photo: np.ndarray) -> None:
    evidence = cropped(photo, strokes((150, 150), 124), BOXES["left"])
    found, (x, y), _ = crown_of(evidence)
    height, width = evidence.foliage.mask.shape
    assert x > 0
    assert np.array_equal(found[y : y + height, x : x + width], evidence.foliage.mask)


def test_a_pointed_top_is_higher_in_the_middle_than_a_dome_is_at_its_sides(photo: np.ndarray) -> None:
    evidence = cropped(photo, strokes((150, 150), 124), (0, 60, 300, 400))
    widths = []
    for pointed in (False, True):
        found, (_, y), _ = crown_of(evidence, pointed)
        widths.append(found[y // 2].sum() / found[y].sum())
    assert widths[1] < 0.6 < widths[0]


def test_two_edges_are_completed_one_after_the_other(photo: np.ndarray) -> None:
    found, (x, y), sides = crown_of(cropped(photo, strokes((150, 150), 124), (90, 80, 300, 400)))
    assert sides == ("left", "top")
    assert min(x, y) > 10
    assert found[y : y + 100, :x].any()
    assert found[:y, x : x + 100].any()


@pytest.fixture(scope="module")
def cherry() -> tuple[np.ndarray, Strokes, np.ndarray]:
    mask = cv2.imread(str(DATA / "cherry_blossom.mask.png"), cv2.IMREAD_GRAYSCALE)
    assert mask is not None
    return load_photo(DATA / "cherry_blossom.jpg"), load_strokes(DATA / "cherry_blossom.strokes.json"), mask > 127


def whole_front(model: TreeModel, left: int, shape: tuple[int, ...]) -> np.ndarray:
    """Draw a model of a photo without its first columns in the whole photo's frame."""
    frame = model.camera.cropped((-left, 0), (shape[1], shape[0]))
    return silhouette(model.bark, model.leaf, frame, shape[0])


def test_a_cropped_cherry_is_completed_nearer_to_the_whole_one(
    cherry: tuple[np.ndarray, Strokes, np.ndarray],
) -> None:
    photo, drawn, mask = cherry
    columns = np.flatnonzero(mask.any(axis=0))
    left = int(columns[0] + 0.3 * len(columns))
    evidence = cropped(photo, drawn, (left, 0, photo.shape[1], photo.shape[0]))
    complete, cut = (
        model_photo(evidence, replace(QUICK, edge=edge), np.random.default_rng(0)) for edge in ("complete", "cut")
    )
    assert complete.reading.completed == ("left",)
    assert "edge_completed" in [warning.code for warning in complete.warnings]
    assert cut.reading.completed == ()
    assert (complete.camera.width, complete.camera.height) == (photo.shape[1] - left, photo.shape[0])
    assert complete.camera.root_px == pytest.approx(cut.camera.root_px)
    assert complete.expected[0].mask.shape == cut.expected[0].mask.shape
    fronts = [whole_front(model, left, mask.shape) for model in (complete, cut)]
    assert overlap(fronts[0], mask) > overlap(fronts[1], mask) + 0.02
    inside = [overlap(front[:, left:], mask[:, left:]) for front in fronts]
    assert inside[0] > inside[1] - 0.04


def test_a_known_length_and_a_reduced_photo_keep_their_scale(photo: np.ndarray) -> None:
    left, top, right, bottom = BOXES["left"]
    small = np.ascontiguousarray(photo[top:bottom, left:right])
    drawn = moved(strokes((150, 150), 124), (left, top))
    large = cv2.resize(small, None, fx=6, fy=6, interpolation=cv2.INTER_CUBIC)
    six = Strokes(Stroke(6 * drawn.crown.points), tuple(Stroke(6 * s.points) for s in drawn.branches))
    known = Length(6 * np.array([[100.0, 300.0], [100.0, 200.0]]), 5.0)
    tree = grow_tree(read_photo(large, replace(six, scale=known)), QUICK, np.random.default_rng(0))
    assert tree.reading.completed == ("left",)
    assert tree.camera.metres_per_pixel == pytest.approx(5.0 / 600)
    assert (tree.camera.width, tree.camera.height) == (large.shape[1], large.shape[0])
    assert tree.camera.root_px == pytest.approx(tuple(six.branches[0].points[0]))
