"""Palms: no branches, but a crown of fronds from the top of each stem.

Fronds are measured in the photo: arcs from the stem's top that cover most of the foliage, one after another, and least
of the background (the cost E2D of Tan et al. 2008, section 3.2, with a frond's breadth). Each then leaves the picture's
plane until it is about as long as the others; its projection stays. Some that nobody sees take the measured ones'
shapes and point to the viewer and away. A frond's midrib is a limb of the skeleton; leaflets hang on it.
"""

from typing import NamedTuple

import cv2
import numpy as np

from treestroke.core.grow.branches import successors_by_wood
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.replacement import CrownToFill
from treestroke.core.skeleton.measure import path_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import limbs
from treestroke.core.types import Floats, Indices, Mask

FRONDS = 54
"""Fronds of a stem (a coconut palm bears 30, a date palm 100 and more; 40 cover 2 % less of four crowns)."""
SEEN = 0.65
"""Share of them that is measured in the photo at most; the others point to the viewer and away."""
PIECES = 12
"""Joints of a frond."""
RISES, DROOPS = (np.radians(angles) for angles in (np.arange(-80.0, 91.0, 6.0), (0.0, 25.0, 50.0, 80.0, 115.0)))
"""Angles by which a frond may rise where it leaves the stem, and bend down along its length."""
SHARES = np.array([1.1, 1.0, 0.85, 0.7, 0.55])
"""Lengths that are tried, as shares of the way from the fronds' foot to the foliage's far end."""
BREADTH = 0.06
"""Half of a frond's breadth in its middle, as a share of that way (judged on four palms)."""
HANGING = 0.07
"""How far a level frond's leaflets hang, as a share of that way."""
CELLS = 70.0
"""Cells on which fronds are measured, along the side of a square as large as the foliage."""
COVERED = 0.2
"""What a cell of the foliage is worth that a frond covers already."""
BACKGROUND = 0.5
"""What a cell of the background costs, where one of the foliage is worth 1."""
LEAST_GAIN = 0.05
"""Fronds are measured as long as they gain this share of what the first one does."""
FAR = 0.98
"""Quantile of the foliage's distances from the fronds' foot at which its far end lies."""
LONGEST = 1.1
"""Length of the longest fronds, as a share of the way to the far end: some point out of the picture's plane."""
EASED = (1.0, 0.75, 0.5, 0.25)
"""Shares of a depth or length that are tried until a frond lies in the crown."""
ASIDE = np.radians(50.0)
"""How far fronds that nobody sees point past the line of sight, to either side."""
FITTING = 0.8
"""Share of an unseen frond's joints that must lie in the crown."""
GOLDEN_SHARE = (np.sqrt(5.0) - 1) / 2
"""Its multiples spread evenly over 0 to 1, in whatever number."""
LEAST_STEM = 0.2
"""Least length of a limb that bears fronds, as a share of the longest path from a root."""
MIDRIB = (0.22, 0.02)
"""Radius of a midrib at its foot and at its tip, as a share of the stem's."""


class _Place(NamedTuple):
    """Where a stem's fronds leave it: foot (3,) and reach, metres, and the foliage (h, w) that they are to cover."""

    foot: Floats
    reach: float
    foliage: Mask


def grow_palm(skeleton: Skeleton, crown: CrownToFill, rounds: int, rng: np.random.Generator) -> Grown:
    """Set a frond a round, `FRONDS` at most, on each stem of a lifted palm (3D, metres); its own joints stay.

    A stem is every visible limb of some length. Its fronds leave it where the foliage's far end is the nearest, as all
    are about as long; what was drawn above is as thin as a midrib: the youngest frond, still folded. Radii are those
    that were measured, and taper along the midribs.
    """
    tree, born = Skeleton(skeleton.points, _known_radii(skeleton), skeleton.parents), [np.zeros(len(skeleton), int)]
    stems = _stems(tree)
    for stem, foliage in zip(stems, _foliage_of(stems, tree, crown), strict=True):
        number, reach = _foot(tree.points[stem], foliage, crown)
        fronds = _fronds(_Place(tree.points[stem[number]], reach, foliage), crown, min(rounds, FRONDS), rng)
        tree = _with_fronds(tree, stem, number, fronds)
        born.append(np.repeat(np.arange(1, len(fronds) + 1), PIECES))
    return Grown(tree, np.concatenate(born), np.zeros((0, 3), dtype=np.int64))


def is_forked(grown: Grown) -> bool:
    """Tell whether a grown palm's stems fork: true palms do not, dracaenas and yuccas do, and these bear straps.

    The joints of the stems come before all others.
    """
    tree, count = grown.skeleton, int((grown.born == 0).sum())
    stems = Skeleton(tree.points[:count], tree.radii[:count], tree.parents[:count])
    return len(_stems(stems)) > int((stems.parents < 0).sum())


def _known_radii(skeleton: Skeleton) -> Floats:
    """Return the radii (n,), metres; joints of unknown radius have their parent's, or that of the thickest joint."""
    radii = skeleton.radii.copy()
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if radii[joint] == 0:
            radii[joint] = radii[parent] if parent >= 0 else radii.max()
    return radii


def _stems(tree: Skeleton) -> list[Indices]:
    """List the limbs that bear fronds, as their joints from the foot up: all of some length."""
    arc = path_lengths(tree)
    chains = [limb for limb in limbs(tree, successors_by_wood(tree)) if len(limb) > 1]
    long = [limb for limb in chains if arc[limb[-1]] - arc[limb[0]] >= LEAST_STEM * arc.max()]
    return long or chains[:1] or [np.array([len(tree) - 1])]


def _with_fronds(tree: Skeleton, stem: Indices, number: int, fronds: Floats) -> Skeleton:
    """Join fronds (f, PIECES, 3), metres, to the joint of this number on a stem, which is a midrib above it."""
    first, count = len(tree), len(fronds)
    parents = np.arange(first - 1, first - 1 + count * PIECES).reshape(count, PIECES)
    parents[:, 0] = stem[number]
    radii, above, thick = tree.radii.copy(), stem[number + 1 :], tree.radii[stem[number]]
    radii[above] = thick * np.geomspace(*MIDRIB, len(above))
    return Skeleton(
        np.vstack([tree.points, fronds.reshape(-1, 3)]),
        np.concatenate([radii, np.tile(thick * np.geomspace(*MIDRIB, PIECES), count)]),
        np.concatenate([tree.parents, parents.ravel()]),
    )


def _foliage_of(stems: list[Indices], tree: Skeleton, crown: CrownToFill) -> list[Mask]:
    """Give each stem the part (h, w) of the front's foliage that is nearer to its tip than to the others'."""
    mask = crown.front.mask
    rows, columns = np.nonzero(mask)
    tips = crown.front.camera.pixels_from_world(tree.points[[stem[-1] for stem in stems]])
    away = [np.hypot(columns + 0.5 - x, rows + 0.5 - y) for x, y in tips]
    nearest = np.full(mask.shape, -1)
    nearest[rows, columns] = np.argmin(away, axis=0)
    return [nearest == number for number in range(len(stems))]


def _foot(stem: Floats, foliage: Mask, crown: CrownToFill) -> tuple[int, float]:
    """Find the joint of a stem (n, 3), metres, from which the foliage's far end is the nearest, and how far, metres."""
    step = max(1, int(np.sqrt(foliage.sum()) / CELLS))
    rows, columns = step * np.array(np.nonzero(foliage[::step, ::step])) + 0.5
    if len(rows) == 0:
        return len(stem) - 1, 0.0
    x, y = crown.front.camera.pixels_from_world(stem).T
    far = np.quantile(np.hypot(columns - x[:, None], rows - y[:, None]), FAR, axis=1)
    return int(far.argmin()), float(crown.front.camera.metres_from_pixels(far.min()))


def _fronds(place: _Place, crown: CrownToFill, most: int, rng: np.random.Generator) -> Floats:
    """Draw fronds (f, PIECES, 3), metres, ``most`` at most: those that the photo shows, and such as nobody sees."""
    arcs = _measured(place, crown, round(SEEN * most))
    spread = 2 * (rng.random() + GOLDEN_SHARE * np.arange(most)) % 2 - 1
    sides = np.sign(spread) * np.sqrt(np.abs(spread))
    fronds = [_deepened(place, arc, side, crown) for arc, side in zip(arcs, sides.tolist(), strict=False)]
    wide = arcs[np.argsort(-np.abs(arcs[:, -1, 0]), kind="stable")[: (len(arcs) + 1) // 2]]
    for number in range(len(arcs), most if len(arcs) else 0):
        azimuth = np.pi * (number % 2 - 0.5) + ASIDE * spread[number]
        fronds += _unseen(place, rng.permutation(wide), azimuth, crown)
    return np.array(fronds).reshape(-1, PIECES, 3)


def _measured(place: _Place, crown: CrownToFill, most: int) -> Floats:
    """Measure fronds in the photo: arcs (f, PIECES, 2), metres, right and up from their foot, the clearest first.

    Each covers most of the foliage that none covers yet, and least of the background.
    """
    camera, (arcs, strips) = crown.front.camera, _shapes()
    step = max(1.0, float(np.sqrt(place.foliage.sum())) / CELLS)
    reach = float(camera.pixels_from_metres(place.reach)) / step
    worth = _worth(place.foliage, step, border := int(reach) + 2)
    foot = camera.pixels_from_world(place.foot[None])[0] / step + border
    spots = np.floor(foot + reach * strips * np.array([1.0, -1.0])).astype(np.int32)
    cells = (spots[..., 1] * worth.shape[1] + spots[..., 0]).reshape(len(spots), -1)
    lengths, found, least = np.repeat(SHARES, len(arcs) // len(SHARES)), list[int](), 0.0
    for _ in range(most if reach > 0 else 0):
        gains = lengths * worth.ravel()[cells].mean(axis=1)
        best = int(gains.argmax())
        least = least or LEAST_GAIN * gains[best]
        if gains[best] <= least:
            break
        found.append(best)
        covered = np.zeros(worth.shape, dtype=np.uint8)
        cv2.fillPoly(covered, [np.vstack([spots[best, 0], spots[best, 2, ::-1]])], 1)
        worth[(covered > 0) & (worth > 0)] *= COVERED
    return np.asarray(place.reach * arcs[found])


def _worth(foliage: Mask, step: float, border: int) -> Floats:
    """Return what it is worth to cover each cell of ``step`` px: 1 where it shows foliage alone, -1 where none."""
    height, width = foliage.shape
    size = (max(1, round(width / step)), max(1, round(height / step)))
    share = cv2.resize(foliage.astype(np.float32), size, interpolation=cv2.INTER_AREA)
    return np.pad((1 + BACKGROUND) * share - BACKGROUND, border, constant_values=-BACKGROUND)


def _shapes() -> tuple[Floats, Floats]:
    """Draw all arcs (k, PIECES, 2) that a frond may take in the picture, and three lines (k, 3, PIECES, 2) along each.

    x right and y up, as shares of the reach, from the frond's foot at the origin; the lines are its edges and middle.
    """
    rise, droop = (axis.ravel()[:, None] for axis in np.meshgrid(RISES, DROOPS, indexing="ij"))
    along = (np.arange(PIECES) + 0.5) / PIECES
    pitch = np.maximum(rise - droop * along, -0.49 * np.pi)
    to_right = np.stack([np.cos(pitch), np.sin(pitch)], axis=-1)
    ahead = np.concatenate([to_right, to_right * np.array([-1.0, 1.0])])
    arcs = np.cumsum(ahead, axis=1) / PIECES
    width = np.sqrt(np.sin(np.pi * along))[:, None]
    aside = BREADTH * width * ahead[..., ::-1] * np.array([-1.0, 1.0])
    middle = arcs - HANGING * width * np.abs(ahead[..., :1]) * np.array([0.0, 1.0])
    lines = np.stack([middle - aside, middle, middle + aside], axis=1)
    return np.concatenate([share * arcs for share in SHARES]), np.concatenate([share * lines for share in SHARES])


def _deepened(place: _Place, arc: Floats, side: float, crown: CrownToFill) -> Floats:
    """Let a measured arc (PIECES, 2) leave the picture's plane until it is as long as others: (PIECES, 3), metres.

    ``side``, -1 to 1, says to which side, and how much of the missing length it gains.
    """
    length = float(np.sqrt((np.diff(arc, axis=0) ** 2).sum(axis=1)).sum())
    depth = side * np.sqrt(max((LONGEST * place.reach) ** 2 - length**2, 0.0))
    out = np.sin(np.pi / 2 * (np.arange(PIECES) + 0.5) / PIECES)
    for share in EASED:
        frond = place.foot + np.column_stack([arc, share * depth * out])
        if (crown.volume.reach(frond[PIECES // 2 :]) <= 1.0).all():
            return np.asarray(frond)
    return np.asarray(place.foot + np.pad(arc, ((0, 0), (0, 1))))


def _unseen(place: _Place, arcs: Floats, azimuth: float, crown: CrownToFill) -> list[Floats]:
    """Turn the first of the arcs (f, PIECES, 2) that fits to an azimuth, rad: a frond (PIECES, 3), metres, or none."""
    level, up = np.abs(arcs[..., 0]), arcs[..., 1]
    ways = np.stack([level * np.cos(azimuth), up, level * np.sin(azimuth)], axis=-1)
    fronds = place.foot + np.array(EASED)[:, None, None, None] * ways
    points = fronds.reshape(-1, 3)
    inside = crown.front.shows(points) & (crown.volume.reach(points) <= 1.0)
    fits = np.argwhere(inside.reshape(fronds.shape[:3]).mean(axis=2) >= FITTING)
    return [fronds[tuple(first)] for first in fits[:1]]
