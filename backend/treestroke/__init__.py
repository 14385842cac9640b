"""One photo of a real tree and a few loose strokes become a 3D tree.

The two calls are ``treestroke.trace(photo, strokes)`` and ``treestroke.model(photo, strokes, settings, seed, report)``.
They are imported at first use, so that ``treestroke --version`` and a wrong command answer at once.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from treestroke.core.errors import PhotoError, SettingsError, StrokesError, TreestrokeError
    from treestroke.core.pipeline.grown_tree import LiveTree
    from treestroke.core.pipeline.settings import ModelSettings
    from treestroke.core.strokes import Stroke, Strokes
    from treestroke.service.model import Model, model
    from treestroke.service.trace import Trace, trace

__version__ = "0.1.0"

__all__ = [
    "LiveTree",
    "Model",
    "ModelSettings",
    "PhotoError",
    "SettingsError",
    "Stroke",
    "Strokes",
    "StrokesError",
    "Trace",
    "TreestrokeError",
    "model",
    "trace",
]

_HOMES = {
    "treestroke.core.errors": ("PhotoError", "SettingsError", "StrokesError", "TreestrokeError"),
    "treestroke.core.pipeline.growing": ("LiveTree",),
    "treestroke.core.pipeline.settings": ("ModelSettings",),
    "treestroke.core.strokes": ("Stroke", "Strokes"),
    "treestroke.service.model": ("Model", "model"),
    "treestroke.service.trace": ("Trace", "trace"),
}


def __getattr__(name: str) -> Any:
    for home, names in _HOMES.items():
        if name in names:
            return getattr(import_module(home), name)
    raise AttributeError(f"module 'treestroke' has no attribute {name!r}")
