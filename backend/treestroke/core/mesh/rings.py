"""The cross-sections of tubes: rings on smooth curves through the joints, with collars, root flares and caps."""

from dataclasses import dataclass, fields, replace

import numpy as np

from treestroke.core.geometry.vectors import UP
from treestroke.core.mesh.limb_axes import LimbAxes
from treestroke.core.types import Floats, Indices, Mask

COLLAR_STEPS = np.array([-0.9, -0.2, 0.4, 1.0, 1.8, 3.0])
"""Rings of a collar, in limb radii beyond the place where the limb's axis leaves its parent's surface."""
FLARE_STEPS = np.array([0.2, 0.45, 0.8, 1.25, 1.8, 2.6])
"""Rings of a root flare, in trunk radii above the root."""
DOME_STEPS = ((0.55, 0.8), (0.9, 0.0))
"""Rings of a round end: (distance beyond the tip, radius), both in tip radii."""

_BEND_RAD = 0.35  # turn of the axis between two rings
_CURVE_IN = (0.3, 0.9)  # weight of the parent's direction in a limb's first tangent: (thin limb, added for a thick one)
_MIN_SINE_SQUARED = 0.12  # a limb that leaves its parent at less than 20 degrees is treated as if at 20
_MIN_THORN = 0.2  # tip radius over that of a blunt tip, from which on a pointed end is visible
_POINT_LENGTH = 5.0  # length of such a pointed end, in tip radii
_MIN_GAP = 0.3  # least distance between rings, in radii


@dataclass(frozen=True, eq=False)
class Rings:
    """The r cross-sections of all tubes, limb by limb, root first.

    Attributes
    ----------
    points, tangents
        (r, 3) centre of each ring, metres, and the unit direction of the axis there.
    radii
        (r,) metres; 0 where the tube is closed to a point.
    limb
        (r,) index of the ring's limb, ascending.
    swelling
        (r,) share of its limb's collar or root flare that a ring has, 0 to 1.
    joints, share
        (r, 2) index of the two joints of the skeleton that a ring stands between, and (r,) its position from the first
        to the second, 0 to 1; the same joint twice at a joint and in a cap.
    """

    points: Floats
    tangents: Floats
    radii: Floats
    limb: Indices
    swelling: Floats
    joints: Indices
    share: Floats

    @property
    def first(self) -> Indices:
        """Index (k,) of each limb's first ring."""
        return np.flatnonzero(np.diff(self.limb, prepend=-1)).astype(np.int64)

    def select(self, kept: Indices) -> "Rings":
        """Select rings by their index (j,), in that order."""
        return Rings(*(getattr(self, field.name)[kept] for field in fields(self)))


def place_rings(axes: LimbAxes, detail: float, blunt: float, collared: float) -> Rings:
    """Place rings along the axes of limbs.

    Parameters
    ----------
    axes
        The limbs.
    detail
        1 places a ring at each 20 degrees of bend; lower values place fewer.
    blunt
        Tips of at least this radius, metres, get a round end; thinner ones end in a point.
    collared
        Limbs of at least this radius, metres, get a collar where they leave their parent.

    Notes
    -----
    Axes are cubic Hermite curves through the joints, with the tangents of a non-uniform Catmull-Rom spline; the
    cross-sections of generalized cylinders stand on them (Bloomenthal, "Modeling the Mighty Maple", 1985).
    """
    tangents = _joint_tangents(axes)
    along = _arc(axes)
    shaped = np.concatenate([_collar_places(axes, along, collared), _tip_places(axes, along, blunt)])
    places = np.union1d(_bend_places(axes, tangents, detail), shaped)
    places = _apart(places, axes, along)
    points, directions = _hermite(axes, tangents, places)
    edge, t = _split(places, axes)
    after = np.minimum(edge + 1, len(along) - 1)
    limb = axes.limb[edge]
    radii = axes.radii[edge] + t * (axes.radii[after] - axes.radii[edge])
    distance = along[edge] + t * (along[after] - along[edge]) - along[axes.first[limb]]
    swelling = _swelling(axes, limb, distance, collared)
    directions = _upright(directions, swelling, axes.is_stem[limb])
    joints = axes.joint[np.stack([edge, np.where(t > 0, after, edge)], axis=1)]
    return _closed(Rings(points, directions, radii, limb, swelling, joints, t), places, axes, blunt)


def _exit_lengths(axes: LimbAxes) -> Floats:
    """Length (k,), metres, along its axis at which each limb leaves its parent's surface; 0 for a stem."""
    first = axes.first
    start = axes.points[first + 1] - axes.points[first]
    cosine = np.einsum("ij,ij->i", start, axes.parent_direction) / np.linalg.norm(start, axis=1)
    return np.asarray(axes.parent_radius / np.sqrt(np.maximum(1.0 - cosine**2, _MIN_SINE_SQUARED)))


def _arc(axes: LimbAxes) -> Floats:
    """Length (m,), metres, along all limbs laid end to end."""
    step = np.linalg.norm(np.diff(axes.points, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(np.where(np.diff(axes.limb) == 0, step, 0.0))])


def _joint_tangents(axes: LimbAxes) -> Floats:
    """Return the unit tangent (m, 3) at each point; a limb's first leans towards its parent's direction."""
    edge = np.diff(axes.points, axis=0)
    inside = np.diff(axes.limb) == 0
    length = np.where(inside, np.linalg.norm(edge, axis=1), 0.0)
    unit = edge / np.where(length > 0, length, np.inf)[:, None]
    no_edge, zero = np.zeros((1, 3)), np.zeros(1)
    before, after = np.concatenate([no_edge, unit]), np.concatenate([unit, no_edge])
    # the nearer edge counts more, as in non-uniform Catmull-Rom splines
    length_before, length_after = np.concatenate([length, zero]), np.concatenate([zero, length])
    tangent = before * np.where(length_after > 0, length_after, 1.0)[:, None]
    tangent += after * np.where(length_before > 0, length_before, 1.0)[:, None]
    first, grown = axes.first, axes.parent_radius > 0
    branch = first[grown]
    tangent[first] = after[first]
    thin, thick = _CURVE_IN
    lean = thin + thick * axes.radii[branch] / axes.parent_radius[grown]
    tangent[branch] += lean[:, None] * axes.parent_direction[grown]
    norm = np.linalg.norm(tangent, axis=1, keepdims=True)
    return np.asarray(np.where(norm > 1e-6, tangent / np.maximum(norm, 1e-6), after + before))


def _bend_places(axes: LimbAxes, tangents: Floats, detail: float) -> Floats:
    """Places (point index + fraction of its edge) of rings: all points, and more where the axis bends."""
    points = np.arange(len(axes.limb), dtype=np.float64)
    inside = np.flatnonzero(np.diff(axes.limb) == 0)
    turn = np.arccos(np.clip(np.einsum("ij,ij->i", tangents[inside], tangents[inside + 1]), -1.0, 1.0))
    pieces = np.clip(np.ceil(turn * detail / _BEND_RAD), 1, 6).astype(np.int64)
    index = np.repeat(inside, pieces)
    within = np.arange(len(index)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    return np.asarray(np.union1d(points, index + within / np.repeat(pieces, pieces)), dtype=np.float64)


def _collar_places(axes: LimbAxes, along: Floats, collared: float) -> Floats:
    """Places of the rings that shape collars and root flares."""
    first, last = axes.first, axes.last
    stem, radius = axes.is_stem, axes.radii[first]
    branch = ~stem & (radius >= collared)
    flare = radius[stem, None] * FLARE_STEPS
    collar = _exit_lengths(axes)[branch, None] + radius[branch, None] * COLLAR_STEPS
    found = [_places_at(s, first[mask], last[mask], along) for s, mask in ((flare, stem), (collar, branch))]
    return np.concatenate(found)


def _tip_places(axes: LimbAxes, along: Floats, blunt: float) -> Floats:
    """Place a ring shortly before each visible pointed tip, so that not the whole last edge tapers like a thorn."""
    first, last = axes.first, axes.last
    thorny = (axes.radii[last] < blunt) & (axes.radii[last] >= _MIN_THORN * blunt)
    lengths = along[last] - along[first] - _POINT_LENGTH * axes.radii[last]
    return _places_at(lengths[thorny, None], first[thorny], last[thorny], along)


def _places_at(lengths: Floats, first: Indices, last: Indices, along: Floats) -> Floats:
    """Convert lengths (k, c) along limbs, metres, to places; those beyond a limb's tip are left out."""
    target = along[first][:, None] + lengths
    inside = (lengths > 0) & (target < along[last][:, None])
    start = np.broadcast_to(first[:, None], lengths.shape)[inside]
    end = np.broadcast_to(last[:, None], lengths.shape)[inside]
    edge = np.clip(np.searchsorted(along, target[inside], side="right") - 1, start, end - 1)
    length = along[edge + 1] - along[edge]
    return np.asarray(edge + np.clip((target[inside] - along[edge]) / np.where(length > 0, length, 1.0), 0.0, 0.999))


def _split(places: Floats, axes: LimbAxes) -> tuple[Indices, Floats]:
    """Split places (r,) into the index of a point and the fraction of the edge after it."""
    edge = np.minimum(np.floor(places).astype(np.int64), len(axes.limb) - 1)
    return edge, places - edge


def _apart(places: Floats, axes: LimbAxes, along: Floats) -> Floats:
    """Leave out places too near to the one before or to the limb's tip, where rings would intersect."""
    edge, t = _split(places, axes)
    distance = along[edge] + t * (along[np.minimum(edge + 1, len(along) - 1)] - along[edge])
    gap = _MIN_GAP * axes.radii[edge]
    start, tip = np.isin(places, axes.first), np.isin(places, axes.last)
    limb = axes.limb[edge]
    keep = start | tip | (along[axes.last[limb]] - distance >= gap)
    crowded = np.zeros(len(axes.parent_radius), dtype=bool)
    crowded[limb[1:][(np.diff(distance) < gap[1:]) & ~start[1:]]] = True
    doubtful = keep & crowded[limb] & ~tip
    keep &= ~doubtful
    latest = 0.0
    for i in np.flatnonzero(doubtful).tolist():
        if start[i] or distance[i] - latest >= gap[i]:
            keep[i], latest = True, distance[i]
    return places[keep]


def _hermite(axes: LimbAxes, tangents: Floats, places: Floats) -> tuple[Floats, Floats]:
    """Points and unit tangents (r, 3) at places, on cubic Hermite curves through the axes' points."""
    edge, t = _split(places, axes)
    after = np.where(t > 0, edge + 1, edge)
    p0, p1 = axes.points[edge], axes.points[after]
    length = np.linalg.norm(p1 - p0, axis=1, keepdims=True)
    m0, m1, t = tangents[edge] * length, tangents[after] * length, t[:, None]
    point = p0 + (p1 - p0) * t**2 * (3 - 2 * t) + m0 * t * (1 - t) ** 2 - m1 * t**2 * (1 - t)
    slope = (p1 - p0) * 6 * t * (1 - t) + m0 * (1 - t) * (1 - 3 * t) + m1 * t * (3 * t - 2)
    slope = np.where(length > 0, slope, tangents[edge])
    norm = np.linalg.norm(slope, axis=1, keepdims=True)
    return point, np.where(norm > 1e-9 * (1 + length), slope / np.maximum(norm, 1e-300), tangents[edge])


def _swelling(axes: LimbAxes, limb: Indices, distance: Floats, collared: float) -> Floats:
    """Share (r,) of its collar or root flare that each ring has: 1 up to the parent's surface, then fading."""
    radius = axes.radii[axes.first]
    stem = axes.is_stem
    fade = np.where(stem, FLARE_STEPS[-1], COLLAR_STEPS[-1])
    past = (distance - _exit_lengths(axes)[limb] * ~stem[limb]) / radius[limb]
    fading = np.clip(1.0 - past / fade[limb], 0.0, 1.0) ** np.where(stem, 2.5, 1.0)[limb]
    return np.where((stem | (radius >= collared))[limb], fading, 0.0)


def _upright(tangents: Floats, swelling: Floats, stem: Mask) -> Floats:
    """Turn the rings of root flares level, so that a leaning trunk too stands flat on the ground."""
    level = np.where(stem & (tangents[:, 1] > 0.2), swelling, 0.0)[:, None]
    turned = tangents * (1.0 - level) + UP * level
    return np.asarray(turned / np.linalg.norm(turned, axis=1, keepdims=True))


def _closed(rings: Rings, places: Floats, axes: LimbAxes, blunt: float) -> Rings:
    """Close stems at the bottom and all limbs at their tips."""
    first, last = np.searchsorted(places, axes.first), np.searchsorted(places, axes.last)
    radii = rings.radii.copy()
    round_end = radii[last] >= blunt
    radii[last[~round_end]] = 0.0
    rings = replace(rings, radii=radii)
    stem = axes.is_stem
    caps = [(_cap(rings, first[stem], 0.0, 0.0), axes.first[stem] - 0.5)]
    for beyond, radius in DOME_STEPS:
        caps.append((_cap(rings, last[round_end], beyond, radius), axes.last[round_end] + 0.5 * beyond))
    order = np.argsort(np.concatenate([places, *(at for _, at in caps)]), kind="stable")
    whole = [rings, *(cap for cap, _ in caps)]
    return Rings(*(np.concatenate([getattr(part, f.name) for part in whole])[order] for f in fields(Rings)))


def _cap(rings: Rings, index: Indices, beyond: float, radius: float) -> Rings:
    """Copy rings ``index``, moved ``beyond`` radii along the axis, with ``radius`` times their radius."""
    cap = rings.select(index)
    points = cap.points + cap.tangents * (beyond * cap.radii)[:, None]
    return replace(cap, points=points, radii=cap.radii * radius)
