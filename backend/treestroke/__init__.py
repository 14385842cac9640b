"""A 3D tree from photos or a video of a real tree and a few strokes, or from two sketches of a tree.

The functions are ``treestroke.trace(photo, strokes)``, ``treestroke.model(photo, strokes, settings, seed, report)``,
``treestroke.model_views(photos, views, settings, seed, report)``,
``treestroke.model_video(clip, strokes, settings, seed, report)``,
``treestroke.sketch(front, side, settings, seed, report)`` and ``treestroke.siblings(project, count, settings, seed)``.
They are imported at first use, so that ``treestroke --version`` and a wrong command respond at once.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from treestroke.core.errors import (
        CaptureError,
        ClipError,
        EnvelopeError,
        FruitError,
        LeafError,
        PhotoError,
        SettingsError,
        StrokesError,
        TreestrokeError,
    )
    from treestroke.core.pipeline.grown_tree import LiveTree
    from treestroke.core.pipeline.settings import ModelSettings
    from treestroke.core.strokes import CaptureStrokes, FrameStrokes, Sketch, Stroke, Strokes
    from treestroke.engines.solving import SolveEnded
    from treestroke.service.model import Model, model, model_video, model_views, sketch
    from treestroke.service.sibling_models import siblings
    from treestroke.service.trace import Trace, trace

__version__ = "0.1.0"

__all__ = [
    "CaptureError",
    "CaptureStrokes",
    "ClipError",
    "EnvelopeError",
    "FrameStrokes",
    "FruitError",
    "LeafError",
    "LiveTree",
    "Model",
    "ModelSettings",
    "PhotoError",
    "SettingsError",
    "Sketch",
    "SolveEnded",
    "Stroke",
    "Strokes",
    "StrokesError",
    "Trace",
    "TreestrokeError",
    "model",
    "model_video",
    "model_views",
    "siblings",
    "sketch",
    "trace",
]

_HOMES = {
    "treestroke.core.errors": (
        "CaptureError",
        "ClipError",
        "EnvelopeError",
        "FruitError",
        "LeafError",
        "PhotoError",
        "SettingsError",
        "StrokesError",
        "TreestrokeError",
    ),
    "treestroke.core.pipeline.grown_tree": ("LiveTree",),
    "treestroke.core.pipeline.settings": ("ModelSettings",),
    "treestroke.core.strokes": ("CaptureStrokes", "FrameStrokes", "Sketch", "Stroke", "Strokes"),
    "treestroke.engines.solving": ("SolveEnded",),
    "treestroke.service.model": ("Model", "model", "model_video", "model_views", "sketch"),
    "treestroke.service.sibling_models": ("siblings",),
    "treestroke.service.trace": ("Trace", "trace"),
}


def __getattr__(name: str) -> Any:
    for home, names in _HOMES.items():
        if name in names:
            return getattr(import_module(home), name)
    raise AttributeError(f"module 'treestroke' has no attribute {name!r}")
