"""Palms: no branches, but a crown of fronds from the top of each stem.

Fronds leave the stem's top one after another, each turned by the golden angle from the one before (phyllotaxis). The
youngest stand, the older ones lie, the oldest hang. Each bends down along its length, is as long as the crown lets it
be, and goes where it fills most of what the photo shows (the cost E2D of Tan et al. 2008, section 3.2). A frond's
midrib is a limb of the skeleton; leaves hang on it.
"""

import numpy as np

from treestroke.core.grow.branches import successors_by_wood
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.replacement import CrownToFill
from treestroke.core.skeleton.measure import path_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import limbs
from treestroke.core.types import Floats

GOLDEN_RAD = np.pi * (3 - np.sqrt(5.0))
FRONDS = 40
"""Fronds of a stem (a coconut palm bears 25 to 35, a date palm many more)."""
ELEVATIONS = (np.radians(85.0), np.radians(-55.0))
"""Rise of the youngest and of the oldest frond where it leaves the stem."""
DROOPS, SWINGS, LIFTS = (
    tuple(np.radians(angles)) for angles in ((45.0, 75.0, 110.0), (0.0, -18.0, 18.0), (0.0, 14.0, 30.0))
)
"""Angles by which a frond may bend down along its length, turn aside and stand higher; the curve that fills most of the
crown is taken."""
SHARES = np.arange(20, 3, -1) / 20
"""Lengths that are tried, as shares of the way from the stem's top to the crown's far end, the longest first."""
FREE = 0.25
"""Share of a frond at its foot that may lie outside the crown: the stem's top need not lie in it."""
GAPS = 500
"""About how many points of the crown fronds are to come near."""
PIECES = 12
"""Joints of a frond."""
LEAST_STEM = 0.2
"""Least length of a limb that bears fronds, as a share of the longest path from a root."""
MIDRIB = (0.22, 0.02)
"""Radius of a midrib at its foot and at its tip, as a share of the stem's at its top."""


def grow_palm(skeleton: Skeleton, crown: CrownToFill, rng: np.random.Generator) -> Grown:
    """Set fronds on the stems of a lifted palm (3D, metres); its own joints stay where they are.

    A stem is every visible limb of some length. Radii are those that were measured, and taper along the midribs.
    """
    radii = _known_radii(skeleton)
    tree, born = Skeleton(skeleton.points, radii, skeleton.parents), np.zeros(len(skeleton), dtype=np.int64)
    for top in _tops(tree):
        fronds = _fronds(tree.points[top], crown, rng)
        first, count = len(tree), len(fronds)
        parents = np.arange(first - 1, first - 1 + count * PIECES).reshape(count, PIECES)
        parents[:, 0] = top
        thick = np.geomspace(*MIDRIB, PIECES) * tree.radii[top]
        tree = Skeleton(
            np.vstack([tree.points, fronds.reshape(-1, 3)]),
            np.concatenate([tree.radii, np.tile(thick, count)]),
            np.concatenate([tree.parents, parents.ravel()]),
        )
        born = np.concatenate([born, np.repeat(np.arange(1, count + 1), PIECES)])
    return Grown(tree, born, np.zeros((0, 3), dtype=np.int64))


def _known_radii(skeleton: Skeleton) -> Floats:
    """Return the radii (n,), metres; joints of unknown radius have their parent's, or that of the thickest joint."""
    radii = skeleton.radii.copy()
    for joint, parent in enumerate(skeleton.parents.tolist()):
        if radii[joint] == 0:
            radii[joint] = radii[parent] if parent >= 0 else radii.max()
    return radii


def _tops(tree: Skeleton) -> list[int]:
    """List the joints that bear fronds: the tips of all stems."""
    arc = path_lengths(tree)
    chains = [limb for limb in limbs(tree, successors_by_wood(tree)) if len(limb) > 1]
    long = [limb for limb in chains if arc[limb[-1]] - arc[limb[0]] >= LEAST_STEM * arc.max()]
    return [int(limb[-1]) for limb in long or chains[:1]] or [len(tree) - 1]


class _Gaps:
    """Points all over the crown as the photo shows it, and how far each is from the nearest frond so far, px."""

    def __init__(self, crown: CrownToFill) -> None:
        step = max(1, round(float(np.sqrt(crown.front.mask.sum() / GAPS))))
        rows, columns = np.nonzero(crown.front.mask[::step, ::step])
        self.points = step * np.stack([columns, rows], axis=1) + 0.5
        self.camera = crown.front.camera
        self.away = np.full(len(self.points), 4.0 * step * np.sqrt(GAPS))

    def choose(self, curves: Floats) -> int:
        """Choose the curve, of (k, PIECES, 3) metres, that shortens the distances most, and take it."""
        spots = self.camera.pixels_from_world(curves.reshape(-1, 3)).reshape(len(curves), -1, 1, 2)
        way = spots - self.points
        nearest = np.sqrt((way[..., 0] ** 2 + way[..., 1] ** 2).min(axis=1))
        best = int(np.argmax(np.maximum(self.away - nearest, 0).sum(axis=1)))
        self.away = np.minimum(self.away, nearest[best])
        return best


def _fronds(top: Floats, crown: CrownToFill, rng: np.random.Generator) -> Floats:
    """Draw the fronds (f, PIECES, 3), metres, that leave a stem's top (3,); those without room are left out."""
    low, high = crown.volume.bounds
    reach = float(np.linalg.norm(np.maximum(np.abs(low - top), np.abs(high - top))))
    start, gaps = rng.uniform(0, 2 * np.pi), _Gaps(crown)
    found = []
    for number in range(FRONDS):
        age = (number + 0.5) / FRONDS
        rise = ELEVATIONS[0] + (ELEVATIONS[1] - ELEVATIONS[0]) * age + rng.normal(0, 0.06)
        curves = _longest(_curves(top, start + number * GOLDEN_RAD, rise, reach), crown)
        if len(curves):
            found.append(curves[gaps.choose(curves)])
    return np.array(found).reshape(-1, PIECES, 3)


def _curves(top: Floats, azimuth: float, rise: float, reach: float) -> Floats:
    """Draw the curves (shares, k, PIECES, 3), metres, that a frond may take, the longest first."""
    droop, swing, lift = (axis.ravel()[:, None] for axis in np.meshgrid(DROOPS, SWINGS, LIFTS, indexing="ij"))
    along = (np.arange(PIECES) + 0.5) / PIECES
    pitch = np.clip(rise + lift - droop * along, -0.49 * np.pi, 0.49 * np.pi)
    level, turn = np.cos(pitch), azimuth + swing
    steps = np.stack([level * np.cos(turn), np.sin(pitch), level * np.sin(turn)], axis=-1)
    return np.asarray(top + (SHARES * reach / PIECES)[:, None, None, None] * np.cumsum(steps, axis=1))


def _longest(curves: Floats, crown: CrownToFill) -> Floats:
    """Choose of each of k curves the longest (m, PIECES, 3) that lies in the crown, of several lengths (shares, k, ...).

    The foot may lie outside. Curves that never fit are left out.
    """
    outer = curves[:, :, int(FREE * PIECES) :]
    points = outer.reshape(-1, 3)
    inside = crown.front.shows(points) & (crown.volume.reach(points) <= 1.0)
    fits = inside.reshape(outer.shape[:3]).all(axis=2)
    some = np.flatnonzero(fits.any(axis=0))
    return np.asarray(curves[fits.argmax(axis=0)[some], some])
