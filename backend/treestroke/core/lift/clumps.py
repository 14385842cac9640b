"""Takes a crown's front apart into clumps of foliage, and sets like ones on the sides that the photo does not show.

The front's silhouette is a sum of discs. Each stands for a ball of foliage: at the outline beside the stem, else before
it. Balls like those at the outline, placed all around it, make the unseen sides, until the crown is as closed from the
sides as from the front.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.clumped_crown import Cells, ClumpedCrown
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import TurnedOutline
from treestroke.core.geometry.polyline import smoothed
from treestroke.core.imaging.discs import cover_with_discs
from treestroke.core.types import Floats, Mask

CELLS = 80
"""Cells along the crown's longer side."""
EVEN, TREND = 0.04, 0.12
"""Standard deviations, as shares of the crown's height, over which its outline is evened, and averaged to a trend."""
DEEP, SHALLOWEST = 1.15, 0.5
"""Depth of the sections over their width, as clumps lie under their surface; and least depth over the width's trend."""
LEAN = 0.6
"""How far sections stand before or behind the stem, over how far they stand beside it."""
LARGEST, SMALLEST = 0.12, 1.2
"""Radius of the largest clumps, as a share of the crown's size, and of the smallest, in cells."""
AT_OUTLINE = 0.7
"""Clumps that reach this share of their section's radius are at the outline."""
SUNK = 0.8
"""Share of its radius that a clump lies under the crown's surface."""
RELIEF, SEEN_THROUGH = 0.4, 8.0
"""Share of the crown's half depth over which the clumps of its front are spread, and how much more for each unit of the
front's openness: through an open crown its back is seen."""
CORE = 0.45
"""Share of the sections' radius within which foliage stands anywhere."""
CANDIDATES = 600
"""Places that are tried for unseen clumps."""
HEIGHTS = 0.15
"""How much higher or lower than its model an unseen clump may stand, as a share of the crown's height."""
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


@dataclass(frozen=True, eq=False)
class _Crown:
    """A crown's front and sections, in cells of a coarse picture.

    Attributes
    ----------
    mask
        (h, w) its front.
    middle, radius, near, deep
        (h,) as in `Sections`.
    """

    mask: Mask
    middle: Floats
    radius: Floats
    near: Floats
    deep: Floats

    def rows(self, y: Floats) -> NDArray[np.int64]:
        """Return the rows (n,) that hold places y (n,)."""
        return np.clip(y.astype(np.int64), 0, len(self.mask) - 1)


def in_clumps(outline: TurnedOutline, front: Silhouette[OrthographicCamera], rng: np.random.Generator) -> ClumpedCrown:
    """Return the volume of a crown whose foliage stands in clumps, from its outline and its silhouette.

    Its sections are about as deep as wide, each by a guess of its own: depth, and how far the sections stand before or
    behind the stem, vary along the height as width and middle do.

    Source: surrogate data, Theiler et al. 1992 (the same spectrum, other phases); best-candidate sampling, Mitchell
    1991.
    """
    mask, camera = front.mask, front.camera
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    corner = np.array([columns[0], rows[0]], dtype=np.float64)
    side = float(max(np.ptp(rows), np.ptp(columns)) + 1) / CELLS
    crown = _coarse(outline, mask[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1], corner, side)
    crown = _deep(crown, (camera.pixels_from_world(np.zeros((1, 3)))[0] - corner) / side, rng)
    seen = _seen_clumps(crown, rng)
    filled, nearest = _filled(crown, np.vstack([seen, _unseen_clumps(crown, seen, rng)]))
    cells = Cells(filled, np.array([*corner, side * nearest]), side)
    row = (np.arange(camera.height) + 0.5 - corner[1]) / side - 0.5
    near_px, deep_px = (side * np.interp(row, np.arange(len(column)), column) for column in (crown.near, crown.deep))
    return ClumpedCrown(
        camera,
        outline.middle_px,
        outline.radius_px,
        outline.silhouettes,
        near_px=near_px,
        deep_px=deep_px,
        clumps=cells,
    )


def _coarse(outline: TurnedOutline, mask: Mask, corner: Floats, side: float) -> _Crown:
    """Reduce a crown's silhouette, cropped to a corner (2,), px, to cells of a side, px; it is as deep as wide."""
    size = [max(1, round(length / side)) for length in mask.shape[::-1]]
    small = cv2.resize(mask.astype(np.uint8) * np.uint8(255), size, interpolation=cv2.INTER_AREA) > 127
    row = np.minimum(corner[1] + (np.arange(size[1]) + 0.5) * side, len(outline.radius_px) - 1).astype(np.int64)
    middle, radius = (outline.middle_px[row] - corner[0]) / side, np.maximum(outline.radius_px[row] / side, 0.5)
    return _Crown(small, middle, radius, np.zeros(len(row)), radius)


def _deep(crown: _Crown, root: Floats, rng: np.random.Generator) -> _Crown:
    """Guess how deep the sections are, and how far before the root's plane; the tree's ``root`` (2,) is in cells."""
    height = np.arange(len(crown.radius), dtype=np.float64)
    centre_x, centre_y = (float((crown.radius * of).sum() / crown.radius.sum()) for of in (crown.middle, height))
    stem = root[0] + (centre_x - root[0]) * np.clip((root[1] - height) / max(root[1] - centre_y, 1.0), 0.0, 1.5)
    trend, aside = (smoothed(column, TREND * len(height)) for column in (crown.radius, crown.middle - stem))
    varied = trend + _other_phases(smoothed(crown.radius, EVEN * len(height)) - trend, rng)
    deep = DEEP * np.maximum(varied, SHALLOWEST * trend)
    return replace(crown, near=LEAN * _other_phases(aside, rng), deep=deep)


def _other_phases(values: Floats, rng: np.random.Generator) -> Floats:
    """Return values (n,) that vary as much and as fast as the ones given, in another way; their mean's sign is random.

    Source: surrogate data, Theiler et al. 1992: the same spectrum, with phases at random.
    """
    spectrum = np.fft.rfft(np.concatenate([values, values[::-1]]))
    turn = np.exp(2j * np.pi * rng.random(len(spectrum)))
    turn[0] = rng.choice((-1.0, 1.0))
    return np.asarray(np.fft.irfft(spectrum * turn, 2 * len(values))[: len(values)], dtype=np.float64)


def _seen_clumps(crown: _Crown, rng: np.random.Generator) -> Floats:
    """Return the clumps that the front shows: (n, 4) x, y, z and radius, cells."""
    discs = cover_with_discs(crown.mask, SMALLEST, LARGEST * float(np.sqrt(crown.mask.sum())))
    row = crown.rows(discs[:, 1])
    aside = np.abs(discs[:, 0] - crown.middle[row]) / crown.radius[row]
    room = np.maximum(np.sqrt(np.maximum(1 - aside**2, 0.0)) * crown.deep[row] - SUNK * discs[:, 2], 0.0)
    relief = min(2.0, RELIEF + SEEN_THROUGH * _openness(crown.mask, len(crown.mask)))
    beside, before = rng.uniform(-1, 1, len(discs)), 1 - relief * rng.random(len(discs))
    clumps = np.insert(discs, 2, 0.0, axis=1)
    clumps[:, 2] = crown.near[row] + np.where(_reach(crown, clumps) >= AT_OUTLINE, beside, before) * room
    return clumps


def _reach(crown: _Crown, clumps: Floats) -> Floats:
    """Return how far aside of its section's middle each clump (n, 4) reaches, over the section's radius: (n,)."""
    row = crown.rows(clumps[:, 1])
    return np.asarray((np.abs(clumps[:, 0] - crown.middle[row]) + clumps[:, 3]) / crown.radius[row])


def _unseen_clumps(crown: _Crown, seen: Floats, rng: np.random.Generator) -> Floats:
    """Return clumps (m, 4) on the other sides, each the furthest of many from all before it."""
    places = _candidates(crown, seen, rng)
    views = [_View(crown, seen, azimuth) for azimuth in VIEWS_RAD]
    wanted = OPENER * _openness(crown.mask, len(crown.mask))
    clear = np.min([_apart(places, clump) for clump in seen], axis=0, initial=np.inf)
    surplus = _surplus(crown, seen)
    chosen = list[int]()
    while len(places) and clear[best := int(clear.argmax())] > CLOSE:
        if surplus <= 0 and len(chosen) % AT_ONCE == 0 and np.mean([view.openness for view in views]) <= wanted:
            break
        chosen.append(best)
        surplus += _surplus(crown, places[best, None])
        for view in views:
            view.add(places[best])
        clear = np.minimum(clear, _apart(places, places[best]))
    return places[chosen]


def _surplus(crown: _Crown, clumps: Floats) -> float:
    """Sum of the squared radii of the clumps (n, 4) in the crown's front half, less that of those in its back half."""
    before = clumps[:, 2] - crown.near[crown.rows(clumps[:, 1])]
    return float((clumps[:, 3] ** 2 * np.sign(before)).sum())


def _candidates(crown: _Crown, seen: Floats, rng: np.random.Generator) -> Floats:
    """Return places for clumps (m, 4) all around: like those at the front's outline, and within its silhouette."""
    reach = _reach(crown, seen)
    at_outline = np.flatnonzero(reach >= AT_OUTLINE)
    if len(at_outline) == 0:
        return np.zeros((0, 4))
    around = np.cumsum(crown.radius + crown.deep)
    row = np.searchsorted(around / around[-1], rng.random(CANDIDATES))
    azimuth = rng.uniform(0, 2 * np.pi, CANDIDATES)
    astray = HEIGHTS * len(around) * rng.random((CANDIDATES, len(at_outline)))
    away = np.abs(seen[at_outline, 1] - row[:, None]) + astray
    model = at_outline[away.argmin(axis=1)]
    surface = 1 / np.hypot(np.cos(azimuth) / crown.radius[row], np.sin(azimuth) / crown.deep[row])
    out = np.maximum(reach[model] * surface - seen[model, 3], 0.0)
    x, z = crown.middle[row] + out * np.cos(azimuth), crown.near[row] + out * np.sin(azimuth)
    room = cv2.distanceTransform(np.pad(crown.mask.astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    radius = np.minimum(seen[model, 3], room[row, np.clip(x, 0, room.shape[1] - 1).astype(np.int64)])
    return np.asarray(np.column_stack([x, row + 0.5, z, radius])[radius >= SMALLEST])


def _apart(clumps: Floats, other: Floats) -> Floats:
    """Distance of clumps (n, 4) from another (4,), over the sum of their radii: (n,)."""
    away = np.sqrt(((clumps[:, :3] - other[:3]) ** 2).sum(axis=1))
    return np.asarray(away / (clumps[:, 3] + other[3]))


def _openness(silhouette: Mask, height: int) -> float:
    """Share of a silhouette (h, w), its bays and holes closed, that is not covered; the crown's ``height`` is in px."""
    wide = int(BAY * height) | 1
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (wide, wide))
    whole = cv2.morphologyEx(np.pad(silhouette.astype(np.uint8), wide), cv2.MORPH_CLOSE, kernel)
    return float(1 - silhouette.sum() / max(int(whole.sum()), 1))


class _View:
    """The silhouette of a crown's clumps from a side."""

    def __init__(self, crown: _Crown, clumps: Floats, azimuth: float) -> None:
        self._turn = np.array([np.cos(azimuth), 0.0, -np.sin(azimuth), 0.0])
        reach = int(np.ceil((crown.radius + crown.deep + np.abs(crown.near)).max())) + len(crown.mask)
        self._middle = reach - float(crown.middle.mean()) * self._turn[0]
        self._picture = np.zeros((len(crown.mask), 2 * reach), dtype=np.uint8)
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
        return _openness(self._picture > 0, len(self._picture))


def _filled(crown: _Crown, clumps: Floats) -> tuple[Mask, int]:
    """Fill the cells (x, y, z) in the clumps and in the core, before the front's silhouette; and z of the first."""
    sections, balls = np.abs(crown.near) + crown.deep, np.abs(clumps[:, 2]) + clumps[:, 3]
    nearest = -int(np.ceil(np.concatenate([sections, balls]).max()))
    height, width = crown.mask.shape
    x, y, z = np.ogrid[:width, :height, nearest:-nearest]
    core = np.hypot((x + 0.5 - crown.middle[y]) / crown.radius[y], (z + 0.5 - crown.near[y]) / crown.deep[y])
    filled = core <= CORE
    for clump in clumps:
        corner = np.maximum(np.floor(clump[:3] - clump[3] - (0, 0, nearest)), 0).astype(np.int64)
        block = tuple(slice(a, b) for a, b in zip(corner, corner + int(np.ceil(2 * clump[3])) + 1, strict=True))
        near_x, near_y, near_z = x[block[0]], y[:, block[1]], z[:, :, block[2]]
        squares = [(axis + 0.5 - middle) ** 2 for axis, middle in zip((near_x, near_y, near_z), clump, strict=False)]
        filled[block] |= squares[0] + squares[1] + squares[2] <= clump[3] ** 2
    return _with_all_columns(filled & crown.mask.T[:, :, None], crown.mask.T), nearest


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
