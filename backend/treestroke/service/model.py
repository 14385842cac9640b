"""Make trees: a photo and strokes, or sketches, in; a model and its report out."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from treestroke.codec.inputs import CUTOUTS, Inputs, SourceName
from treestroke.codec.preview import draw_preview
from treestroke.core.pipeline.drawn_views import mend_views
from treestroke.core.pipeline.dressing import OwnPictures
from treestroke.core.pipeline.evidence import read_photo
from treestroke.core.pipeline.finishing import OnGrown, TreeModel, finish, ignore_grown
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.grown_tree import GrownTree
from treestroke.core.pipeline.settings import ModelSettings, check_seed
from treestroke.core.pipeline.sketching import grow_sketches, read_sketches
from treestroke.core.progress import Report, silent
from treestroke.core.stroke_rules import require_trunk
from treestroke.core.strokes import StrokeWarning
from treestroke.core.types import Picture
from treestroke.engines.child import Bounds
from treestroke.engines.solving import solve_in_process
from treestroke.service.clip_loading import ClipLike
from treestroke.service.engine_version import GENERATOR
from treestroke.service.execution import Stopwatch, one_thread
from treestroke.service.files import Bundle, check_files, tree_files
from treestroke.service.loading import (
    EditsLike,
    EnvelopeLike,
    FileLike,
    FrameStrokesLike,
    PartLike,
    PhotoLike,
    SettingsLike,
    SketchLike,
    StrokesLike,
    ViewsLike,
    load_parts,
    load_settings,
)
from treestroke.service.report import Trees, tree_report, variant_seeds
from treestroke.service.siblings import SiblingsOrder, grove_glb, grown_siblings, sibling_files

SOLVE_BOUNDS = Bounds(seconds=600.0, memory=3 * 2**30)
"""What finding the cameras of as many photos as a capture may have takes at most."""

GrowTree = Callable[[np.random.Generator], GrownTree]
"""Grows one tree with the given random numbers: the first half of a recipe."""


@dataclass(frozen=True, eq=False)
class Model:
    """A finished tree.

    Attributes
    ----------
    bundles
        All files by their names; those of one format are together, under the first one's name.
    report
        Engine, seed, settings, seconds by stage, counts, score, measures, variants, files and warnings, as plain
        values for JSON.
    tree
        The parts that the files were made from; of several variants the first.
    """

    bundles: Mapping[str, Bundle]
    report: dict[str, Any]
    tree: TreeModel

    @property
    def glb(self) -> bytes:
        """The glTF 2.0 binary file's bytes."""
        return next(iter(self.files.values()))

    @property
    def files(self) -> dict[str, bytes]:
        """Each file's bytes by its name, the GLB first."""
        return {name: content for bundle in self.bundles.values() for name, content in bundle.items()}

    def with_warnings(self, warnings: Iterable[Mapping[str, str]]) -> "Model":
        """Return the same model with further warnings before the report's own."""
        return replace(self, report={**self.report, "warnings": [*warnings, *self.report["warnings"]]})

    def preview(self) -> Picture:
        """Draw the front view at the photo's framing beside a 3/4 view, (h, w, 3) sRGB."""
        return draw_preview(self.tree.bark, self.tree.leaf, self.tree.camera)


@dataclass(frozen=True)
class Options:
    """Options of a tree beside its inputs: settings, seed, and the beginning of its files' names."""

    settings: ModelSettings
    seed: int
    name: str = "tree"

    @classmethod
    def of(cls, settings: SettingsLike, seed: int, name: str = "tree") -> "Options":
        """Check settings and seed.

        Raises
        ------
        SettingsError
            One of them is unknown or out of range.
        """
        return cls(load_settings(settings), check_seed(seed), name)


def model(
    photo: PhotoLike,
    strokes: StrokesLike,
    settings: SettingsLike = None,
    seed: int = 0,
    report: Report = silent,
    on_grown: OnGrown = ignore_grown,
    *,
    side: SketchLike | None = None,
    leaf: FileLike | None = None,
    fruit: FileLike | None = None,
    envelope: EnvelopeLike | None = None,
    name: str = "tree",
) -> Model:
    """Turn one photo and a few strokes into a 3D tree.

    Parameters
    ----------
    photo
        A path, encoded bytes or upright sRGB pixels (h, w, 3) uint8; (h, w, 4) with straight alpha of a tree cut out.
    strokes
        A path, JSON bytes, a plain mapping or values.
    settings
        Any of `ModelSettings`' names with their values.
    seed
        The same input and seed give the same bytes.
    report
        Called as ``report(stage, fraction)`` while the work goes on.
    on_grown
        Called once, with the (first) grown tree before it has leaves and bark.
    side
        A sketch of the tree's left side, as `sketch` takes it, from which its branches have their depth.
    leaf, fruit
        Paths or bytes of PNGs of what the tree is to bear, cut out: a leaf with its stalk down, a fruit with its stalk
        up.
    envelope
        The outline that siblings are to fill: heart, triangle, circle or pentagon; or a path, JSON or PNG bytes, or a
        plain mapping.
    name
        The beginning of the files' names.

    Raises
    ------
    PhotoError, StrokesError, LeafError, FruitError, SettingsError
        An input cannot be used; the message says what, where and how to mend it.
    """
    parts = {"photo": photo, "strokes": strokes, "side": side, "leaf": leaf, "fruit": fruit, "envelope": envelope}
    return make_tree(Inputs.of(parts), Options.of(settings, seed, name), report, on_grown)


def model_views(
    photos: Sequence[str | os.PathLike[str]] | Mapping[str, PhotoLike],
    views: ViewsLike,
    settings: SettingsLike = None,
    seed: int = 0,
    report: Report = silent,
    on_grown: OnGrown = ignore_grown,
    *,
    edits: EditsLike | None = None,
    leaf: FileLike | None = None,
    fruit: FileLike | None = None,
    envelope: EnvelopeLike | None = None,
    name: str = "tree",
) -> Model:
    """Turn photos of a tree from all sides, and strokes over some of them, into a 3D tree.

    Parameters not listed here are those of `model`.

    Parameters
    ----------
    photos
        Paths, or photos by the names that strokes call them, each as `model` takes it.
    views
        A path, JSON bytes, a plain mapping or values.
    edits
        Edits of the branches that the photos show, in the frame in which their cameras are found: a path, JSON bytes, a
        plain mapping or values.

    Raises
    ------
    PhotoError, CaptureError, StrokesError, LeafError, FruitError, SettingsError
        An input cannot be used; the message says what, where and how to mend it.
    SolveEnded
        Finding the cameras took too long, ran out of memory or crashed.
    """
    named = photos if isinstance(photos, Mapping) else {os.path.basename(photo): photo for photo in photos}
    several = {f"photos/{photo}": content for photo, content in named.items()}
    parts = {**several, "views": views, "edits": edits, "leaf": leaf, "fruit": fruit, "envelope": envelope}
    return make_tree(Inputs.of(parts), Options.of(settings, seed, name), report, on_grown)


def model_video(
    clip: ClipLike,
    strokes: FrameStrokesLike,
    settings: SettingsLike = None,
    seed: int = 0,
    report: Report = silent,
    on_grown: OnGrown = ignore_grown,
    *,
    leaf: FileLike | None = None,
    fruit: FileLike | None = None,
    envelope: EnvelopeLike | None = None,
    name: str = "tree",
) -> Model:
    """Turn a clip of a tree in the wind, and strokes over one of its frames, into a 3D tree that moves as it did.

    Parameters not listed here are those of `model`.

    Parameters
    ----------
    clip
        A path, the bytes of a video (MP4, MOV, WebM, AVI or GIF), or decoded frames.
    strokes
        A path, JSON bytes, a plain mapping or values. The trunk stroke may be absent.

    Raises
    ------
    ClipError, StrokesError, LeafError, FruitError, SettingsError
        An input cannot be used; the message says what, where and how to mend it.
    """
    parts = {"clip": clip, "frame_strokes": strokes, "leaf": leaf, "fruit": fruit, "envelope": envelope}
    return make_tree(Inputs.of(parts), Options.of(settings, seed, name), report, on_grown)


def sketch(
    front: SketchLike,
    side: SketchLike | None = None,
    settings: SettingsLike = None,
    seed: int = 0,
    report: Report = silent,
    on_grown: OnGrown = ignore_grown,
    *,
    photo: PhotoLike | None = None,
    leaf: FileLike | None = None,
    fruit: FileLike | None = None,
    envelope: EnvelopeLike | None = None,
    name: str = "tree",
) -> Model:
    """Turn a sketch of a tree's front, and perhaps one of its left side, into a 3D tree.

    Parameters not listed here are those of `model`.

    Parameters
    ----------
    front, side
        A path or the bytes of stroke JSON or of a PNG, a plain mapping, or values. Without a side the limbs' depth is
        assumed, and a warning says so.
    photo
        What the front was drawn over, as `model` takes it: it gives the tree its colours.

    Raises
    ------
    PhotoError, StrokesError, LeafError, FruitError, SettingsError
        An input cannot be used; the message says what, where and how to mend it.
    """
    parts = {"front": front, "side": side, "photo": photo, "leaf": leaf, "fruit": fruit, "envelope": envelope}
    return make_tree(Inputs.of(parts), Options.of(settings, seed, name), report, on_grown)


def make_tree(
    inputs: Inputs[PartLike], options: Options, report: Report = silent, on_grown: OnGrown = ignore_grown
) -> Model:
    """Make a tree of any source; ``report`` and ``on_grown`` as for `model`.

    Raises
    ------
    TreestrokeError
        An input cannot be used.
    SolveEnded
        Finding the cameras of several photos took too long, ran out of memory or crashed.
    """
    check_files(options.settings)
    watch, mended = Stopwatch(report), list[StrokeWarning]()
    with one_thread():
        with watch.stage("decode"):
            parts = load_parts(inputs, watch, mended.append)
        grow = recipe_of(inputs.source, parts, options.settings, watch)
        made = _make_variants(grow, siblings_order(parts), options, watch, on_grown)
    return made.with_warnings(asdict(warning) for warning in mended)


def recipe_of(source: SourceName, parts: Mapping[str, Any], settings: ModelSettings, report: Report) -> GrowTree:
    """Read decoded parts of a source, and return the first half of its recipe.

    Raises
    ------
    TreestrokeError
        An input cannot be used.
    SolveEnded
        Finding the cameras of several photos took too long, ran out of memory or crashed.
    """
    match source:
        case "photo":
            return _photo_recipe(parts, settings, report)
        case "views":
            return _views_recipe(parts, settings, report)
        case "clip":
            return _clip_recipe(parts, settings, report)
        case "sketches":
            return _sketch_recipe(parts, settings, report)


def siblings_order(parts: Mapping[str, Any]) -> SiblingsOrder:
    """Return what decoded parts say of a tree's leaves and fruit, and of the outline of its siblings."""
    pictures = OwnPictures(**{name: parts[name] for name in CUTOUTS if name in parts})
    return SiblingsOrder(parts.get("envelope"), pictures)


def _photo_recipe(parts: Mapping[str, Any], settings: ModelSettings, report: Report) -> GrowTree:
    require_trunk(parts["strokes"])
    evidence = read_photo(parts["photo"], parts["strokes"], None, report, parts.get("side"))
    return lambda rng: grow_tree(evidence, settings, rng, report)


def _views_recipe(parts: Mapping[str, Any], settings: ModelSettings, report: Report) -> GrowTree:
    # With scipy, slow, and of no use for one photo.
    from treestroke.core.pipeline.edited_views import traced_views, with_edits
    from treestroke.core.pipeline.viewing import grow_views, read_views

    photos = [photo for name, photo in parts.items() if name.startswith("photos/")]
    drawn = mend_views(parts["views"], {photo.name: photo.size_px for photo in photos})  # faults are told at once
    structure = parts["structure"] if "structure" in parts else solve_in_process(photos, SOLVE_BOUNDS, report)
    evidence = read_views(photos, structure, drawn, settings.height, report)
    if "edits" in parts:
        evidence = with_edits(evidence, traced_views(photos, structure, parts["views"]), parts["edits"])
    return lambda rng: grow_views(evidence, settings, rng, report)


def _clip_recipe(parts: Mapping[str, Any], settings: ModelSettings, report: Report) -> GrowTree:
    from treestroke.core.pipeline.filming import grow_clip, read_clip  # with scipy, slow, and of no use for one photo

    evidence = read_clip(parts["clip"], parts["frame_strokes"].strokes, report)
    return lambda rng: grow_clip(evidence, settings, rng, report)


def _sketch_recipe(parts: Mapping[str, Any], settings: ModelSettings, report: Report) -> GrowTree:
    evidence = read_sketches(parts["front"], parts.get("side"), parts.get("photo"), report)
    return lambda rng: grow_sketches(evidence, settings, rng, report)


def _make_variants(
    grow: GrowTree, order: SiblingsOrder, options: Options, watch: Stopwatch, on_grown: OnGrown
) -> Model:
    """Grow as many trees as the settings ask for, each by the next seed, and their siblings, and write their files."""
    trees: list[TreeModel] = []
    bundles: dict[str, Bundle] = {}
    settings, seed, name = options.settings, options.seed, options.name
    example: GrownTree | None = None
    for index, variant_seed in enumerate(variant_seeds(seed, settings.variants)):
        rng = np.random.default_rng(variant_seed)
        grown = grow(rng)
        if example is None:
            on_grown(grown.live)
            example = grown
        trees.append(finish(grown, settings, rng, watch, order.pictures))
        variant_name = name if index == 0 else f"{name}.v{index + 1}"
        bundles |= tree_files(trees[-1], settings, variant_name, GENERATOR, watch)
    siblings = list[TreeModel]()
    if example is not None and settings.siblings:
        siblings += grown_siblings(example, order, settings, seed, watch)
        bundles |= sibling_files(siblings, settings, name, watch)
    if settings.grove:
        together = [trees[0], *siblings]
        file = f"{name}.grove.glb"
        bundles[file] = {file: grove_glb(together, len(together), settings, seed, watch)}
    return Model(bundles, tree_report(Trees(trees, siblings), bundles, settings, seed, watch), trees[0])
