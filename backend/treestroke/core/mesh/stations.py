"""Where the rings of a tube stand: smooth curves through the joints, with collars, root flares and caps."""

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from treestroke.core.mesh.chains import Chains
from treestroke.core.types import Floats, Indices

COLLAR_STEPS = np.array([-0.9, -0.2, 0.4, 1.0, 1.8, 3.0])
"""Rings of a collar, in child radii beyond the place where its axis leaves the bearer's surface."""
FLARE_STEPS = np.array([0.2, 0.45, 0.8, 1.25, 1.8, 2.6])
"""Rings of a root flare, in trunk radii above the root."""
DOME_STEPS = ((0.55, 0.8), (0.9, 0.0))
"""Rings of a round end: (distance beyond the tip, radius), both in tip radii."""

_BEND_RAD = 0.35  # turn of the axis between two rings
_CURVE_IN = (0.3, 0.9)  # how much of its bearer's direction a limb starts with: a thin one, and more for a thick one
_STEEPEST = 0.12  # squared sine: a limb that leaves its bearer at a narrower angle than 20 degrees counts as this
_THORN = 0.2  # share of a blunt tip's radius, from which on a point would show
_POINT = 5.0  # length of such a point, in tip radii
_MIN_GAP = 0.3  # rings stand no closer than this, in radii


@dataclass(frozen=True, eq=False)
class Stations:
    """The rings of all tubes, limb by limb, root first.

    Attributes
    ----------
    points, tangents
        (r, 3) centre of each ring, metres, and its unit axis.
    radii
        (r,) metres; 0 where the tube is closed to a point.
    limb
        (r,) ascending, which limb a ring is of.
    swell
        (r,) 0 to 1, how much of its limb's collar or root flare a ring has.
    joints, share
        (r, 2) the skeleton's joints that a ring stands between, and (r,) how far from the first to the second, 0 to 1;
        twice the same on a joint and in a cap.
    """

    points: Floats
    tangents: Floats
    radii: Floats
    limb: Indices
    swell: Floats
    joints: Indices
    share: Floats

    @property
    def first(self) -> Indices:
        """Index (k,) of each limb's first ring."""
        return np.flatnonzero(np.diff(self.limb, prepend=-1)).astype(np.int64)

    def select(self, kept: Indices) -> "Stations":
        """Take rings ``kept``, in that order."""
        return Stations(*(getattr(self, field.name)[kept] for field in fields(self)))


def stations_of(chains: Chains, detail: float, blunt: float, collared: float) -> Stations:
    """Place rings along limbs.

    Parameters
    ----------
    chains
        The limbs.
    detail
        1 places a ring at each 20 degrees of bend; less detail, fewer rings.
    blunt
        Tips at least this thick, metres, get a round end; thinner ones a point.
    collared
        Limbs at least this thick, metres, get a collar where they leave their bearer.
    """
    tangents = _joint_tangents(chains)
    along = _arc(chains)
    shaped = np.concatenate([_collar_places(chains, along, collared), _tip_places(chains, along, blunt)])
    places = np.union1d(_bend_places(chains, tangents, detail), shaped)
    places = _apart(places, chains, along)
    points, axes = _hermite(chains, tangents, places)
    edge, t = _split(places, chains)
    after = np.minimum(edge + 1, len(along) - 1)
    limb = chains.limb[edge]
    radii = chains.radii[edge] + t * (chains.radii[after] - chains.radii[edge])
    travelled = along[edge] + t * (along[after] - along[edge]) - along[chains.first[limb]]
    swell = _swell(chains, limb, travelled, collared)
    axes = _upright(axes, swell, chains.bearer[limb] == 0)
    joints = chains.joint[np.stack([edge, np.where(t > 0, after, edge)], axis=1)]
    return _closed(Stations(points, axes, radii, limb, swell, joints, t), places, chains, blunt)


def _exit_lengths(chains: Chains) -> Floats:
    """Give how far along its axis (k,) each limb leaves its bearer's surface, metres; 0 for a stem."""
    first = chains.first
    way = chains.points[first + 1] - chains.points[first]
    cosine = np.einsum("ij,ij->i", way, chains.bearer_direction) / np.linalg.norm(way, axis=1)
    return np.asarray(chains.bearer / np.sqrt(np.maximum(1.0 - cosine**2, _STEEPEST)))


def _arc(chains: Chains) -> Floats:
    """Length (m,) along all limbs laid end to end."""
    step = np.linalg.norm(np.diff(chains.points, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(np.where(np.diff(chains.limb) == 0, step, 0.0))])


def _joint_tangents(chains: Chains) -> Floats:
    """Give the unit tangent (m, 3) at each joint; a limb starts leaning to its bearer's direction."""
    edge = np.diff(chains.points, axis=0)
    inside = np.diff(chains.limb) == 0
    length = np.where(inside, np.linalg.norm(edge, axis=1), 0.0)
    unit = edge / np.where(length > 0, length, np.inf)[:, None]
    none, zero = np.zeros((1, 3)), np.zeros(1)
    before, after = np.concatenate([none, unit]), np.concatenate([unit, none])
    # the nearer edge counts more, as in non-uniform Catmull-Rom splines
    share_before, share_after = np.concatenate([length, zero]), np.concatenate([zero, length])
    tangent = before * np.where(share_after > 0, share_after, 1.0)[:, None]
    tangent += after * np.where(share_before > 0, share_before, 1.0)[:, None]
    first = chains.first
    branch = first[chains.bearer > 0]
    tangent[first] = after[first]
    thin, thick = _CURVE_IN
    lean = thin + thick * chains.radii[branch] / chains.bearer[chains.bearer > 0]
    tangent[branch] += lean[:, None] * chains.bearer_direction[chains.bearer > 0]
    norm = np.linalg.norm(tangent, axis=1, keepdims=True)
    return np.asarray(np.where(norm > 1e-6, tangent / np.maximum(norm, 1e-6), after + before))


def _bend_places(chains: Chains, tangents: Floats, detail: float) -> Floats:
    """Places (joint + fraction of its edge): all joints, and more where the axis bends."""
    joints = np.arange(len(chains.limb), dtype=np.float64)
    inside = np.flatnonzero(np.diff(chains.limb) == 0)
    turn = np.arccos(np.clip(np.einsum("ij,ij->i", tangents[inside], tangents[inside + 1]), -1.0, 1.0))
    pieces = np.clip(np.ceil(turn * detail / _BEND_RAD), 1, 6).astype(np.int64)
    index = np.repeat(inside, pieces)
    within = np.arange(len(index)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    return np.asarray(np.union1d(joints, index + within / np.repeat(pieces, pieces)), dtype=np.float64)


def _collar_places(chains: Chains, along: Floats, collared: float) -> Floats:
    """Places of the rings that shape collars and root flares."""
    first, last = chains.first, chains.last
    stem, radius = chains.bearer == 0, chains.radii[first]
    branch = ~stem & (radius >= collared)
    flare = radius[stem, None] * FLARE_STEPS
    collar = _exit_lengths(chains)[branch, None] + radius[branch, None] * COLLAR_STEPS
    found = [_places_at(s, first[which], last[which], along) for s, which in ((flare, stem), (collar, branch))]
    return np.concatenate(found)


def _tip_places(chains: Chains, along: Floats, blunt: float) -> Floats:
    """Place a ring before each pointed tip that is not thin, lest the whole last edge look like a thorn."""
    first, last = chains.first, chains.last
    thorny = (chains.radii[last] < blunt) & (chains.radii[last] >= _THORN * blunt)
    lengths = along[last] - along[first] - _POINT * chains.radii[last]
    return _places_at(lengths[thorny, None], first[thorny], last[thorny], along)


def _places_at(lengths: Floats, first: Indices, last: Indices, along: Floats) -> Floats:
    """Turn lengths (k, c) along limbs, metres, into places; those beyond a limb's tip are left out."""
    target = along[first][:, None] + lengths
    inside = (lengths > 0) & (target < along[last][:, None])
    start = np.broadcast_to(first[:, None], lengths.shape)[inside]
    end = np.broadcast_to(last[:, None], lengths.shape)[inside]
    edge = np.clip(np.searchsorted(along, target[inside], side="right") - 1, start, end - 1)
    piece = along[edge + 1] - along[edge]
    return np.asarray(edge + np.clip((target[inside] - along[edge]) / np.where(piece > 0, piece, 1.0), 0.0, 0.999))


def _split(places: Floats, chains: Chains) -> tuple[Indices, Floats]:
    """Split places into joint and fraction."""
    edge = np.minimum(np.floor(places).astype(np.int64), len(chains.limb) - 1)
    return edge, places - edge


def _apart(places: Floats, chains: Chains, along: Floats) -> Floats:
    """Leave out places too near the one before or the limb's tip, where rings would cut each other."""
    edge, t = _split(places, chains)
    travelled = along[edge] + t * (along[np.minimum(edge + 1, len(along) - 1)] - along[edge])
    gap = _MIN_GAP * chains.radii[edge]
    start, tip = np.isin(places, chains.first), np.isin(places, chains.last)
    limb = chains.limb[edge]
    keep = start | tip | (along[chains.last[limb]] - travelled >= gap)
    crowded = np.zeros(len(chains.bearer), dtype=bool)
    crowded[limb[1:][(np.diff(travelled) < gap[1:]) & ~start[1:]]] = True
    doubtful = keep & crowded[limb] & ~tip
    keep &= ~doubtful
    latest = 0.0
    for i in np.flatnonzero(doubtful).tolist():
        if start[i] or travelled[i] - latest >= gap[i]:
            keep[i], latest = True, travelled[i]
    return places[keep]


def _hermite(chains: Chains, tangents: Floats, places: Floats) -> tuple[Floats, Floats]:
    """Points and unit tangents at places, on cubic curves through the joints."""
    edge, t = _split(places, chains)
    after = np.where(t > 0, edge + 1, edge)
    p0, p1 = chains.points[edge], chains.points[after]
    length = np.linalg.norm(p1 - p0, axis=1, keepdims=True)
    m0, m1, t = tangents[edge] * length, tangents[after] * length, t[:, None]
    point = p0 + (p1 - p0) * t**2 * (3 - 2 * t) + m0 * t * (1 - t) ** 2 - m1 * t**2 * (1 - t)
    slope = (p1 - p0) * 6 * t * (1 - t) + m0 * (1 - t) * (1 - 3 * t) + m1 * t * (3 * t - 2)
    slope = np.where(length > 0, slope, tangents[edge])
    norm = np.linalg.norm(slope, axis=1, keepdims=True)
    return point, np.where(norm > 1e-9 * (1 + length), slope / np.maximum(norm, 1e-300), tangents[edge])


def _swell(chains: Chains, limb: Indices, travelled: Floats, collared: float) -> Floats:
    """How much of its collar or root flare each ring has: 1 up to the bearer's surface, then fading."""
    radius = chains.radii[chains.first]
    stem = chains.bearer == 0
    fade = np.where(stem, FLARE_STEPS[-1], COLLAR_STEPS[-1])
    past = (travelled - _exit_lengths(chains)[limb] * ~stem[limb]) / radius[limb]
    fading = np.clip(1.0 - past / fade[limb], 0.0, 1.0) ** np.where(stem, 2.5, 1.0)[limb]
    return np.where((stem | (radius >= collared))[limb], fading, 0.0)


def _upright(tangents: Floats, swell: Floats, stem: NDArray[np.bool_]) -> Floats:
    """Turn the rings of root flares level, so that a leaning trunk too stands flat on the ground."""
    level = np.where(stem & (tangents[:, 1] > 0.2), swell, 0.0)[:, None]
    turned = tangents * (1.0 - level) + np.array([0.0, 1.0, 0.0]) * level
    return np.asarray(turned / np.linalg.norm(turned, axis=1, keepdims=True))


def _closed(rings: Stations, places: Floats, chains: Chains, blunt: float) -> Stations:
    """Close stems at the bottom and all limbs at their tips."""
    first, last = np.searchsorted(places, chains.first), np.searchsorted(places, chains.last)
    radii = rings.radii.copy()
    round_end = radii[last] >= blunt
    radii[last[~round_end]] = 0.0
    rings = replace(rings, radii=radii)
    caps = [(_taken(rings, first[chains.bearer == 0], 0.0, 0.0), chains.first[chains.bearer == 0] - 0.5)]
    for beyond, radius in DOME_STEPS:
        caps.append((_taken(rings, last[round_end], beyond, radius), chains.last[round_end] + 0.5 * beyond))
    order = np.argsort(np.concatenate([places, *(at for _, at in caps)]), kind="stable")
    whole = [rings, *(cap for cap, _ in caps)]
    return Stations(*(np.concatenate([getattr(part, f.name) for part in whole])[order] for f in fields(Stations)))


def _taken(rings: Stations, index: Indices, beyond: float, radius: float) -> Stations:
    """Copy rings ``index``, moved ``beyond`` radii along the axis, their radius times ``radius``."""
    cap = rings.select(index)
    points = cap.points + cap.tangents * (beyond * cap.radii)[:, None]
    return replace(cap, points=points, radii=cap.radii * radius)
