"""Mattes of a tree in every shot, from strokes in one or a few.

Source: silhouettes and the solid that they bound, found together from colours, as by Campbell, Vogiatzis, Hernandez and
Cipolla 2007, "Automatic 3D object segmentation in multiple views using volumetric graph-cuts". We differ: strokes give
the object instead of the cameras' fixation; the shots' evidence is put together voxel by voxel without a cut, since a
crown has no surface; and what matches the neighbouring shots far behind the tree is none of it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.capture import PointCloud, Shot, TreeMatte
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.imaging.mixture import Mixture
from treestroke.core.progress import Report, silent
from treestroke.core.segment.leaf_odds import log_odds_by_height
from treestroke.core.segment.matte import matte
from treestroke.core.segment.view_mattes_colours import TreeColours, ground_colours, inner, tree_colours
from treestroke.core.segment.view_mattes_drawn import DrawnTree, drawn_tree
from treestroke.core.segment.view_mattes_parallax import far_odds, horizon
from treestroke.core.segment.view_mattes_solid import Solid, lowest_height, projected, solid_around, weighed
from treestroke.core.segment.view_mattes_trunk import StandingTrunk, around_trunk, standing_trunk, trunk_seen
from treestroke.core.segment.view_mattes_twigs import with_twigs
from treestroke.core.side_by_side import side_by_side
from treestroke.core.strokes import Strokes
from treestroke.core.types import Floats, Mask, Opacity, Picture

WORKING_SIDE = 640
"""Long side of the reduced shots in which the tree is looked for, px."""
STEEP, LEVEL = 3.0, 1.5
"""Log odds that a pixel gains for each step of evidence of the voxels behind it, and the evidence that gains nothing.
Tuned, as the other numbers here, on four rendered trees, one of them bare."""
NEVER, MOST_BY_PLACE = -8.0, 2.0
"""Log odds of a pixel where the tree cannot be, and the greatest that voxels give: there are gaps in a crown."""
HOPELESS = -2.5
"""Evidence up to which voxels are left out after the first round."""
ON_TRUNK = 2.0
"""Least log odds of a pixel on the trunk."""
ABOVE_HORIZON = 0.25
"""How far above the horizon what stands behind a tree may reach, as a share of the picture's height."""
ASIDE = 1.3
"""Distance from the root's vertical, over the tree's reach, from which on a point of the cloud is none of the tree."""
POINT_PX = 2
"""Half the size of the patch about such a point that shows no tree, px of a reduced shot."""
SOFT_PX = 0.6
"""Standard deviation, px, over which log odds are averaged before they are judged."""

SURELY, LEAST_SEEN = 2.0, 0.08
"""Log odds from which on a pixel is the drawn tree's, and the share of these that may have less than that evidence."""
FOREIGN = -4.5
"""Mean log odds by colour about a place on the trunk from which on something else is seen there."""
FURTHER_ROUNDS = 2
"""Rounds in which colours are learnt anew and the tree is found again."""
LEAST_PIECE = 1e-3
"""Least area of a piece of the tree in a shot, as a share of all."""
UNDER = 0.03
"""How far below its outline's lowest point a crown may hang, as a share of the tree's height."""
FRINGE_PX = 4
"""How far beside what was found in the reduced shot the tree may reach, px of the shot."""

_Odds = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class _View:
    """A shot reduced: its picture (h, w, 3) and camera; where (h, w) the tree may be; what strokes say, if any do.

    ``full`` (H, W, 3) is the shot's own picture. Strokes on a ``bare`` tree do not say where there is no twig.
    """

    full: Picture
    picture: Picture
    camera: PerspectiveCamera
    possible: Mask
    said: _Odds | None
    bare: bool = False


@dataclass(frozen=True, eq=False)
class _Drawn:
    """What is drawn: the tree in shots, by number, their pictures, and the height of the crown's bottom, metres."""

    trees: Mapping[int, DrawnTree]
    pictures: tuple[Picture, ...]
    bottom: float


@dataclass(frozen=True, eq=False)
class _Judged:
    """The solid by all evidence; each reduced shot's log odds (h, w) by it alone, and its pixels (h, w) of the tree."""

    solid: Solid
    places: list[_Odds]
    trees: list[Mask]


@dataclass(frozen=True, eq=False)
class _Found:
    """What is known of a reduced shot: pixels (h, w) of the tree, the trunk's, and log odds apart from its colours."""

    tree: Mask
    trunk: Mask
    odds: _Odds


def view_mattes(
    shots: Sequence[Shot], strokes: Mapping[int, Strokes], cloud: PointCloud, report: Report = silent
) -> tuple[TreeMatte, ...]:
    """Find the tree in every shot by the strokes in some of them.

    Parameters
    ----------
    shots
        All in the tree's frame: metres, Y up, the root on the ground at the origin.
    strokes
        Those of one shot at least, by its number, px of its picture: the crown's outline; the trunk's stroke in one of
        them; what an erasing stroke covers is none of the tree.
    cloud
        Points that the shots see, in their order; may be empty.
    report
        Told of the stage "mattes".

    Raises
    ------
    ValueError
        No shot is stroked, or one that is not there.
    """
    if not strokes or not all(0 <= index < len(shots) for index in strokes):
        raise ValueError(f"strokes need one of {len(shots)} shots, got {sorted(strokes)}")
    report("mattes", 0.0)
    trees = {index: drawn_tree(shots[index].picture, strokes[index]) for index in sorted(strokes)}
    report("mattes", 0.1)
    outlines, cameras = [_outline(strokes[index]) for index in trees], [shots[index].camera for index in trees]
    solid = solid_around(outlines, cameras)
    bottom = lowest_height([strokes[index].crown.points for index in trees], cameras) - UNDER * solid.points[-1, 1]
    views = side_by_side(lambda index: _view(shots[index], solid, trees.get(index)), range(len(shots)))
    drawn = _Drawn(trees, tuple(shots[index].picture for index in trees), bottom)
    found, colours, ground = _found(views, solid, drawn, cloud, report)

    def matte_of(index: int) -> TreeMatte:
        return _tree_matte(shots[index], found[index], (colours, ground), trees.get(index))

    return tuple(side_by_side(matte_of, range(len(shots)), lambda part: report("mattes", 0.6 + 0.4 * part)))


def _found(
    views: Sequence[_View], solid: Solid, drawn: _Drawn, cloud: PointCloud, report: Report
) -> tuple[list[_Found], TreeColours, Mixture]:
    """Find the tree in all reduced shots, first by colours and the solid, then by what stands far behind it, too."""
    reach, indices = solid.reach, list(drawn.trees)
    colours = tree_colours(drawn.pictures, list(drawn.trees.values()), [tree.region for tree in drawn.trees.values()])
    ground = ground_colours([view.picture for view in views], [~view.possible for view in views])
    odds = _odds(views, [view.possible for view in views], colours, ground)
    trunk = _standing(views, drawn.trees, odds)
    if trunk is not None:
        crown = solid.points[:, 1] >= drawn.bottom
        solid = solid.select(crown | around_trunk(trunk, solid.points, solid.side))
    trunks = [np.zeros_like(v.possible) if trunk is None else trunk_seen(trunk, v.camera) & v.possible for v in views]
    judged = _judged(views, solid, odds, trunks, indices)
    report("mattes", 0.3)
    asked = [_low(view, tree) for view, tree in zip(views, judged.trees, strict=True)]
    far = far_odds([view.picture for view in views], [view.camera for view in views], asked, reach)
    far = [map_ + there for map_, there in zip(far, _beside(views, cloud, reach), strict=True)]
    views = [replace(v, said=None if v.said is None else v.said + away) for v, away in zip(views, far, strict=True)]
    report("mattes", 0.5)
    for _ in range(FURTHER_ROUNDS):
        kept = [
            tree & (away > -1) & ~(stem & (by_colour < 0.5 * NEVER))
            for tree, away, stem, by_colour in zip(judged.trees, far, trunks, odds, strict=True)
        ]
        bark = [stem & (by_colour > 0.25 * NEVER) for stem, by_colour in zip(trunks, odds, strict=True)]
        colours = _carried(views, judged, drawn, (kept, bark))
        ground = ground_colours([view.picture for view in views], [~tree for tree in kept])
        odds = _odds(views, kept, colours, ground)
        odds = [by_colour + away for by_colour, away in zip(odds, far, strict=True)]
        judged = _judged(views, judged.solid.select(judged.solid.odds > HOPELESS), odds, trunks, indices)
    parts = zip(judged.trees, trunks, far, judged.places, strict=True)
    return [_Found(_attached(tree), stem, away + place) for tree, stem, away, place in parts], colours, ground


def _carried(
    views: Sequence[_View], judged: _Judged, drawn: _Drawn, seen: tuple[Sequence[Mask], Sequence[Mask]]
) -> TreeColours:
    """Fit the tree's colours anew, to what the other reduced shots show of its crown and trunk (h, w), too."""
    believed, crowns, stems = [], [], []
    for index, (view, place, tree, stem) in enumerate(zip(views, judged.places, *seen, strict=True)):
        if index in drawn.trees:
            size = drawn.trees[index].alpha.shape[::-1]
            believed.append(cv2.resize(tree.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST) > 0)
        else:
            crowns.append(view.picture[inner(tree) & (place >= MOST_BY_PLACE) & ~stem])
            stems.append(view.picture[inner(tree & stem)])
    return tree_colours(drawn.pictures, list(drawn.trees.values()), believed, (crowns, stems))


def _attached(tree: Mask) -> Mask:
    """Return a mask (h, w) without pieces that are far too small for a part of the tree."""
    _, labels, figures, _ = cv2.connectedComponentsWithStats(tree.astype(np.uint8), connectivity=8)
    large = figures[:, cv2.CC_STAT_AREA] >= LEAST_PIECE * tree.sum()
    large[0] = False
    return np.asarray(large[labels])


def _odds(views: Sequence[_View], trees: Sequence[Mask], colours: TreeColours, ground: Mixture) -> list[_Odds]:
    """Log odds (h, w) of tree in each reduced shot, by colours, given about where (h, w) it is.

    Twigs of a bare tree are thinner than a reduced shot's pixels: there the likeliest pixel of the shot counts.
    """
    tree = colours.tree

    def odds(seen: tuple[_View, Mask]) -> _Odds:
        view, near = seen
        if colours.leaf is not None:
            return log_odds_by_height(tree, ground, view.picture, near)
        height, width = view.full.shape[:2]
        there = cv2.resize(near.astype(np.uint8), (width, height), interpolation=cv2.INTER_NEAREST) > 0
        fine = log_odds_by_height(tree, ground, view.full, there)
        side = max(1, round(width / near.shape[1]))
        likeliest = cv2.dilate(fine, np.ones((side, side), np.uint8))
        return cv2.resize(likeliest, near.shape[::-1], interpolation=cv2.INTER_NEAREST).astype(np.float32)

    return side_by_side(odds, list(zip(views, trees, strict=True)))


def _judged(
    views: Sequence[_View], solid: Solid, odds: Sequence[_Odds], trunks: Sequence[Mask], drawn: Sequence[int]
) -> _Judged:
    """Judge the solid by all reduced shots' log odds (h, w), and each shot's pixels by both."""
    evidence = []
    for view, by_colour, trunk in zip(views, odds, trunks, strict=True):
        whole = np.where(trunk, np.maximum(by_colour, ON_TRUNK), by_colour)
        if view.said is not None:
            whole = np.maximum(view.said, whole) if view.bare else view.said
        evidence.append(np.where(view.possible, whole, NEVER).astype(np.float32))
    solid = weighed(solid, [view.camera for view in views], evidence, drawn)
    behind = side_by_side(lambda view: projected(solid, view.camera, view.possible.shape), views)
    level = _level(views, behind)
    places = [_by_place(view, there, level) for view, there in zip(views, behind, strict=True)]
    trees = [
        np.asarray(cv2.GaussianBlur(whole + place, (0, 0), SOFT_PX) > 0)
        for whole, place in zip(evidence, places, strict=True)
    ]
    return _Judged(solid, places, trees)


def _level(views: Sequence[_View], behind: Sequence[_Odds]) -> float:
    """Return the evidence of voxels that speaks neither for nor against: less, where the drawn tree itself has less.

    So a tree too thin for its cameras' errors is not lost.
    """
    drawn = [there[view.said > SURELY] for view, there in zip(views, behind, strict=True) if view.said is not None]
    known = np.concatenate(drawn)
    return min(LEVEL, float(np.quantile(known, LEAST_SEEN))) if len(known) else LEVEL


def _by_place(view: _View, behind: _Odds, level: float) -> _Odds:
    """Log odds (h, w) of tree in a reduced shot by the evidence (h, w) of the voxels behind each pixel."""
    odds = np.clip(STEEP * (behind - level), NEVER, MOST_BY_PLACE)
    return np.where(view.possible, odds, NEVER).astype(np.float32)


def _standing(views: Sequence[_View], trees: Mapping[int, DrawnTree], odds: Sequence[_Odds]) -> StandingTrunk | None:
    """Place the trunk below the crown by its stroke and the other reduced shots; None where none was drawn."""
    others = [index for index in range(len(views)) if index not in trees]
    for index, tree in trees.items():
        view = views[index]
        stem = cv2.resize(tree.stem.astype(np.uint8), view.possible.shape[::-1], interpolation=cv2.INTER_AREA) > 0
        cameras, evidence = [views[other].camera for other in others], [odds[other] for other in others]
        standing = standing_trunk(stem, view.camera, cameras, evidence)
        if standing is not None:
            return standing
    return None


def _low(view: _View, tree: Mask) -> Mask:
    """Where (h, w) a tree found in a reduced shot may be something behind it: low in the picture."""
    rows = np.arange(len(tree))[:, None]
    return np.asarray(tree & (rows > horizon(view.camera) - ABOVE_HORIZON * len(tree)))


def _beside(views: Sequence[_View], cloud: PointCloud, reach: float) -> list[_Odds]:
    """Log odds (h, w) of tree in each reduced shot by the points of the cloud that are beside the tree."""
    away = np.hypot(cloud.points[:, 0], cloud.points[:, 2]) > ASIDE * reach
    maps = []
    for index, view in enumerate(views):
        odds = np.zeros(view.possible.shape, dtype=np.float32)
        x, y = np.floor(view.camera.pixels_from_world(cloud.points[away & cloud.seen[:, index]])).astype(np.int64).T
        inside = (x >= 0) & (x < view.camera.width) & (y >= 0) & (y < view.camera.height)
        odds[y[inside], x[inside]] = 0.5 * NEVER
        maps.append(np.asarray(cv2.erode(odds, np.ones((2 * POINT_PX + 1,) * 2, np.uint8)), dtype=np.float32))
    return maps


def _tree_matte(shot: Shot, found: _Found, models: tuple[TreeColours, Mixture], drawn: DrawnTree | None) -> TreeMatte:
    """Return the matte of a shot at its full size."""
    colours, ground = models
    size = shot.camera.width, shot.camera.height
    odds = cv2.resize(found.odds, size, interpolation=cv2.INTER_LINEAR)
    trunk = cv2.resize(found.trunk.astype(np.float32), size, interpolation=cv2.INTER_LINEAR) > 0.5
    near = cv2.resize(found.tree.astype(np.float32), size, interpolation=cv2.INTER_LINEAR)
    region = (cv2.dilate(near, np.ones((2 * FRINGE_PX + 1,) * 2, np.uint8)) > 0.5) & (odds > 0.5 * NEVER)
    hidden = np.zeros(region.shape, dtype=np.bool_)
    if drawn is None or drawn.bare:
        by_colour = log_odds_by_height(colours.tree, ground, shot.picture, near > 0.5)
        whole = np.where(trunk, np.maximum(odds + by_colour, ON_TRUNK), odds + by_colour)
        hidden = _hidden(trunk, by_colour)
        opacity = np.where(hidden, 0, matte(shot.picture, _likely(whole), region)).astype(np.float32)
        if colours.leaf is None:
            opacity = with_twigs(shot.picture, opacity)
    else:
        opacity = drawn.alpha * region
    wood = np.where(trunk, 1.0, colours.wood_share(shot.picture)) * (opacity > 0)
    return TreeMatte(opacity, wood.astype(np.float32), hidden)


def _hidden(trunk: Mask, by_colour: _Odds) -> Mask:
    """Where (h, w) a trunk's place has the colours of something else all across: that stands before it."""
    across = int(np.median(trunk.sum(axis=1)[trunk.any(axis=1)])) if trunk.any() else 0
    size = (2 * across + 1, 2 * across + 1)
    share = cv2.blur(trunk.astype(np.float32), size)
    odds = cv2.blur(np.clip(by_colour, NEVER, -NEVER) * trunk, size) / np.maximum(share, 1e-6)
    return np.asarray(trunk & (odds < FOREIGN))


def _likely(odds: NDArray[np.floating]) -> Opacity:
    """Turn log odds (h, w) into probabilities."""
    return np.asarray(1 / (1 + np.exp(-odds)), dtype=np.float32)


def _view(shot: Shot, solid: Solid, tree: DrawnTree | None) -> _View:
    """Reduce a shot and what is drawn on it."""
    height, width = shot.picture.shape[:2]
    factor = min(1.0, WORKING_SIDE / max(height, width))
    size = max(1, round(width * factor)), max(1, round(height * factor))
    picture = np.asarray(cv2.resize(shot.picture, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    camera = shot.camera.resized(*size)
    possible = projected(solid, camera, size[::-1]) > -1
    if tree is None:
        return _View(shot.picture, picture, camera, possible, None)
    possible &= cv2.resize(tree.region.astype(np.float32), size, interpolation=cv2.INTER_AREA) > 0.5
    alpha = cv2.resize(tree.alpha, size, interpolation=cv2.INTER_AREA)
    return _View(shot.picture, picture, camera, possible, (-NEVER * (alpha - 0.4)).astype(np.float32), tree.bare)


def _outline(strokes: Strokes) -> Floats:
    """Return points (n, 2), px, that hold the tree: the crown's outline, and the trunk's stroke."""
    return np.concatenate([strokes.crown.points, *(branch.points for branch in strokes.branches[:1])])
