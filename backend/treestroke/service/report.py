"""The report of a model: what was made, how long it took, how well it fits and what it measures, as plain values."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import cv2
import numpy as np

from treestroke.codec.cameras import plain_cameras
from treestroke.codec.motion import plain_motion
from treestroke.core.geometry.camera import Camera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.silhouette import overlap, silhouette
from treestroke.core.leaf.leaves import fruit_among
from treestroke.core.pipeline.finishing import TreeModel
from treestroke.core.pipeline.grown_tree import CapturedViews
from treestroke.core.pipeline.settings import MAX_SEED, ModelSettings, plain_settings
from treestroke.core.pipeline.taken import Taken
from treestroke.core.survey.measures import Measures
from treestroke.service.engine_version import engine_version
from treestroke.service.execution import Stopwatch
from treestroke.service.files import Bundle

SCORED_HEIGHT = 400
"""Px, of the front view that the silhouette score is measured on."""


def variant_seeds(first: int, count: int) -> list[int]:
    """Return the seeds of ``count`` variants, from ``first`` on; after the largest seed comes 0."""
    return [(first + index) % (MAX_SEED + 1) for index in range(count)]


@dataclass(frozen=True, eq=False)
class Trees:
    """The finished trees of a model: variants of its inputs, and siblings of the first of them; one at least."""

    variants: Sequence[TreeModel]
    siblings: Sequence[TreeModel] = ()

    @property
    def all(self) -> list[TreeModel]:
        """Variants, then siblings."""
        return [*self.variants, *self.siblings]


def tree_report(
    made: Trees, bundles: Mapping[str, Bundle], settings: ModelSettings, seed: int, watch: Stopwatch
) -> dict[str, Any]:
    """Return the report of a model's trees, of which ``seed`` is the first one's, and of all their files."""
    trees = made.all
    tree, files = trees[0], {name: len(content) for bundle in bundles.values() for name, content in bundle.items()}
    ious = [_silhouette_ious(variant) for variant in trees]
    scores = [
        {"silhouette_iou": float(np.mean(found)), **variant.score} for found, variant in zip(ious, trees, strict=True)
    ]
    counts = [_counts(variant) for variant in trees]
    return {
        "engine": engine_version(),
        "seed": seed,
        "settings": {**plain_settings(settings), "foliage": tree.taken.foliage},
        "taken": plain_taken(tree.taken),
        "seconds": {stage: round(seconds, 4) for stage, seconds in watch.seconds.items()},
        "counts": {**counts[0], "bytes": next(iter(files.values()))},
        "score": scores[0],
        "reading": asdict(tree.reading),
        "measures": _plain_measures(tree.measures),
        "variants": [
            {"seed": variant_seed, "counts": count, "score": score}
            for variant_seed, count, score in zip(variant_seeds(seed, len(made.variants)), counts, scores, strict=False)
        ],
        "siblings": [
            {"counts": count, "score": score}
            for count, score in zip(counts[len(made.variants) :], scores[len(made.variants) :], strict=True)
        ],
        "files": files,
        **({} if tree.captured is None else _plain_views(tree.captured, ious[0])),
        **({} if tree.motion is None else {"motion": plain_motion(tree.motion)}),
        "warnings": [asdict(warning) for warning in tree.warnings],
    }


def plain_taken(taken: Taken) -> dict[str, Any]:
    """Return what a tree is taken for as plain values, the sureness rounded to 2 digits."""
    return {
        "foliage": taken.foliage,
        "form": taken.form,
        "sureness": round(taken.sureness, 2),
        "ask": taken.ask,
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
    """Count the cards that show leaves, not fruit."""
    return 0 if tree.cards is None or tree.atlas is None else int((~fruit_among(tree.cards, tree.atlas)).sum())


def _plain_measures(measures: Measures) -> dict[str, Any]:
    """Return measures as plain values, numbers rounded to 4 digits."""

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


def _silhouette_ious(tree: TreeModel) -> list[float]:
    """Return the overlap of each view with the foliage and branches that were found in it, at a reduced size."""
    return [_silhouette_iou(tree, expected) for expected in tree.expected]


def _silhouette_iou(tree: TreeModel, expected: Silhouette[Camera]) -> float:
    shown = silhouette(tree.bark, tree.leaf, expected.camera, min(SCORED_HEIGHT, len(expected.mask)))
    size = (shown.shape[1], shown.shape[0])
    return overlap(shown, cv2.resize(expected.mask.astype(np.float32), size, interpolation=cv2.INTER_AREA) >= 0.5)


def _plain_views(captured: CapturedViews, ious: Sequence[float]) -> dict[str, Any]:
    """Return where a capture's photos were taken, how the tree fits each, and which were left out."""
    return {
        "registered": {"used": len(captured.names), "of": len(captured.names) + len(captured.unused)},
        "cameras": plain_cameras(captured),
        "photos": [
            *({"photo": name, "silhouette_iou": iou} for name, iou in zip(captured.names, ious, strict=True)),
            *({"photo": photo.name, "unused": photo.code, "detail": photo.detail} for photo in captured.unused),
        ],
    }
