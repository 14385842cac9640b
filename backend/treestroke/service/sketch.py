"""Sketches of a tree's front and left side: traced, and turned into a 3D tree."""

from dataclasses import asdict

from treestroke.core.pipeline.dressing import OwnPictures
from treestroke.core.pipeline.finishing import OnGrown, unseen
from treestroke.core.pipeline.settings import check_seed
from treestroke.core.pipeline.sketching import model_sketches, see_sketches
from treestroke.core.progress import Report, silent
from treestroke.core.strokes import StrokeWarning
from treestroke.service.clock import Stopwatch
from treestroke.service.files import check_files
from treestroke.service.inputs import (
    FruitLike,
    LeafLike,
    PhotoLike,
    SettingsLike,
    SketchLike,
    load_fruit,
    load_leaf,
    load_photo,
    load_settings,
    load_sketch,
)
from treestroke.service.making import Model, make
from treestroke.service.threads import one_thread


def sketch(
    front: SketchLike,
    side: SketchLike | None = None,
    settings: SettingsLike = None,
    seed: int = 0,
    report: Report = silent,
    on_grown: OnGrown = unseen,
    *,
    photo: PhotoLike | None = None,
    leaf: LeafLike = None,
    fruit: FruitLike = None,
    name: str = "tree",
) -> Model:
    """Turn a sketch of a tree's front, and perhaps one of its left side, into a 3D tree.

    A sketch is a path or the bytes of stroke JSON or of a PNG, a plain mapping, or values. Without a side the limbs'
    depth is assumed, which a warning says. ``photo`` is what the front was drawn over, as `model` takes it: it lends
    the tree its colours. All else is as for `model`.

    Raises
    ------
    PhotoError, StrokesError, LeafError, FruitError, SettingsError
        An input cannot be used; the message says what, where and how to mend it.
    """
    chosen, seed = load_settings(settings), check_seed(seed)
    pictures = OwnPictures(load_leaf(leaf), load_fruit(fruit))
    check_files(chosen)
    watch, mended = Stopwatch(report), list[StrokeWarning]()
    with one_thread():
        with watch.stage("decode"):
            drawn, beside = load_sketch(front, "front"), None if side is None else load_sketch(side, "side")
            picture = None if photo is None else load_photo(photo, watch, mended.append)
        seen = see_sketches(drawn, beside, picture, watch)
        made = make(
            lambda rng, show: model_sketches(seen, chosen, rng, watch, show, pictures),
            chosen,
            seed,
            watch,
            on_grown,
            name,
        )
    return made.with_warnings(asdict(warning) for warning in mended)
