"""The strokes over the photos of a capture: checked against the photos, and mended where possible."""

from collections.abc import Collection, Mapping
from dataclasses import replace

from treestroke.core.errors import StrokesError
from treestroke.core.stroke_rules import NO_TRUNK, mend_strokes
from treestroke.core.strokes import CameraDistance, CaptureStrokes, LengthInPhoto

_SHOWN = 5
"""Most photos that a message names."""


def mend_views(drawn: CaptureStrokes, sizes_px: Mapping[str, tuple[int, int]]) -> CaptureStrokes:
    """Check strokes against the (width, height) of each upright photo, px, by name, and mend them where possible.

    Raises
    ------
    StrokesError
        As `mend_strokes`; or there is no such photo, no trunk, or a distance of a photo from itself.
    """
    for place, name in [*_drawn_over(drawn), *_named_by(drawn.scale)]:
        if name not in sizes_px:
            fault = f"there is no photo {name}; the photos are {', '.join(sorted(sizes_px)[:_SHOWN])}"
            raise StrokesError.at(place, fault, "photo_unknown")
    mended = {}
    for index, (name, strokes) in enumerate(drawn.by_photo.items()):
        try:
            mended[name] = mend_strokes(strokes, *sizes_px[name]).strokes
        except StrokesError as error:
            raise type(error)(f"{name}: {error}", code=error.code, pointer=f"/views/{index}{error.pointer}") from error
    found = replace(drawn, by_photo=mended)
    if not mended[found.first].branches:
        raise StrokesError.at(("views", 0, "branches"), NO_TRUNK, "trunk_missing")
    if isinstance(drawn.scale, CameraDistance) and len(set(drawn.scale.photos)) < 2:
        fault = f"{drawn.scale.photos[0]} is named twice; name the two photos between which you measured"
        raise StrokesError.at(("scale", "photos"), fault, "scale_invalid")
    return found


def check_used(drawn: CaptureStrokes, used: Collection[str]) -> None:
    """Check that the tree's front, and the photos that the scale names, are among those that are ``used``.

    Raises
    ------
    StrokesError
        One of them is not.
    """
    for place, name in [*_drawn_over(drawn), *_named_by(drawn.scale)]:
        if name not in used and (place[0] == "scale" or name == drawn.first):
            fault = f"no camera was found for {name}; draw on a photo that is used, such as {min(used)}"
            raise StrokesError.at(place, fault, "photo_not_used")


def _drawn_over(drawn: CaptureStrokes) -> list[tuple[tuple[str | int, ...], str]]:
    """Return the photos that were drawn over, each with the place that names it."""
    return [(("views", index, "photo"), name) for index, name in enumerate(drawn.by_photo)]


def _named_by(scale: LengthInPhoto | CameraDistance | None) -> list[tuple[tuple[str | int, ...], str]]:
    """Return the photos that a scale names, each with the place that names it."""
    if scale is None:
        return []
    if isinstance(scale, LengthInPhoto):
        return [(("scale", "photo"), scale.photo)]
    return [(("scale", "photos", index), name) for index, name in enumerate(scale.photos)]
