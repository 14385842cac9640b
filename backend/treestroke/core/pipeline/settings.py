"""Settings of one model: the one description for library, command line, HTTP, page and documents."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import Any, Literal

import numpy as np

from treestroke.core.errors import SettingsError, shown
from treestroke.core.paint.seasons import SEASONS
from treestroke.core.paint.species import SPECIES
from treestroke.core.types import FOLIAGE_KINDS, TREE_FORMS

MAX_SEED = 2**63 - 1
FILES = ("gltf", "obj", "usdz", "ply", "instanced", "collision", "json", "swc", "csv")
"""Files beside the GLB: other formats, leaves as instances, a collision solid, the skeleton."""

LIFTS = ("spread", "posterior")
"""Ways to guess the depth of limbs that one picture shows (docs/decisions/0018)."""


@dataclass(frozen=True)
class Span:
    """Numbers from ``low`` to ``high``, both included; integers only where ``whole``."""

    low: float
    high: float
    whole: bool = False

    def __str__(self) -> str:
        return f"{'a whole number ' if self.whole else ''}from {self.low:g} to {self.high:g}"

    def holds(self, value: Any) -> bool:
        """Tell whether a value is a number in the range; bools are rejected."""
        kinds = int | np.integer if self.whole else int | float | np.integer | np.floating
        return isinstance(value, kinds) and not isinstance(value, bool) and bool(self.low <= value <= self.high)

    def plain(self, value: Any) -> float:
        """Return a number as Python's int or float."""
        return int(value) if self.whole else float(value)


@dataclass(frozen=True)
class Choice:
    """One of a few names."""

    names: tuple[str, ...]

    def __str__(self) -> str:
        return ", ".join(self.names)

    def holds(self, value: object) -> bool:
        """Tell whether a value is one of the names."""
        return isinstance(value, str) and value in self.names

    def plain(self, value: str) -> str:
        """Return a name as Python's str."""
        return str(value)


@dataclass(frozen=True)
class Toggle:
    """True or false."""

    def __str__(self) -> str:
        return "true or false"

    def holds(self, value: object) -> bool:
        """Tell whether a value is true or false."""
        return isinstance(value, bool | np.bool_)

    def plain(self, value: bool) -> bool:
        """Return a bool as Python's bool."""
        return bool(value)


@dataclass(frozen=True)
class Several:
    """Any number of a few names, or no name."""

    names: tuple[str, ...]

    def __str__(self) -> str:
        return f"any of {', '.join(self.names)}"

    def holds(self, value: object) -> bool:
        """Tell whether a value is a list of the names."""
        return isinstance(value, list | tuple) and all(isinstance(name, str) and name in self.names for name in value)

    def plain(self, value: Sequence[str]) -> tuple[str, ...]:
        """Return the names, each once, in the order of the description."""
        return tuple(name for name in self.names if name in value)


Allowed = Span | Choice | Toggle | Several
Group = Literal["tree", "leaves", "file"]


def _setting(default: object, allowed: Allowed, meaning: str, group: Group) -> Any:
    return field(default=default, metadata={"allowed": allowed, "meaning": meaning, "group": group})


@dataclass(frozen=True)
class ModelSettings:
    """What a person may choose about a model; a field's metadata holds what is ``allowed``, ``meaning`` and ``group``.

    Raises
    ------
    SettingsError
        A value is not allowed.
    """

    height: float = _setting(10.0, Span(0.1, 150), "metres, from the root to the foliage's top", "tree")
    library: str = _setting(
        "auto", Choice(("auto", "visible", "type1", "type2", "both")), "subtrees that growth may use", "tree"
    )
    iterations: int = _setting(300, Span(0, 2000, whole=True), "rounds of growth", "tree")
    variants: int = _setting(1, Span(1, 16, whole=True), "trees grown of the photo, each by the next seed", "tree")
    siblings: int = _setting(0, Span(0, 16, whole=True), "other trees of the same kind, each in a file", "tree")
    grove: bool = _setting(False, Toggle(), "one more file: the tree and its siblings beside each other", "file")
    lift: str = _setting(
        "auto", Choice(("auto", *LIFTS)), "how limbs get their depth: kept apart, or by probability", "tree"
    )
    form: str = _setting("auto", Choice(("auto", *TREE_FORMS)), "how limbs grow where the photo shows none", "tree")
    species: str = _setting("auto", Choice(("auto", *SPECIES)), "shape and place of leaves, relief of bark", "leaves")
    season: str = _setting("photo", Choice(("photo", *SEASONS)), "colour and number of leaves", "leaves")
    foliage: str = _setting("auto", Choice(("auto", *FOLIAGE_KINDS)), "what the twigs bear", "leaves")
    light: str = _setting("photo", Choice(("photo", "even")), "light and shade as in the photo, or evened", "leaves")
    edge: str = _setting(
        "complete", Choice(("complete", "cut")), "what the photo's edge cuts off is completed, or cut", "tree"
    )
    leaf_size: float = _setting(1.0, Span(0.3, 3), "factor on the size of the leaves", "leaves")
    leaf_density: float = _setting(1.0, Span(0, 3), "factor on the number of leaves", "leaves")
    wind: str = _setting(
        "none", Choice(("none", "breeze", "all")), "movements in the file: a breeze, and a gust", "file"
    )
    lod: str = _setting(
        "none", Choice(("none", "files", "one")), "levels of detail: as files of their own, or in the one file", "file"
    )
    compress: bool = _setting(False, Toggle(), "a file about a third as large (meshopt, WebP)", "file")
    files: tuple[str, ...] = _setting((), Several(FILES), "further files", "file")

    def __post_init__(self) -> None:
        for entry in fields(self):
            value, allowed = getattr(self, entry.name), entry.metadata["allowed"]
            if not allowed.holds(value):
                code = "non_finite_number" if _is_not_finite(value) else "setting_not_allowed"
                raise SettingsError.at((entry.name,), f"{shown(value)} is not allowed; give {allowed}", code)
            object.__setattr__(self, entry.name, allowed.plain(value))


def settings_from(values: Mapping[str, Any]) -> ModelSettings:
    """Return settings made of names and values; what is absent takes its default.

    Raises
    ------
    SettingsError
        A name is unknown or a value is not allowed.
    """
    known = [entry.name for entry in fields(ModelSettings)]
    for name in values:
        if name not in known:
            fault = f"there is no such setting; the settings are {', '.join(known)}"
            raise SettingsError.at((name,), fault, "unknown_setting")
    return ModelSettings(**values)


def plain_settings(settings: ModelSettings) -> dict[str, Any]:
    """Return settings by name as plain values for JSON."""
    return {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(settings).items()}


SEED = Span(0, MAX_SEED, whole=True)


def check_seed(seed: Any) -> int:
    """Return a seed as an int.

    Raises
    ------
    SettingsError
        It is not a whole number from 0 to 2^63 - 1.
    """
    if not SEED.holds(seed):
        fault = f"{shown(seed)} is not allowed; give a whole number from 0 to {MAX_SEED}"
        raise SettingsError.at(("seed",), fault, "seed_invalid")
    return int(seed)


def _is_not_finite(value: object) -> bool:
    """Tell whether a value is NaN or infinite."""
    return isinstance(value, float | np.floating) and not np.isfinite(value)
