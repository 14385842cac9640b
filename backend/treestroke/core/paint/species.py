"""What a photo cannot show of a tree: the shape and arrangement of its leaves, its seasons' colours and its bark."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

from treestroke.core.paint.leaf_shapes import LeafShapeName
from treestroke.core.types import FoliageKind, TreeForm

LeafArrangement = Literal["alternate", "opposite", "tufted"]
"""How leaves sit on a shoot: alternating, in opposite pairs, or together at its end."""
NeedleArrangement = Literal["long", "short", "tufts"]
"""How needles sit: long ones in brushes at the shoots' ends, short ones in flat sprays, or in tufts."""
Lab = tuple[float, float, float]
Ramp = tuple[Lab, ...]
"""Colours, CIE Lab, between which a tree's leaves lie in one season."""

GREEN: Ramp = ((40.0, -15.0, 22.0), (45.0, -18.0, 27.0), (51.0, -19.0, 32.0))
"""Summer's colours of an unknown broad-leaved tree."""
FRESH: Ramp = ((55.0, -18.0, 36.0), (62.0, -19.0, 43.0), (68.0, -17.0, 47.0))
"""Spring's colours of an unknown broad-leaved tree."""
MIXED: Ramp = ((47.0, -8.0, 31.0), (60.0, 2.0, 46.0), (55.0, 15.0, 43.0), (45.0, 17.0, 32.0))
"""Autumn's colours of an unknown broad-leaved tree."""
CONIFER: Ramp = ((34.0, -11.0, 16.0), (40.0, -13.0, 19.0), (46.0, -13.0, 23.0))
"""Colours of evergreen needles."""


@dataclass(frozen=True)
class Bark:
    """A species' bark.

    Attributes
    ----------
    form
        Its pattern: one of `treestroke.core.mesh.bark_pattern.BarkForm`.
    depth
        Standard deviation of its height, as a share of the stem's radius.
    colour
        sRGB, 0 to 255, used where the photo shows no bark.
    """

    form: Literal["smooth", "furrowed", "plated", "peeling", "banded", "scaly"] = "furrowed"
    depth: float = 0.012
    colour: tuple[int, int, int] = (104, 93, 82)


@dataclass(frozen=True)
class Species:
    """How one kind of tree is drawn.

    Attributes
    ----------
    leaf_shape
        Shape of a leaf; None draws ovate leaves of varying form.
    length
        Length of a leaf with its stalk, as a share of the spray's side.
    arrangement
        How leaves sit on a shoot.
    shoots
        Number of side shoots of a spray.
    needles
        How needles sit, or None for a broad-leaved tree.
    evergreen
        Whether it keeps its leaves and their colour all year.
    flowers
        Whether it blossoms in spring before it has leaves.
    bark
        Its bark.
    spring, summer, autumn
        Colours of its leaves, CIE Lab.
    """

    leaf_shape: LeafShapeName | None = None
    length: float = 0.24
    arrangement: LeafArrangement = "alternate"
    shoots: int = 7
    needles: NeedleArrangement | None = None
    evergreen: bool = False
    flowers: bool = False
    bark: Bark = Bark()
    spring: Ramp = FRESH
    summer: Ramp = GREEN
    autumn: Ramp = MIXED


AUTO = Species()
"""A tree of unknown kind."""

SPECIES: Mapping[str, Species] = MappingProxyType(
    {
        "ash": Species(
            "ash",
            length=0.44,
            arrangement="opposite",
            shoots=4,
            bark=Bark("furrowed", 0.016, (112, 106, 96)),
            autumn=((52.0, -9.0, 36.0), (63.0, -4.0, 47.0), (68.0, 1.0, 50.0)),
        ),
        "beech": Species(
            "beech",
            length=0.27,
            shoots=8,
            bark=Bark("smooth", 0.003, (126, 124, 118)),
            spring=((60.0, -19.0, 42.0), (66.0, -19.0, 47.0), (70.0, -15.0, 48.0)),
            summer=((38.0, -15.0, 21.0), (43.0, -18.0, 26.0), (49.0, -19.0, 30.0)),
            autumn=((56.0, 4.0, 44.0), (54.0, 17.0, 42.0), (44.0, 20.0, 33.0)),
        ),
        "birch": Species(
            "birch",
            length=0.22,
            shoots=9,
            bark=Bark("banded", 0.004, (205, 200, 190)),
            summer=((43.0, -16.0, 25.0), (49.0, -18.0, 30.0), (55.0, -18.0, 33.0)),
            autumn=((61.0, -5.0, 46.0), (68.0, 3.0, 56.0), (70.0, 9.0, 57.0)),
        ),
        "cherry": Species(
            "cherry",
            length=0.3,
            flowers=True,
            bark=Bark("banded", 0.005, (98, 74, 64)),
            spring=((84.0, 8.0, 0.0), (88.0, 5.0, 2.0), (91.0, 3.0, 3.0)),
            autumn=((60.0, 11.0, 44.0), (53.0, 25.0, 40.0), (44.0, 30.0, 29.0)),
        ),
        "elm": Species(
            "elm",
            length=0.24,
            shoots=7,
            bark=Bark("furrowed", 0.016, (102, 92, 80)),
            autumn=((50.0, -9.0, 34.0), (60.0, 0.0, 46.0), (54.0, 7.0, 38.0)),
        ),
        "horse_chestnut": Species(
            "horse_chestnut",
            length=0.46,
            arrangement="opposite",
            shoots=3,
            bark=Bark("scaly", 0.008, (106, 94, 82)),
            autumn=((50.0, -4.0, 36.0), (57.0, 10.0, 44.0), (46.0, 17.0, 34.0)),
        ),
        "larch": Species(
            needles="tufts",
            bark=Bark("scaly", 0.012, (118, 94, 80)),
            spring=((60.0, -20.0, 37.0), (66.0, -19.0, 41.0)),
            summer=((46.0, -15.0, 23.0), (52.0, -17.0, 27.0)),
            autumn=((57.0, 4.0, 44.0), (62.0, 9.0, 51.0), (58.0, 15.0, 46.0)),
        ),
        "linden": Species(
            "linden",
            length=0.29,
            bark=Bark("furrowed", 0.01, (104, 98, 90)),
            autumn=((54.0, -10.0, 39.0), (64.0, -2.0, 50.0), (67.0, 4.0, 52.0)),
        ),
        "locust": Species(
            "locust",
            length=0.46,
            shoots=5,
            bark=Bark("furrowed", 0.022, (108, 94, 80)),
            summer=((44.0, -15.0, 24.0), (50.0, -17.0, 29.0), (56.0, -17.0, 33.0)),
            autumn=((56.0, -10.0, 40.0), (65.0, -5.0, 50.0), (67.0, 0.0, 50.0)),
        ),
        "maple": Species(
            "maple",
            length=0.36,
            arrangement="opposite",
            shoots=5,
            bark=Bark("furrowed", 0.01, (112, 104, 94)),
            autumn=((64.0, 5.0, 52.0), (60.0, 20.0, 51.0), (52.0, 35.0, 43.0), (42.0, 38.0, 31.0)),
        ),
        "oak": Species(
            "oak",
            length=0.33,
            arrangement="tufted",
            shoots=6,
            bark=Bark("furrowed", 0.018, (98, 88, 78)),
            spring=((56.0, -14.0, 38.0), (61.0, -11.0, 42.0), (60.0, -4.0, 40.0)),
            summer=((38.0, -14.0, 21.0), (43.0, -16.0, 25.0), (48.0, -17.0, 29.0)),
            autumn=((47.0, -4.0, 31.0), (51.0, 10.0, 37.0), (46.0, 19.0, 33.0), (38.0, 20.0, 26.0)),
        ),
        "pine": Species(
            needles="long",
            evergreen=True,
            bark=Bark("plated", 0.018, (126, 92, 72)),
            summer=CONIFER,
        ),
        "plane": Species(
            "plane",
            length=0.38,
            shoots=4,
            bark=Bark("peeling", 0.004, (146, 138, 118)),
            autumn=((50.0, -9.0, 34.0), (57.0, 3.0, 41.0), (47.0, 13.0, 34.0)),
        ),
        "poplar": Species(
            "poplar",
            length=0.29,
            shoots=8,
            bark=Bark("furrowed", 0.016, (118, 112, 100)),
            summer=((42.0, -15.0, 24.0), (47.0, -17.0, 28.0), (54.0, -17.0, 31.0)),
            autumn=((58.0, -8.0, 43.0), (68.0, 1.0, 56.0), (66.0, 9.0, 54.0)),
        ),
        "spruce": Species(
            needles="short",
            evergreen=True,
            bark=Bark("scaly", 0.008, (104, 84, 72)),
            summer=CONIFER,
        ),
        "walnut": Species(
            "walnut",
            length=0.56,
            shoots=4,
            bark=Bark("furrowed", 0.02, (96, 86, 76)),
            spring=((56.0, -12.0, 38.0), (61.0, -8.0, 42.0)),
            autumn=((52.0, -8.0, 36.0), (60.0, -1.0, 45.0), (52.0, 6.0, 37.0)),
        ),
        "willow": Species(
            "willow",
            length=0.31,
            shoots=7,
            bark=Bark("furrowed", 0.014, (108, 98, 84)),
            summer=((47.0, -12.0, 21.0), (52.0, -14.0, 25.0), (58.0, -14.0, 27.0)),
            autumn=((56.0, -10.0, 37.0), (62.0, -8.0, 44.0), (65.0, -2.0, 46.0)),
        ),
    }
)
"""Known kinds of trees, by the values of the setting `species`; its value `auto` means AUTO."""


def species_for(name: str, kind: FoliageKind, form: TreeForm) -> Species:
    """Return the species of a name; for `auto`, one whose sprays are those of most trees of a kind and a form.

    A conifer that is no spire is drawn as a pine, another one as a fir; a weeping tree as a willow.
    """
    if name in SPECIES:
        return SPECIES[name]
    if kind == "needles":
        return replace(AUTO, needles="short" if form == "spire" else "long")
    if kind == "leaves" and form == "weeping":
        return replace(AUTO, leaf_shape="willow", length=0.3, shoots=3)
    return AUTO
