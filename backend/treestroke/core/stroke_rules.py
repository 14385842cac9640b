"""Rules that strokes must keep to describe a tree, and how small faults are mended."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from treestroke.core.errors import StrokesError
from treestroke.core.geometry.polyline import arc_lengths, place_at, resample
from treestroke.core.imaging.outline import filled_and_crossing
from treestroke.core.strokes import Length, MendedStrokes, Stroke, Strokes, StrokeWarning
from treestroke.core.types import Floats
from treestroke.limits import MAX_POINTS, MAX_STROKES

MIN_CROWN_SHARE = 0.005
"""Smallest crown, as a share of the photo's area."""
CHECKED_SIDE = 1500
"""Long side, px, of the raster in which strokes are checked, whatever the photo's size."""
TOUCH_SHARE = 0.02
"""Strokes this near, as a share of the photo's long side, count as touching."""
TREE_HEIGHTS = (0.1, 150.0)
"""Least and greatest height of a tree, metres."""
STEM_SHARE = 0.03
"""A later stroke that starts this near the root, as a share of the tree's height, is a second stem."""
GROUND_SHARE = 0.04
"""A later stroke that starts no further above the root's level than this share of the tree's height starts at the
ground; if it touches no other, it is a stem with a root of its own."""
LEAST_RISE, RISE_OF_ALL = 0.4, 0.15
"""Least rise of a trunk, as shares of the furthest it goes from its root on the way to its highest point (on 28 photos:
0.89 and more; 24 degrees from level), and of the furthest it goes at all: a cascade rises before it hangs. A stroke
below either is level, or was drawn on a photo that was turned since."""
FOOT = 0.15
"""Greatest height above the crown's bottom, as a share of the crown's, at which a trunk that is drawn down may end."""
MOST_OUTSIDE, LOOSE, OUTSIDE_PLACES = 0.15, 0.05, 500
"""Largest share of a stroke that may lie further outside the photo than `LOOSE` of its long side, judged at
`OUTSIDE_PLACES` places; a stroke around a tree that the edge cuts stays nearer."""
Place = tuple[str | int, ...]
"""Keys that lead from the strokes as a whole to one of their parts."""
NO_TRUNK = "there is no trunk stroke; draw one from the tree's root up its trunk"
CROSSING = StrokeWarning("crown_crosses_itself", "crown", "the crown crosses itself; all that it encloses was taken")


def mend_strokes(strokes: Strokes, width: int, height: int) -> MendedStrokes:
    """Return strokes that were checked against a photo of the given size, px, and mended where possible.

    Points are clamped to the photo, and of those that a branch has below its lower edge the last one stays; a later
    branch that starts away from every earlier one is joined to the nearest of them by one more point at its start, with
    a warning; a trunk drawn from its top down to the root is turned, with a warning; a further stem starts on the
    ground; a crown that crosses itself is kept (fill it with `fill_outline`), with a warning.

    Raises
    ------
    StrokesError
        Too many strokes or points, a value that is not finite, too few distinct points, a crown that is too small,
        a trunk that does not rise or neither touches nor points into the crown, or a known length that makes no tree of
        it. The message names the stroke.
    """
    check_count(1 + len(strokes.branches) + len(strokes.erase))
    scale = None if strokes.scale is None else _known_length(strokes.scale, width, height)
    inside = Strokes(
        crown=clamped(strokes.crown, ("crown",), (width, height), 3),
        branches=tuple(clamped(s, ("branches", i), (width, height), 2) for i, s in enumerate(strokes.branches)),
        erase=tuple(clamped(s, ("erase", i), (width, height), 2) for i, s in enumerate(strokes.erase)),
        scale=scale,
    )
    coarse = min(1.0, CHECKED_SIDE / max(width, height))
    size = max(1, round(height * coarse)), max(1, round(width * coarse))
    crown, crossing = filled_and_crossing(inside.crown.points * coarse, *size)
    check_crown(crown)
    warnings = ((CROSSING,) if crossing else ()) + _outside(strokes, width, height)
    if not inside.branches:
        return MendedStrokes(inside, warnings)
    inside, turned = _upward(inside)
    inside = replace(inside, branches=tuple(_from_lower_edge(branch, height) for branch in inside.branches))
    _check_trunk(inside, crown, coarse, max(width, height))
    _check_rise(inside.branches[0])
    _check_scale(inside)
    branches, joined = _join_branches(inside, TOUCH_SHARE * max(width, height))
    return MendedStrokes(replace(inside, branches=branches), warnings + turned + joined)


def _outside(strokes: Strokes, width: int, height: int) -> tuple[StrokeWarning, ...]:
    """Return a warning for crown and trunk where much of it lies outside the photo: it may belong to another one."""
    drawn = [("crown", strokes.crown), *(("branches/0", trunk) for trunk in strokes.branches[:1])]
    turned = bool((np.vstack([stroke.points for _, stroke in drawn]) <= (height, width)).all())
    how = "it would fit the photo as it was before it was turned upright" if turned else "it may be another photo's"
    warnings = []
    for place, stroke in drawn:
        share = _share_outside(stroke.points, width, height)
        if share > MOST_OUTSIDE:
            problem = f"{share:.0%} of it lies well outside the photo and was moved to its edge"
            detail = f"{problem}; {how}: draw it on this one, as it stands upright"
            warnings.append(StrokeWarning("outside_photo", place, detail))
    return tuple(warnings)


def _share_outside(points: Floats, width: int, height: int) -> float:
    """Return the share of a line (n, 2), px, that lies further than `LOOSE` outside the photo.

    Points are first clipped to one long side beyond the photo, so that a single stray point decides nothing.
    """
    side = float(max(width, height))
    near = np.clip(np.asarray(points, dtype=np.float64), -side, 2 * side)
    places = place_at(near, np.linspace(0.0, arc_lengths(near)[-1], OUTSIDE_PLACES))
    beyond = np.abs(places - np.clip(places, 0.0, (width, height))).max(axis=1)
    return float((beyond > LOOSE * side).mean())


def _upward(strokes: Strokes) -> tuple[Strokes, tuple[StrokeWarning, ...]]:
    """Return the strokes with the trunk from its root up, and a warning where it was drawn from its top down.

    It was drawn so if it runs from the crown down to its foot or below, and leaves it further there than at its top:
    the strokes of a photo that stands on its head are left as they are.
    """
    trunk, rest = strokes.branches[0], strokes.branches[1:]
    crown = strokes.crown.points[:, 1]
    top, bottom = float(crown.min()), float(crown.max())
    above, below = top - trunk.points[0, 1], trunk.points[-1, 1] - bottom
    runs_down = above > top - bottom and below > max(above, FOOT * (top - bottom))
    turned = replace(trunk, points=trunk.points[::-1])
    if not runs_down or _rises(trunk) or not _rises(turned):
        return strokes, ()
    detail = "the trunk was drawn from its top down, and was turned; draw it from the root up"
    return replace(strokes, branches=(turned, *rest)), (StrokeWarning("stroke_turned", "branches/0", detail),)


def _from_lower_edge(branch: Stroke, height: int) -> Stroke:
    """Return a branch stroke that was begun below the photo's lower edge from where it comes into the photo.

    Clamped to the edge, what lies below it would be a level run of wood.
    """
    outside = int(np.logical_and.accumulate(branch.points[:, 1] >= height).sum())
    return replace(branch, points=branch.points[min(max(outside - 1, 0), len(branch.points) - 2) :])


def _rises(trunk: Stroke) -> bool:
    """Return whether a trunk rises above its first point; it may lean, arch and hang."""
    way = trunk.points - trunk.points[0]
    away, highest = np.hypot(*way.T), int(way[:, 1].argmin())
    least = max(LEAST_RISE * float(away[: highest + 1].max()), RISE_OF_ALL * float(away.max()))
    return -float(way[highest, 1]) >= least


def _check_rise(trunk: Stroke) -> None:
    """Raise where a trunk lies level or runs down: the tree would grow in the air."""
    if not _rises(trunk):
        problem = "the trunk lies level or runs down from its first point, the root"
        mend = "draw it from the ground up; if the tree lies on its side in the photo, turn the photo first"
        raise StrokesError.at(("branches", 0), f"{problem}; {mend}", "trunk_level")


def require_trunk(strokes: Strokes) -> None:
    """Raise where there is no branch stroke: such strokes can be traced but not modelled.

    Raises
    ------
    StrokesError
        There is no branch stroke.
    """
    if not strokes.branches:
        raise StrokesError.at(("branches",), NO_TRUNK, "trunk_missing")


def check_count(count: int) -> None:
    """Raise where there are too many strokes.

    Raises
    ------
    StrokesError
        There are more than `MAX_STROKES`.
    """
    if count > MAX_STROKES:
        problem = f"there are {count}, at most {MAX_STROKES} are allowed; leave some out"
        raise StrokesError.at((), problem, "too_many_strokes")


def clamped(stroke: Stroke, place: Place, size: tuple[int, int], least: int, ground: str = "photo") -> Stroke:
    """Return one stroke, checked by itself, with its points (n, 2), px, clamped to the ``ground`` it is drawn on.

    ``size`` is the ground's width and height, px.

    Raises
    ------
    StrokesError
        A value that is not finite, too many points, fewer than ``least`` distinct ones, or a width that is not
        above 0; the message names the ``place``.
    """
    points = np.asarray(stroke.points, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 2:
        raise StrokesError.at(place, "points must be pairs of x and y; give [[x, y], ...]", "wrong_type")
    if len(points) > MAX_POINTS:
        problem = f"it has {len(points)} points, at most {MAX_POINTS} are allowed; draw it with fewer"
        raise StrokesError.at(place, problem, "too_many_points")
    if not np.isfinite(points).all():
        problem = f"a coordinate is not a finite number; give pixels of the {ground}"
        raise StrokesError.at(place, problem, "non_finite_number")
    if stroke.width is not None and not (np.isfinite(stroke.width) and stroke.width > 0):
        problem = f"width is {stroke.width}; give pixels above 0 or leave it out"
        raise StrokesError.at(place, problem, "width_invalid", key="width")
    points = np.clip(points, 0.0, np.asarray(size, dtype=np.float64))
    distinct = len(set(map(tuple, points.tolist())))  # np.unique by rows costs 30 ms at its first call
    if distinct < least:
        held = f"it has {distinct} distinct point{'s' * (distinct != 1)} inside the {ground}"
        raise StrokesError.at(place, f"{held}, at least {least} are needed; draw it longer", "stroke_too_short")
    return Stroke(points, stroke.width)


def _known_length(scale: Length, width: int, height: int) -> Length:
    """Return a known length, checked by itself, with its ends (2, 2), px, clamped to the photo."""
    if len(scale.points) != 2:
        problem = f"it has {len(scale.points)} points, it needs 2; draw a straight line"
        raise StrokesError.at(("scale",), problem, "scale_invalid", key="points")
    ends = clamped(Stroke(scale.points), ("scale",), (width, height), 2).points
    if not (np.isfinite(scale.metres) and scale.metres > 0):
        problem = f"{scale.metres} metres is not a length; give metres above 0"
        raise StrokesError.at(("scale",), problem, "scale_invalid", key="metres")
    return Length(ends, float(scale.metres))


def _check_scale(strokes: Strokes) -> None:
    """Raise where the known length makes the tree higher or lower than `TREE_HEIGHTS` allow."""
    if strokes.scale is None:
        return
    height_px = strokes.branches[0].points[0, 1] - strokes.crown.points[:, 1].min()
    height_m = height_px * strokes.scale.metres / float(np.hypot(*np.diff(strokes.scale.points, axis=0)[0]))
    if not TREE_HEIGHTS[0] <= height_m <= TREE_HEIGHTS[1]:
        problem = f"by it the tree is {height_m:.3g} m high, not {TREE_HEIGHTS[0]:g} to {TREE_HEIGHTS[1]:g} m"
        raise StrokesError.at(("scale",), f"{problem}; check its metres and its ends", "scale_unlikely")


def check_crown(crown: NDArray[np.bool_], ground: str = "photo") -> None:
    """Raise where a crown, the mask (h, w), is too small for the ``ground`` it is drawn on.

    Raises
    ------
    StrokesError
        It is smaller than `MIN_CROWN_SHARE`.
    """
    share = np.count_nonzero(crown) / crown.size
    if share < MIN_CROWN_SHARE:
        held = f"it encloses {share:.2%} of the {ground}, at least {MIN_CROWN_SHARE:.1%} is needed"
        raise StrokesError.at(("crown",), f"{held}; draw it around the whole foliage", "crown_too_small")


def _check_trunk(strokes: Strokes, crown: NDArray[np.bool_], coarse: float, side: int) -> None:
    """Raise where the trunk neither touches the crown, within `TOUCH_SHARE`, nor points into it.

    The crown's mask (h, w) is ``coarse`` times as large as the photo, whose long side is ``side`` px.
    """
    height, width = crown.shape
    drawn = resample(strokes.branches[0].points, 1.0 / coarse)
    way = np.vstack([drawn, _ray(drawn, 1.0 / coarse, 1.5 * side)])
    column, row = np.floor(way * coarse).astype(np.int64).T
    seen = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    if crown[row[seen], column[seen]].any():
        return
    outline = np.vstack([strokes.crown.points, strokes.crown.points[:1]])
    if _nearest(outline, drawn)[1].min() > TOUCH_SHARE * side:
        problem = "the trunk neither touches nor points into the crown; draw it from the root up to the foliage"
        raise StrokesError.at(("branches", 0), problem, "trunk_outside_crown")


def _join_branches(strokes: Strokes, reach: float) -> tuple[tuple[Stroke, ...], tuple[StrokeWarning, ...]]:
    root = strokes.branches[0].points[0]
    height = abs(float(root[1] - strokes.crown.points[:, 1].min()))
    branches, warnings = [strokes.branches[0]], []
    for index, stroke in enumerate(strokes.branches[1:], start=1):
        start = stroke.points[:1]
        found = [_nearest(earlier.points, start) for earlier in branches]
        parent = int(np.argmin([gap[0] for _, gap in found]))
        joint, gap = found[parent][0][0], float(found[parent][1][0])
        if is_stem(stroke, branches, height, reach):
            stroke = _on_the_ground(stroke, float(root[1]))
        elif gap > reach:
            stroke = replace(stroke, points=np.vstack([joint, stroke.points]))
            detail = f"it starts {gap:.0f} px from every earlier branch and was joined to branches/{parent}"
            warnings.append(StrokeWarning("branch_joined", f"branches/{index}", detail))
        branches.append(stroke)
    return tuple(branches), tuple(warnings)


def is_stem(stroke: Stroke, earlier: Sequence[Stroke], height: float, reach: float) -> bool:
    """Return whether a stroke stands on the ground by itself, and does not leave one of those before it (px).

    The first does; so does one that starts beside the first one's root, or at the ground and further than ``reach``
    from all that is drawn. ``height`` is the tree's.
    """
    if not earlier:
        return True
    start, root = stroke.points[:1], earlier[0].points[0]
    if np.hypot(*(start[0] - root)) <= STEM_SHARE * height:
        return True
    at_ground = start[0, 1] >= root[1] - GROUND_SHARE * height
    return bool(at_ground and min(float(_nearest(other.points, start)[1][0]) for other in earlier) > reach)


def _on_the_ground(stem: Stroke, ground: float) -> Stroke:
    """Return a second stem that starts on the ground, px: one that starts higher gets a point straight below."""
    x, y = stem.points[0]
    return stem if y >= ground else replace(stem, points=np.vstack([[x, ground], stem.points]))


def _nearest(line: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Return the nearest places (m, 2) on a polyline (n, 2) to points (m, 2), and their distances (m,), all px."""
    start, along = line[:-1], np.diff(line, axis=0)
    square = np.maximum((along**2).sum(axis=1), 1e-12)
    nearest, gaps = np.empty_like(points), np.empty(len(points))
    for index, point in enumerate(points):
        share = np.clip(((point - start) * along).sum(axis=1) / square, 0.0, 1.0)
        place = start + share[:, None] * along
        gap = np.hypot(*(place - point).T)
        best = int(gap.argmin())
        nearest[index], gaps[index] = place[best], gap[best]
    return nearest, gaps


def _ray(drawn: Floats, step: float, reach: float) -> Floats:
    """Return points (m, 2), px, that continue a resampled line (n, 2) in the direction of its last fifth.

    A single jittery point at the end thus decides little.
    """
    tail = drawn[-1] - drawn[len(drawn) - 1 - max(1, len(drawn) // 5)]
    if not tail.any():
        tail = drawn[-1] - drawn[0]
    norm = max(float(np.hypot(*tail)), 1e-9)
    return np.asarray(drawn[-1] + np.arange(0.0, reach, step)[:, None] / norm * tail)
