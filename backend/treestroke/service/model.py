"""Model a tree: photo and strokes in, perhaps with a sketch of its left side, GLB out."""

from dataclasses import asdict

from treestroke.core.pipeline.dressing import OwnPictures
from treestroke.core.pipeline.finishing import OnGrown, unseen
from treestroke.core.pipeline.growing import read_photo
from treestroke.core.pipeline.photo import model_photo
from treestroke.core.pipeline.settings import check_seed
from treestroke.core.progress import Report, silent
from treestroke.core.stroke_rules import require_trunk
from treestroke.core.strokes import StrokeWarning
from treestroke.service.clock import Stopwatch
from treestroke.service.files import check_files
from treestroke.service.inputs import (
    FruitLike,
    LeafLike,
    PhotoLike,
    SettingsLike,
    SketchLike,
    StrokesLike,
    load_fruit,
    load_leaf,
    load_photo,
    load_settings,
    load_sketch,
    load_strokes,
)
from treestroke.service.making import Model, make
from treestroke.service.threads import one_thread


def model(
    photo: PhotoLike,
    strokes: StrokesLike,
    settings: SettingsLike = None,
    seed: int = 0,
    report: Report = silent,
    on_grown: OnGrown = unseen,
    *,
    side: SketchLike | None = None,
    leaf: LeafLike = None,
    fruit: FruitLike = None,
    name: str = "tree",
) -> Model:
    """Turn one photo and a few strokes into a 3D tree.

    ``photo`` is a path, encoded bytes or upright sRGB pixels (h, w, 3) uint8; ``strokes`` a path, JSON bytes, a plain
    mapping or values; ``settings`` holds any of `ModelSettings`' names. ``side`` is a sketch of the tree's left side,
    as `sketch` takes it, by which its branches have their depth. ``leaf`` and ``fruit`` are paths or the bytes of PNGs
    of what the tree is to bear, cut out: a leaf with its stalk down, a fruit with its stalk up.
    ``report(stage, fraction)`` is called as the work goes on, ``on_grown(tree)`` once, with the (first) grown tree
    before it has leaves and bark. ``name`` begins the files' names. The same input and seed give the same bytes.

    Raises
    ------
    PhotoError, StrokesError, LeafError, FruitError, SettingsError
        An input cannot be used; the message says what, where and how to mend it.
    """
    chosen, seed, given = load_settings(settings), check_seed(seed), load_strokes(strokes)
    beside = None if side is None else load_sketch(side, "side")
    pictures = OwnPictures(load_leaf(leaf), load_fruit(fruit))
    require_trunk(given)
    check_files(chosen)
    watch, mended = Stopwatch(report), list[StrokeWarning]()
    with one_thread():
        with watch.stage("decode"):
            picture = load_photo(photo, watch, mended.append)
        seen = read_photo(picture, given, None, watch, beside)
        made = make(
            lambda rng, show: model_photo(seen, chosen, rng, watch, show, pictures), chosen, seed, watch, on_grown, name
        )
    return made.with_warnings(asdict(warning) for warning in mended)
