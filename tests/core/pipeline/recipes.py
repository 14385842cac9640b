"""Whole recipes: from what was read to a finished tree."""

import numpy as np

from treestroke.core.pipeline.dressing import NO_PICTURES, OwnPictures
from treestroke.core.pipeline.evidence import PhotoEvidence
from treestroke.core.pipeline.finishing import TreeModel, finish
from treestroke.core.pipeline.growing import grow_tree
from treestroke.core.pipeline.settings import ModelSettings
from treestroke.core.pipeline.sketching import SketchEvidence, grow_sketches
from treestroke.core.progress import Report, silent


def model_photo(
    evidence: PhotoEvidence,
    settings: ModelSettings,
    rng: np.random.Generator,
    report: Report = silent,
    pictures: OwnPictures = NO_PICTURES,
) -> TreeModel:
    return finish(grow_tree(evidence, settings, rng, report), settings, rng, report, pictures)


def model_sketches(evidence: SketchEvidence, settings: ModelSettings, rng: np.random.Generator) -> TreeModel:
    return finish(grow_sketches(evidence, settings, rng), settings, rng)
