"""Palms: no branches, but a crown of fronds from the top of each stem.

Fronds leave the stem's top one after another, each turned by the golden angle from the one before (phyllotaxis). The
young ones stand, the old ones hang. Each bends down along its length, is as long as the crown lets it be, and goes
where it fills most of what the photo shows (the cost E2D of Tan et al. 2008, section 3.2). A frond's midrib is a limb
of the skeleton; leaves hang on it.
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
RISES, DROOPS, SWINGS = (
    np.radians(angles)
    for angles in ((82.0, 62.0, 42.0, 22.0, 2.0, -18.0, -38.0, -55.0), (15.0, 50.0, 90.0), (0.0, -8.0, 8.0))
)
"""Angles by which a frond may rise where it leaves the stem, bend down along its length and turn aside; of these the
curve that fills most of the crown is taken."""
SHARES = np.arange(20, 3, -1) / 20
"""Lengths that are tried, as shares of the way from the stem's top to the crown's far end, the longest first."""
FREE = 0.25
"""Share of a frond at its foot that may lie outside the crown: the stem's top need not lie in it."""
GAPS = 250
"""About how many points of the crown fronds are to come near."""
PIECES = 12
"""Joints of a frond."""
LEAST_STEM = 0.2
"""Least length of a limb that bears fronds, as a share of the longest path from a root."""
MIDRIB = (0.22, 0.02)
"""Radius of a midrib at its foot and at its tip, as a share of the stem's at its top."""


def grow_palm(skeleton: Skeleton, crown: CrownToFill, rounds: int, rng: np.random.Generator) -> Grown:
    """Set a frond a round, `FRONDS` at most, on each stem of a lifted palm (3D, metres); its own joints stay.

    A stem is every visible limb of some length. Radii are those that were measured, and taper along the midribs.
    """
    radii = _known_radii(skeleton)
    tree, born = Skeleton(skeleton.points, radii, skeleton.parents), np.zeros(len(skeleton), dtype=np.int64)
    for top in _tops(tree):
        fronds = _fronds(tree.points[top], crown, min(rounds, FRONDS), rng)
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


def is_forked(grown: Grown) -> bool:
    """Tell whether a grown palm's stems fork: true palms do not, dracaenas and yuccas do, and these bear straps."""
    tree, visible = grown.skeleton, grown.born == 0
    stems = Skeleton(tree.points[visible], tree.radii[visible], tree.parents[visible])
    return len(_tops(stems)) > int((stems.parents < 0).sum())


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
    """Points all over the crown as the photo shows it, and how far each is from the nearest frond so far, px.

    Each counts twice: as fronds are seen, and as if all were turned into the picture's plane, to the side that they
    point to, so that those that point to the viewer and away spread over the crown, too.
    """

    def __init__(self, crown: CrownToFill, top: Floats) -> None:
        step = max(1, round(float(np.sqrt(crown.front.mask.sum() / GAPS))))
        rows, columns = np.nonzero(crown.front.mask[::step, ::step])
        self.points = step * np.stack([columns, rows], axis=1) + 0.5
        self.camera, self.top = crown.front.camera, top
        self.away = np.full((2, len(self.points)), 4.0 * step * np.sqrt(GAPS))

    def choose(self, curves: Floats) -> int:
        """Choose the curve, of (k, PIECES, 3) metres, that shortens the distances most, and take it."""
        way = curves[:, 1::2] - self.top
        side = np.where(way[:, -1:, 0] < 0, -1.0, 1.0)
        turned = np.stack([side * np.hypot(way[..., 0], way[..., 2]), way[..., 1], np.zeros(way.shape[:2])], axis=-1)
        spots = self.camera.pixels_from_world((np.stack([way, turned]) + self.top).reshape(-1, 3))
        apart = spots.reshape(2, *way.shape[:2], 1, 2) - self.points
        nearest = np.sqrt((apart[..., 0] ** 2 + apart[..., 1] ** 2).min(axis=2))
        best = int(np.argmax(np.maximum(self.away[:, None] - nearest, 0).sum(axis=(0, 2))))
        self.away = np.minimum(self.away, nearest[:, best])
        return best


def _fronds(top: Floats, crown: CrownToFill, most: int, rng: np.random.Generator) -> Floats:
    """Draw the fronds (f, PIECES, 3), metres, that leave a stem's top (3,): ``most``, without those that lack room."""
    low, high = crown.volume.bounds
    reach = float(np.linalg.norm(np.maximum(np.abs(low - top), np.abs(high - top))))
    start, gaps = rng.uniform(0, 2 * np.pi), _Gaps(crown, top)
    found = []
    for number in range(most):
        curves = _longest(_curves(top, start + number * GOLDEN_RAD, reach), crown)
        if len(curves):
            found.append(curves[gaps.choose(curves)])
    return np.array(found).reshape(-1, PIECES, 3)


def _curves(top: Floats, azimuth: float, reach: float) -> Floats:
    """Draw the curves (shares, k, PIECES, 3), metres, that a frond may take, the longest first."""
    rise, droop, swing = (axis.ravel()[:, None] for axis in np.meshgrid(RISES, DROOPS, SWINGS, indexing="ij"))
    along = (np.arange(PIECES) + 0.5) / PIECES
    pitch = np.maximum(rise - droop * along, -0.49 * np.pi)
    level, turn = np.cos(pitch), azimuth + swing
    steps = np.stack([level * np.cos(turn), np.sin(pitch), level * np.sin(turn)], axis=-1)
    return np.asarray(top + (SHARES * reach / PIECES)[:, None, None, None] * np.cumsum(steps, axis=1))


def _longest(curves: Floats, crown: CrownToFill) -> Floats:
    """Choose of each of k curves the longest (m, PIECES, 3) that lies in the crown, of those given (shares, k).

    The foot may lie outside. Curves that never fit are left out.
    """
    outer = curves[:, :, int(FREE * PIECES) :]
    points = outer.reshape(-1, 3)
    inside = crown.front.shows(points) & (crown.volume.reach(points) <= 1.0)
    fits = inside.reshape(outer.shape[:3]).all(axis=2)
    some = np.flatnonzero(fits.any(axis=0))
    return np.asarray(curves[fits.argmax(axis=0)[some], some])
