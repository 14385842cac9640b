"""Model a tree: photo and strokes in, GLB out."""

from dataclasses import asdict, dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke import __version__
from treestroke.codec.gltf.tree import Part, encode_glb
from treestroke.codec.preview import draw_preview
from treestroke.codec.silhouette import likeness, silhouette
from treestroke.core.pipeline.photo import OnGrown, TreeModel, model_photo, unseen
from treestroke.core.pipeline.settings import ModelSettings, check_seed
from treestroke.core.progress import Report, silent
from treestroke.core.stroke_rules import require_trunk
from treestroke.service.clock import Stopwatch
from treestroke.service.inputs import PhotoLike, SettingsLike, StrokesLike, load_photo, load_settings, load_strokes
from treestroke.service.threads import one_thread

ENGINE = f"treestroke {__version__}"
SCORED_HEIGHT = 400
STAGES = ("decode", "foliage", "trace", "lift", "grow", "leaf", "mesh", "write")


@dataclass(frozen=True, eq=False)
class Model:
    """A finished tree.

    Attributes
    ----------
    glb
        The glTF 2.0 binary file's bytes.
    report
        Engine, seed, settings, seconds by stage, counts, score and warnings, as plain values for JSON.
    tree
        The parts that the file was made from.
    """

    glb: bytes
    report: dict[str, Any]
    tree: TreeModel

    def preview(self) -> NDArray[np.uint8]:
        """Draw the front view at the photo's framing beside a 3/4 view, (h, w, 3) sRGB."""
        return draw_preview(self.tree.bark, self.tree.leaf, self.tree.camera)


def model(
    photo: PhotoLike,
    strokes: StrokesLike,
    settings: SettingsLike = None,
    seed: int = 0,
    report: Report = silent,
    on_grown: OnGrown = unseen,
) -> Model:
    """Turn one photo and a few strokes into a 3D tree.

    ``photo`` is a path, encoded bytes or upright sRGB pixels (h, w, 3) uint8; ``strokes`` a path, JSON bytes, a plain
    mapping or values; ``settings`` holds any of `ModelSettings`' names. ``report(stage, fraction)`` is called as
    the work goes on, ``on_grown(tree)`` once, with the grown tree before it has leaves and bark. The same photo,
    strokes, settings and seed give the same bytes.

    Raises
    ------
    PhotoError, StrokesError, SettingsError
        An input cannot be used; the message says what, where and how to mend it.
    """
    chosen, seed, given = load_settings(settings), check_seed(seed), load_strokes(strokes)
    require_trunk(given)
    watch = Stopwatch(report)
    with one_thread():
        with watch.stage("decode"):
            picture = load_photo(photo, watch)
        tree = model_photo(picture, given, chosen, np.random.default_rng(seed), watch, on_grown)
        with watch.stage("write"):
            glb = encode_glb(_parts(tree), tree.camera, generator=ENGINE)
    return Model(glb, _report(tree, len(glb), chosen, seed, watch), tree)


def _parts(tree: TreeModel) -> list[Part]:
    return [Part("bark", tree.bark)] + ([] if tree.leaf is None else [Part("leaf", tree.leaf)])


def _report(tree: TreeModel, size: int, settings: ModelSettings, seed: int, watch: Stopwatch) -> dict[str, Any]:
    surfaces = [tree.bark] if tree.leaf is None else [tree.bark, tree.leaf]
    return {
        "engine": ENGINE,
        "seed": seed,
        "settings": {**asdict(settings), "foliage": tree.foliage_kind},
        "seconds": {stage: round(watch.seconds[stage], 4) for stage in STAGES},
        "counts": {
            "iterations": tree.iterations,
            "branches": tree.branches,
            "leaves": 0 if tree.cards is None else len(tree.cards),
            "triangles": sum(len(surface.mesh.triangles) for surface in surfaces),
            "bytes": size,
        },
        "score": {"silhouette_iou": _silhouette_iou(tree), **tree.score},
        "warnings": [asdict(warning) for warning in tree.warnings],
    }


def _silhouette_iou(tree: TreeModel) -> float:
    """Compare the front view with the foliage and branches that were found, at a size that costs little."""
    seen = silhouette(tree.bark, tree.leaf, tree.camera, min(SCORED_HEIGHT, len(tree.likeness)))
    size = (seen.shape[1], seen.shape[0])
    wanted = cv2.resize(tree.likeness.astype(np.float32), size, interpolation=cv2.INTER_AREA) >= 0.5
    return likeness(seen, wanted)
