import numpy as np
import pytest
from tests.conftest import EXAMPLES
from tests.core.pipeline.recipes import model_sketches

from treestroke.codec.sketch import parse_sketch
from treestroke.core.errors import StrokesError
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.pipeline.grown_tree import GrownTree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sketching import ONE_SIDE, grow_sketches, read_sketches
from treestroke.core.strokes import Sketch, Stroke

FEW = ModelSettings(iterations=60)
MARGIN = 0.03
"""Of the tree's height: cards and twigs' tubes reach a little beyond their own middles."""


def line(*points: tuple[float, float]) -> Stroke:
    return Stroke(np.array(points, dtype=np.float64))


def sketch(lean: float, canvas: tuple[int, int] = (400, 500), scale: float = 1.0) -> Sketch:
    """A trunk and four limbs on a canvas, drawn at a scale, leaning to the right."""
    trunk = line((200, 480), (200, 300), (200 + lean, 60))
    limbs = (
        line((200, 330), (120, 230), (90, 180)),
        line((200, 300), (290, 220), (320, 150)),
        line((200, 220), (140, 130)),
        line((200, 200), (270, 110)),
    )
    strokes = tuple(Stroke(stroke.points * scale) for stroke in (trunk, *limbs))
    crown = Stroke(scale * np.array([(200.0, 30), (60, 160), (110, 320), (290, 320), (350, 150)]))
    return Sketch((round(scale * canvas[0]), round(scale * canvas[1])), crown, strokes)


def pear(side: str) -> Sketch:
    path = EXAMPLES / "sketches" / f"pear.{side}.json"
    return parse_sketch(path.read_bytes(), path.name)


@pytest.fixture(scope="module")
def grown() -> GrownTree:
    return grow_sketches(read_sketches(pear("front"), pear("side")), FEW, np.random.default_rng(0))


@pytest.fixture(scope="module")
def model() -> TreeModel:
    return model_sketches(read_sketches(pear("front"), pear("side")), FEW, np.random.default_rng(0))


def test_the_tree_is_true_to_both_sketches(grown: GrownTree) -> None:
    score = grown.score
    assert min(score["front_covered"], score["side_covered"]) >= 0.98
    assert min(score["front_true"], score["side_true"]) >= 0.95
    assert score["paired"] >= 0.6
    assert score["in_planes"] <= 0.25


def test_the_tree_stands_at_the_origin_of_the_front(grown: GrownTree) -> None:
    root = pear("front").branches[0].points[0]
    assert grown.grown.skeleton.points[0] == pytest.approx(np.zeros(3), abs=1e-9)
    assert grown.camera.root_px == pytest.approx(tuple(root), abs=1.0)
    assert (grown.grown.skeleton.parents[1:] >= 0).all()


def test_the_height_is_that_of_the_crown(grown: GrownTree) -> None:
    drawn = pear("front")
    assert drawn.crown is not None
    height_px = drawn.branches[0].points[0, 1] - drawn.crown.points[:, 1].min()
    assert grown.camera.metres_per_pixel == pytest.approx(10.0 / height_px, rel=0.01)
    assert grown.stature.height == pytest.approx(10.0)


def test_leaves_lie_in_the_crown_from_the_front_and_from_the_left(model: TreeModel) -> None:
    assert model.cards is not None
    height = 10.0
    for side, points in (("front", model.cards.centres), ("side", model.cards.centres[:, [2, 1, 0]] * [1, 1, -1])):
        drawn = pear(side)
        assert drawn.crown is not None
        outline = (drawn.crown.points - drawn.branches[0].points[0]) * [1, -1]
        outline *= height / outline[:, 1].max()
        low, high = outline.min(axis=0) - MARGIN * height, outline.max(axis=0) + MARGIN * height
        assert ((points[:, :2] >= low) & (points[:, :2] <= high)).all()


def test_a_side_drawn_at_another_size_gives_the_same_tree() -> None:
    front = sketch(10)
    small, large = (
        grow_sketches(read_sketches(front, sketch(-15, scale=scale)), FEW, np.random.default_rng(0)).grown.skeleton
        for scale in (1.0, 2.0)
    )
    assert len(small) == pytest.approx(len(large), rel=0.05)
    assert np.ptp(small.points, axis=0) == pytest.approx(np.ptp(large.points, axis=0), rel=0.05)


def test_the_sides_right_is_towards_the_viewer() -> None:
    """A trunk whose top leans 40 px of 420 to the right in the side sketch, straight in the front."""
    seen = read_sketches(sketch(0), sketch(40))
    points = grow_sketches(seen, ModelSettings(iterations=0), np.random.default_rng(0)).grown.skeleton.points
    top = points[points[:, 1].argmax()]
    assert top[0] == pytest.approx(0.0, abs=0.1)
    assert top[2] == pytest.approx(40 / 450 * 10, abs=0.15)


def test_one_sketch_alone_is_spread_in_depth_and_says_so() -> None:
    seen = read_sketches(sketch(10))
    tree = grow_sketches(seen, FEW, np.random.default_rng(0))
    assert tree.warnings == (ONE_SIDE,)
    assert np.ptp(tree.grown.skeleton.points[:, 2]) > 0.3 * np.ptp(tree.grown.skeleton.points[:, 0])


def test_no_rounds_of_growth_leave_what_was_drawn() -> None:
    tree = grow_sketches(read_sketches(sketch(10), sketch(-5)), ModelSettings(iterations=0), np.random.default_rng(0))
    assert (tree.grown.born == 0).all()


def test_a_photo_under_the_front_lends_its_colours() -> None:
    autumn = np.full((500, 400, 3), (120, 150, 200), dtype=np.uint8)
    autumn[40:320, 70:340] = np.random.default_rng(0).normal((200, 90, 30), 8, (280, 270, 3)).astype(np.uint8)
    seen = read_sketches(sketch(10), sketch(-5), autumn)
    model = model_sketches(seen, FEW, np.random.default_rng(0))
    assert model.atlas is not None
    red, green, blue = model.atlas.colours.mean(axis=0)
    assert red > 1.5 * green > 1.5 * blue


def test_a_front_that_is_larger_than_its_photo_is_refused() -> None:
    with pytest.raises(StrokesError, match=r"front: its canvas is 400 x 500 px, its photo 300 x 500.*own size"):
        read_sketches(sketch(0), None, np.zeros((500, 300, 3), dtype=np.uint8))


@pytest.mark.parametrize("place", ["front", "side"])
def test_an_error_names_its_sketch(place: str) -> None:
    drawn = {"front": sketch(0), "side": sketch(0), place: Sketch((400, 500), None, (line((1, 1), (1, 1)),))}
    with pytest.raises(StrokesError, match=f"^{place}: ") as caught:
        read_sketches(drawn["front"], drawn["side"])
    assert caught.value.pointer.startswith(f"/{place}/branches/0")


def test_the_same_sketches_and_seed_give_the_same_tree(grown: GrownTree) -> None:
    again = grow_sketches(read_sketches(pear("front"), pear("side")), FEW, np.random.default_rng(0))
    assert np.array_equal(again.grown.skeleton.points, grown.grown.skeleton.points)
