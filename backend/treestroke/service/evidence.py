"""What a tree may be made of, in one value for whoever does not know which it will be."""

from dataclasses import dataclass

from treestroke.codec.project import Project, check_parts
from treestroke.core.pipeline.finishing import OnGrown, unseen
from treestroke.core.progress import Report, silent
from treestroke.service.inputs import FruitLike, LeafLike, PhotoLike, SettingsLike, SketchLike, StrokesLike
from treestroke.service.making import Model
from treestroke.service.model import model
from treestroke.service.sketch import sketch


@dataclass(frozen=True, eq=False)
class Evidence:
    """Photo and strokes, perhaps with a side; or a front, perhaps with a side and a photo; and own pictures."""

    photo: PhotoLike | None = None
    strokes: StrokesLike | None = None
    front: SketchLike | None = None
    side: SketchLike | None = None
    leaf: LeafLike = None
    fruit: FruitLike = None

    @classmethod
    def of(cls, project: Project) -> "Evidence":
        """Take a project's."""
        return cls(project.photo, project.strokes, project.front, project.side, project.leaf, project.fruit)


def make_of(
    given: Evidence,
    settings: SettingsLike,
    seed: int,
    report: Report = silent,
    on_grown: OnGrown = unseen,
    name: str = "tree",
) -> Model:
    """Make a tree of whatever is given, by `model` or by `sketch`.

    Raises
    ------
    TreestrokeError
        As these two; or what is given makes no tree together.
    """
    photo, strokes, front, side = given.photo, given.strokes, given.front, given.side
    parts = {"photo": photo, "strokes": strokes, "front": front, "side": side}
    check_parts({part for part, one in parts.items() if one is not None})
    how, leaf, fruit = (settings, seed, report, on_grown), given.leaf, given.fruit
    if front is not None:
        return sketch(front, side, *how, photo=photo, leaf=leaf, fruit=fruit, name=name)
    if photo is not None and strokes is not None:
        return model(photo, strokes, *how, side=side, leaf=leaf, fruit=fruit, name=name)
    raise AssertionError("what is checked is one of these")
