"""Trees grown, written to files and reported on, whatever they were seen in."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke import __version__
from treestroke.codec.preview import draw_preview
from treestroke.core.geometry.silhouette import likeness, silhouette
from treestroke.core.leaf.leaves import fruit_among
from treestroke.core.pipeline.finishing import OnGrown, TreeModel, unseen
from treestroke.core.pipeline.settings import MAX_SEED, ModelSettings, plain_settings
from treestroke.core.survey.measures import Measures
from treestroke.service.engine_version import engine_version
from treestroke.service.execution import Stopwatch
from treestroke.service.files import Bundle, tree_files

GENERATOR = f"treestroke {__version__}"
"""As the files name what made them: without the engine's digest, so that the same tree has the same bytes."""
SCORED_HEIGHT = 400
STAGES = ("decode", "foliage", "trace", "lift", "grow", "leaf", "mesh", "levels", "write")

Grow = Callable[[np.random.Generator, OnGrown], TreeModel]
"""Makes one tree by random numbers of its own, and shows it when growth ends."""


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
        """Give the same with further warnings before the report's own."""
        return replace(self, report={**self.report, "warnings": [*warnings, *self.report["warnings"]]})

    def preview(self) -> NDArray[np.uint8]:
        """Draw the front view at the photo's framing beside a 3/4 view, (h, w, 3) sRGB."""
        return draw_preview(self.tree.bark, self.tree.leaf, self.tree.camera)


def make(grow: Grow, settings: ModelSettings, seed: int, watch: Stopwatch, on_grown: OnGrown, name: str) -> Model:
    """Grow as many trees as the settings ask for, each by the next seed, and write their files.

    ``on_grown`` is shown the first; ``name`` begins the files' names.
    """
    trees: list[TreeModel] = []
    bundles: dict[str, Bundle] = {}
    for at, one in enumerate(_seeds(seed, settings.variants)):
        trees.append(grow(np.random.default_rng(one), unseen if trees else on_grown))
        bundles |= tree_files(trees[-1], settings, name if at == 0 else f"{name}.v{at + 1}", GENERATOR, watch)
    return Model(bundles, _report(trees, bundles, settings, seed, watch), trees[0])


def _seeds(first: int, count: int) -> list[int]:
    """Give the seeds of variants, from the first on, around the end if need be."""
    return [(first + at) % (MAX_SEED + 1) for at in range(count)]


def _report(
    trees: Sequence[TreeModel], bundles: Mapping[str, Bundle], settings: ModelSettings, seed: int, watch: Stopwatch
) -> dict[str, Any]:
    tree, files = trees[0], {name: len(content) for bundle in bundles.values() for name, content in bundle.items()}
    scores = [{"silhouette_iou": _silhouette_iou(one), **one.score} for one in trees]
    counts = [_counts(one) for one in trees]
    return {
        "engine": engine_version(),
        "seed": seed,
        "settings": {**plain_settings(settings), "foliage": tree.foliage_kind},
        "seconds": {stage: round(watch.seconds[stage], 4) for stage in STAGES if stage in watch.seconds},
        "counts": {**counts[0], "bytes": next(iter(files.values()))},
        "score": scores[0],
        "reading": asdict(tree.reading),
        "measures": _plain_measures(tree.measures),
        "variants": [
            {"seed": one, "counts": count, "score": score}
            for one, count, score in zip(_seeds(seed, len(trees)), counts, scores, strict=True)
        ],
        "files": files,
        "warnings": [asdict(warning) for warning in tree.warnings],
    }


def _counts(tree: TreeModel) -> dict[str, int]:
    surfaces = [tree.bark] if tree.leaf is None else [tree.bark, tree.leaf]
    return {
        "iterations": tree.iterations,
        "branches": tree.branches,
        "leaves": _leaf_count(tree),
        "triangles": sum(len(surface.mesh.triangles) for surface in surfaces),
    }


def _leaf_count(tree: TreeModel) -> int:
    """Count the cards that are no fruit."""
    return 0 if tree.cards is None or tree.atlas is None else int((~fruit_among(tree.cards, tree.atlas)).sum())


def _plain_measures(measures: Measures) -> dict[str, Any]:
    """Write measures as plain values, lengths to the millimetre and all else to as many digits as mean something."""

    def plain(value: object) -> object:
        return float(f"{value:.4g}") if isinstance(value, float) else value

    figures = {
        name: {key: plain(value) for key, value in asdict(figure).items()} for name, figure in measures.figures.items()
    }
    scale = measures.scale
    return {
        **figures,
        "branches_by_order": {
            "value": list(measures.branches_by_order),
            "basis": "derived",
            "meaning": "stems, what leaves them, what leaves those, and so on: seen and grown",
        },
        "scale": {
            "value": scale.metres_per_pixel,
            "unit": "m/px",
            "basis": "measured" if scale.known else "given",
            "meaning": "metres a pixel of the picture at the tree, by "
            + ("the line of known length" if scale.known else "the height that was given"),
        },
    }


def _silhouette_iou(tree: TreeModel) -> float:
    """Compare the front view with the foliage and branches that were found, at a size that costs little."""
    seen = silhouette(tree.bark, tree.leaf, tree.camera, min(SCORED_HEIGHT, len(tree.likeness)))
    size = (seen.shape[1], seen.shape[0])
    wanted = cv2.resize(tree.likeness.astype(np.float32), size, interpolation=cv2.INTER_AREA) >= 0.5
    return likeness(seen, wanted)
