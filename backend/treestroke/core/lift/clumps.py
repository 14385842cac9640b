"""Sets clumps of foliage in a crown: those that its front and its imagined side show, and more behind them.

Each picture's silhouette is a sum of discs. Each disc stands for a ball of foliage, at a depth at which the other
picture has room for it; those on one limb stand together. Balls like those of the front, behind the stem, close the
crown as much as it is closed in front.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from treestroke.core.geometry.clumped_crown import ClumpedCrown
from treestroke.core.imaging.discs import cover_with_discs
from treestroke.core.lift.imagined import ImaginedCrown
from treestroke.core.types import Floats, Indices, Mask

LARGEST, SMALLEST = 0.12, 1.2
"""Radius of the largest clumps, as a share of the crown's size, and of the smallest, in cells."""
AT_OUTLINE = 0.7
"""Clumps that reach this share of their section's radius are at the outline."""
SUNK = 0.8
"""Share of its radius that a clump lies under the crown's surface."""
RELIEF, SEEN_THROUGH = 0.4, 8.0
"""Share of the crown's half depth over which the clumps of its front are spread, and how much more for each unit of the
front's openness: through an open crown its back is seen."""
LIMBS, JITTER = 14, 0.1
"""Limbs that are imagined to carry the clumps, and standard deviation of a clump's place about its limb's, as a share
of the crown's depth there."""
ON_LIMB = 4.0
"""How far beside a limb that is seen, cells, a clump still hangs on it."""
CORE = 0.45
"""Share of the sections' radius within which foliage stands anywhere."""
COPIES = 4
"""Places behind the stem that are tried for each clump of the front."""
BAY = 0.15
"""Width of the gaps, as a share of the crown's height, that count for a crown's openness."""
CLOSE = 0.25
"""Least distance between clumps, over the sum of their radii."""
AT_ONCE = 12
"""Clumps that are added before the crown's openness is measured again."""
OPENER = 1.2
"""Openness of the clumps from the sides over that of the front: no leaf reaches beyond the front, but leaves at the
sides reach beyond their clumps."""
VIEWS_RAD = np.radians([45.0, 90.0, 135.0])
"""Sides from which it is measured."""


def in_clumps(crown: ImaginedCrown, limbs_px: Floats, rng: np.random.Generator) -> ClumpedCrown:
    """Return the volume of a crown whose foliage stands in clumps.

    ``limbs_px`` (n, 3) are places on limbs that are seen, in the front camera's picture space, px.

    Source: the medial axis, Blum 1967; best-candidate sampling, Mitchell 1991.
    """
    seen = _seen_clumps(crown, crown.cells_from_picture_space(limbs_px), rng)
    beside = _side_clumps(crown, rng)
    shown = np.vstack([seen, beside])
    return crown.filled(_filled(crown, np.vstack([shown, _further_clumps(crown, seen, shown, rng)])))


def _seen_clumps(crown: ImaginedCrown, limbs: Floats, rng: np.random.Generator) -> Floats:
    """Return the clumps that the front shows: (n, 4) x, y, z and radius, cells; ``limbs`` (m, 3) in cells.

    Those at the outline stand anywhere from front to back, the others toward the viewer; in an open crown, and at the
    outline, they stand on a limb where one is seen.
    """
    discs = _discs(crown.front)
    clumps = np.insert(discs, 2, 0.0, axis=1)
    relief = min(2.0, RELIEF + SEEN_THROUGH * _openness(crown.front))
    share, outer = _by_limbs(discs, rng), _reach(crown, clumps) >= AT_OUTLINE
    share = np.where(outer, share, 1 - relief / 2 * share)
    room = _depths_for(crown, discs)
    clumps[:, 2] = room.at_share(share) - crown.furthest
    if len(limbs) == 0 or len(discs) == 0:
        return clumps
    away = np.hypot(*(discs[:, None, :2] - limbs[:, :2]).transpose(2, 0, 1))
    nearest = away.argmin(axis=1)
    hangs = (away.min(axis=1) <= discs[:, 2] + ON_LIMB) & (outer | (rng.random(len(discs)) < relief / 2))
    on_limb = room.nearest(limbs[nearest, 2] + crown.furthest) - crown.furthest
    clumps[hangs, 2] = on_limb[hangs]
    return clumps


def _side_clumps(crown: ImaginedCrown, rng: np.random.Generator) -> Floats:
    """Return the clumps (n, 4) that the side shows, anywhere from left to right."""
    discs = _discs(crown.side)
    row = crown.rows(discs[:, 1])
    out = (discs[:, 0] - crown.furthest - crown.near[row]) / crown.deep[row]
    room = _Room(crown.front, row, discs[:, 2], _Span(crown.middle[row], _half_chord(crown.radius[row], out)))
    x = room.at_share(_by_limbs(discs, rng))
    return np.column_stack([x, discs[:, 1], discs[:, 0] - crown.furthest, discs[:, 2]])


def _discs(silhouette: Mask) -> Floats:
    """Cover a silhouette (h, w) with discs: (n, 3) x, y and radius, cells."""
    return cover_with_discs(silhouette, SMALLEST, LARGEST * float(np.sqrt(silhouette.sum())))


def _by_limbs(discs: Floats, rng: np.random.Generator) -> Floats:
    """Return shares (n,), 0 to 1, at random for discs (n, 3): alike for those that the same limb may carry.

    Limbs end at discs that are far from each other, and each disc is on the nearest.
    """
    if len(discs) == 0:
        return np.zeros(0)
    end, away, limb = int(rng.integers(len(discs))), np.full(len(discs), np.inf), np.zeros(len(discs), dtype=np.int64)
    for number in range(LIMBS):
        from_end = np.hypot(*(discs[:, :2] - discs[end, :2]).T)
        limb[from_end < away] = number
        away = np.minimum(away, from_end)
        end = int(away.argmax())
    share = (rng.permutation(LIMBS) + rng.random(LIMBS)) / LIMBS
    return np.clip(share[limb] + rng.normal(0, JITTER, len(discs)), 0, 1)


@dataclass(frozen=True, eq=False)
class _Span:
    """Middles and half lengths (n,) of parts of rows, cells."""

    middle: Floats
    half: Floats


def _half_chord(half_axis: Floats, out: Floats) -> Floats:
    """Half the chord (n,) of an ellipse at a place so far out (n,), as a share of the way, on its other axis."""
    return half_axis * np.sqrt(np.maximum(1 - out**2, 0.0))


def _depths_for(crown: ImaginedCrown, discs: Floats) -> "_Room":
    """Find where the side has room for the front's discs (n, 3), within the crown's sections."""
    row = crown.rows(discs[:, 1])
    out = (discs[:, 0] - crown.middle[row]) / crown.radius[row]
    span = _Span(crown.near[row] + crown.furthest, _half_chord(crown.deep[row], out))
    return _Room(crown.side, row, discs[:, 2], span)


class _Room:
    """Where a silhouette has room for clumps, along a span of a row each."""

    def __init__(self, silhouette: Mask, rows: Indices, radii: Floats, span: _Span) -> None:
        away = cv2.distanceTransform(np.pad(silhouette.astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1][rows]
        beyond = np.abs(np.arange(silhouette.shape[1]) + 0.5 - span.middle[:, None]) - span.half[:, None]
        away = np.where(silhouette[rows], away - np.maximum(beyond, 0.0), -np.inf)
        self._fits = away >= np.minimum(SUNK * radii, away.max(axis=1))[:, None]

    def at_share(self, share: Floats) -> Floats:
        """Return the places (n,) that have these shares (n,), 0 to 1, of the room to their left."""
        number = np.maximum(np.ceil(share * self._fits.sum(axis=1)), 1)
        return np.asarray((self._fits.cumsum(axis=1) >= number[:, None]).argmax(axis=1) + 0.5)

    def nearest(self, places: Floats) -> Floats:
        """Return the places (n,) with room that are nearest to some places (n,)."""
        away = np.abs(np.arange(self._fits.shape[1]) + 0.5 - places[:, None])
        return np.asarray(np.where(self._fits, away, np.inf).argmin(axis=1) + 0.5)


def _reach(crown: ImaginedCrown, clumps: Floats) -> Floats:
    """Return how far aside of its section's middle each clump (n, 4) reaches, over the section's radius: (n,)."""
    row = crown.rows(clumps[:, 1])
    return np.asarray((np.abs(clumps[:, 0] - crown.middle[row]) + clumps[:, 3]) / crown.radius[row])


def _further_clumps(crown: ImaginedCrown, seen: Floats, shown: Floats, rng: np.random.Generator) -> Floats:
    """Return clumps (m, 4) like those seen in front, behind the stem, each the furthest of many from all before it.

    With them the back bears as much as the front, and the crown is as closed from the sides.
    """
    places = np.tile(seen, (COPIES, 1))
    room = _depths_for(crown, places[:, [0, 1, 3]])
    places[:, 2] = room.at_share(0.5 * rng.random(len(places))) - crown.furthest
    views = [_View(crown, shown, azimuth) for azimuth in VIEWS_RAD]
    wanted = OPENER * _openness(crown.front)
    clear = np.min([_apart(places, clump) for clump in shown], axis=0, initial=np.inf)
    surplus, chosen = _surplus(crown, shown), list[int]()
    while len(places) and clear[best := int(clear.argmax())] > CLOSE:
        if surplus <= 0 and len(chosen) % AT_ONCE == 0 and np.mean([view.openness for view in views]) <= wanted:
            break
        chosen.append(best)
        surplus += _surplus(crown, places[best, None])
        for view in views:
            view.add(places[best])
        clear = np.minimum(clear, _apart(places, places[best]))
    return places[chosen]


def _surplus(crown: ImaginedCrown, clumps: Floats) -> float:
    """Sum of the squared radii of the clumps (n, 4) in the crown's front half, less that of those in its back half."""
    before = clumps[:, 2] - crown.near[crown.rows(clumps[:, 1])]
    return float((clumps[:, 3] ** 2 * np.sign(before)).sum())


def _apart(clumps: Floats, other: Floats) -> Floats:
    """Distance of clumps (n, 4) from another (4,), over the sum of their radii: (n,)."""
    away = np.sqrt(((clumps[:, :3] - other[:3]) ** 2).sum(axis=1))
    return np.asarray(away / (clumps[:, 3] + other[3]))


def _openness(silhouette: Mask) -> float:
    """Share of a crown's silhouette (h, w), its bays and holes closed, that is not covered."""
    wide = int(BAY * len(silhouette)) | 1
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (wide, wide))
    whole = cv2.morphologyEx(np.pad(silhouette.astype(np.uint8), wide), cv2.MORPH_CLOSE, kernel)
    return float(1 - silhouette.sum() / max(int(whole.sum()), 1))


class _View:
    """The silhouette of a crown's clumps from a side."""

    def __init__(self, crown: ImaginedCrown, clumps: Floats, azimuth: float) -> None:
        self._turn = np.array([np.cos(azimuth), 0.0, -np.sin(azimuth), 0.0])
        reach = int(np.ceil((crown.radius + crown.deep + np.abs(crown.near)).max())) + len(crown.front)
        self._middle = reach - float(crown.middle.mean()) * self._turn[0]
        self._picture = np.zeros((len(crown.front), 2 * reach), dtype=np.uint8)
        half = CORE * np.hypot(crown.radius * self._turn[0], crown.deep * self._turn[2])
        middle = self._middle + crown.middle * self._turn[0] + crown.near * self._turn[2]
        column = np.arange(2 * reach) + 0.5
        self._picture[np.abs(column - middle[:, None]) <= half[:, None]] = 1
        for clump in clumps:
            self.add(clump)

    def add(self, clump: Floats) -> None:
        """Draw a clump (4,)."""
        place = round(self._middle + float(clump @ self._turn) - 0.5), int(clump[1])
        cv2.circle(self._picture, place, round(float(clump[3])), 1, -1)

    @property
    def openness(self) -> float:
        """How open the crown is from this side; see `_openness`."""
        return _openness(self._picture > 0)


def _filled(crown: ImaginedCrown, clumps: Floats) -> Mask:
    """Fill the cells (x, y, z) in the clumps and in the core that front and side show."""
    height, width = crown.front.shape
    x, y, z = np.ogrid[:width, :height, -crown.furthest : crown.furthest]
    core = np.hypot((x + 0.5 - crown.middle[y]) / crown.radius[y], (z + 0.5 - crown.near[y]) / crown.deep[y])
    filled = core <= CORE
    for clump in clumps:
        corner = np.maximum(np.floor(clump[:3] - clump[3] + (0, 0, crown.furthest)), 0).astype(np.int64)
        block = tuple(slice(a, b) for a, b in zip(corner, corner + int(np.ceil(2 * clump[3])) + 1, strict=True))
        near_x, near_y, near_z = x[block[0]], y[:, block[1]], z[:, :, block[2]]
        squares = [(axis + 0.5 - middle) ** 2 for axis, middle in zip((near_x, near_y, near_z), clump, strict=False)]
        filled[block] |= squares[0] + squares[1] + squares[2] <= clump[3] ** 2
    filled = _with_all_columns(filled & crown.front.T[:, :, None] & crown.side, crown.front.T)
    from_left = _with_all_columns(filled.transpose(2, 1, 0), crown.side.T).transpose(2, 1, 0)
    return np.asarray(from_left & crown.front.T[:, :, None])


def _with_all_columns(filled: Mask, front: Mask) -> Mask:
    """Fill a cell of (x, y, z) in each column of the ``front`` (x, y) that has none, as deep as in the nearest."""
    shown = np.asarray(filled.any(axis=2))
    x, y = np.nonzero(front & ~shown)
    if not shown.any() or len(x) == 0:
        return filled
    bare = (~shown).astype(np.uint8)
    _, labels = cv2.distanceTransformWithLabels(bare, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    columns = np.argwhere(shown)
    column = np.zeros(int(labels.max()) + 1, dtype=np.int64)
    column[labels[shown]] = np.arange(len(columns))
    nearest = filled[tuple(columns[column[labels[x, y]]].T)]
    middle = (nearest * np.arange(filled.shape[2])).sum(axis=1) // nearest.sum(axis=1)
    filled[x, y, middle] = True
    return filled
