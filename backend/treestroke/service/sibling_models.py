"""Make siblings of a tree: a project in, models of other trees of the same kind out, and a grove of them."""

import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from treestroke.codec.inputs import Inputs
from treestroke.core.errors import TreestrokeError
from treestroke.core.pipeline.settings import ModelSettings, Span
from treestroke.core.progress import Report, silent
from treestroke.core.strokes import StrokeWarning
from treestroke.service.execution import Stopwatch, one_thread
from treestroke.service.files import check_files
from treestroke.service.loading import EnvelopeLike, PartLike, SettingsLike, load_parts, load_project
from treestroke.service.model import Model, Options, recipe_of, siblings_order
from treestroke.service.report import Trees, tree_report
from treestroke.service.siblings import grove_glb, grown_siblings, sibling_files

MOST_TREES = Span(1, 200, whole=True)
"""How many trees a grove may have."""
MOST_SIBLINGS = 16
"""How many of them may be different."""


@dataclass(frozen=True)
class Planting:
    """How many trees are wanted, and whether they are set together in one scene."""

    count: int
    scene: bool


def siblings(
    project: str | os.PathLike[str],
    count: int = 1,
    settings: SettingsLike = None,
    seed: int | None = None,
    *,
    outline: EnvelopeLike | None = None,
    scene: bool = False,
    report: Report = silent,
    name: str = "tree",
) -> Model:
    """Grow other trees of the same kind as a project's tree, none of them a copy.

    Parameters
    ----------
    project
        Path of a project file, ``NAME.treestroke``.
    count
        How many; of more than 16, which only a scene has, the 16 stand again, turned.
    settings
        Changes to the project's own settings.
    seed
        The project's own where absent.
    outline
        What their crowns fill, seen from the front: heart, triangle, circle or pentagon; a path or the bytes of stroke
        JSON or of the PNG of a shape; or a plain mapping. As wide and high as the tree's own crown where absent.
    scene
        Whether ``NAME.grove.glb`` is among the files: all of them beside each other.
    report, name
        As for `model`.

    Raises
    ------
    TreestrokeError
        As the function that makes the project's tree; or the outline or the count cannot be used.
    """
    opened = load_project(project)
    chosen = {**opened.settings, **_plain(settings)}
    own_seed = chosen.pop("seed", 0)
    inputs: dict[str, PartLike | None] = {**opened.inputs.parts, **({} if outline is None else {"envelope": outline})}
    options = Options.of(chosen, own_seed if seed is None else seed, name)
    return make_siblings(Inputs.of(inputs), options, Planting(count, scene), report)


def make_siblings(inputs: Inputs[PartLike], options: Options, planting: Planting, report: Report = silent) -> Model:
    """Grow the tree that inputs make, and siblings of it, of which alone files are written.

    Raises
    ------
    TreestrokeError, SolveEnded
        As `make_tree`; or the count cannot be used.
    """
    check_files(options.settings)
    check_count(planting)
    settings = replace(options.settings, siblings=min(planting.count, MOST_SIBLINGS))
    watch, mended = Stopwatch(report), list[StrokeWarning]()
    with one_thread():
        with watch.stage("decode"):
            parts = load_parts(inputs, watch, mended.append)
        example = recipe_of(inputs.source, parts, settings, watch)(np.random.default_rng(options.seed))
        trees = list(grown_siblings(example, siblings_order(parts), settings, options.seed, watch))
        bundles = sibling_files(trees, settings, options.name, watch)
        if planting.scene:
            file = f"{options.name}.grove.glb"
            bundles[file] = {file: grove_glb(trees, planting.count, settings, options.seed, watch)}
    made = Model(bundles, tree_report(Trees((), trees), bundles, settings, options.seed, watch), trees[0])
    return made.with_warnings(asdict(warning) for warning in (*mended, *example.warnings))


def check_count(planting: Planting) -> None:
    """Check how many trees are wanted.

    Raises
    ------
    TreestrokeError
        They are too few or too many.
    """
    if not MOST_TREES.holds(planting.count):
        raise TreestrokeError.at(("count",), f"{planting.count} is not allowed; give {MOST_TREES}", "bad_input")
    if planting.count > MOST_SIBLINGS and not planting.scene:
        fault = f"at most {MOST_SIBLINGS} can be different; ask for a scene too, in which they stand again, turned"
        raise TreestrokeError.at(("count",), fault, "bad_input")


def _plain(settings: SettingsLike) -> Mapping[str, Any]:
    """Return changes of settings as names and values."""
    return asdict(settings) if isinstance(settings, ModelSettings) else (settings or {})
