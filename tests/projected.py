"""Known 3D trees in sketch units (root at the origin, y up, a height of 1000), and sketches drawn from them by hand."""

from dataclasses import dataclass

import numpy as np
from tests.sketched import Pair

from treestroke.core.geometry.polyline import arc_lengths, place_at
from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats

GOLDEN_RAD = np.pi * (3 - np.sqrt(5.0))
SPACING = 8.0
WITHIN = 50.0
"""Distance, units (5 % of the height), within which a place of a tree counts as recovered."""


class Builder:
    """Builds a 3D tree of limbs that leave their parent at an azimuth and rise and droop as given."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)
        bend = self.rng.uniform(-25, 25, 2)
        t = np.arange(0, 1001, SPACING)
        stem = np.stack([bend[0] * np.sin(t / 400), t * 1000 / t[-1], bend[1] * np.sin(t / 300)], axis=1)
        self.points, self.parents, self.branch = list(stem), list(range(-1, len(stem) - 1)), [0] * len(stem)
        self.chains = [list(range(len(stem)))]

    def limb(self, parent: int, share: float, azimuth: float, out: float, rise: float, droop: float = 0.0) -> int:
        """Add a limb at a share of its parent: it reaches ``out`` sideways and ``rise`` up, less ``droop``."""
        bud = self.chains[parent][round(share * (len(self.chains[parent]) - 1))]
        count = max(int(np.hypot(out, rise) / SPACING), 4)
        first, number = len(self.points), len(self.chains)
        for t in np.arange(1, count + 1) / count:
            up = rise * np.sin(0.5 * np.pi * t) - droop * t**3
            sideways = out * t * np.array([np.cos(azimuth), np.sin(azimuth)])
            self.points.append(self.points[bud] + np.array([sideways[0], up, sideways[1]]))
            self.parents.append(bud if t * count < 1.5 else len(self.points) - 2)
            self.branch.append(number)
        self.chains.append(list(range(first, len(self.points))))
        return number

    def tree(self) -> Branched:
        """Return the tree, scaled to a height of 1000."""
        points = np.array(self.points)
        points *= 1000.0 / points[:, 1].max()
        return Branched(Skeleton(points, np.zeros(len(points)), np.array(self.parents)), np.array(self.branch))


def spiral(limbs: int, seed: int) -> Branched:
    """Build rising limbs at the golden angle, each with a side limb."""
    made = Builder(seed)
    for i in range(limbs):
        share = 0.25 + 0.6 * i / limbs
        out = made.rng.uniform(220, 360) * (1.2 - 0.7 * share)
        rise, azimuth = out * made.rng.uniform(0.4, 1.0), GOLDEN_RAD * i + made.rng.uniform(-0.3, 0.3)
        limb = made.limb(0, share, azimuth, out, rise, made.rng.uniform(0, 40))
        made.limb(limb, 0.5, azimuth + made.rng.choice([-1, 1]) * 0.9, 0.45 * out, 0.3 * rise)
    return made.tree()


def whorled(whorls: int, seed: int) -> Branched:
    """Build whorls of four limbs whose buds are a little apart, longer ones below."""
    made = Builder(seed)
    for i in range(whorls):
        turn = made.rng.uniform(0, np.pi)
        for k in range(4):
            share = 0.25 + 0.65 * (i + 0.2 * k) / whorls
            out = 300 * (1.15 - share) * made.rng.uniform(0.8, 1.2)
            made.limb(0, share, turn + 0.5 * np.pi * k, out, out * made.rng.uniform(0.2, 0.9))
    return made.tree()


def arched(limbs: int, seed: int) -> Branched:
    """Build limbs that rise, arch over and droop below their buds."""
    made = Builder(seed)
    for i in range(limbs):
        out, rise = made.rng.uniform(160, 300), made.rng.uniform(60, 140)
        droop = rise + made.rng.uniform(100, 350)
        made.limb(0, 0.45 + 0.45 * i / limbs, GOLDEN_RAD * i + made.rng.uniform(-0.3, 0.3), out, rise, droop)
    return made.tree()


def drawn_from(tree: Branched, seed: int, tremble: float = 2.0) -> Pair:
    """Draw a tree's front and left side, each with a trembling hand of its own."""
    rng = np.random.default_rng(seed)
    front, side = (_drawn(tree, axis, rng, tremble) for axis in (0, 2))
    return front, side


def _drawn(tree: Branched, axis: int, rng: np.random.Generator, tremble: float) -> Branched:
    points = tree.skeleton.points[:, [axis, 1]].copy()
    for number, chain in enumerate(tree.chains()):
        along = arc_lengths(tree.skeleton.points[chain])
        waves = np.sin(rng.uniform(0, 2 * np.pi, 4) + along[:, None] / np.array([35.0, 60.0, 45.0, 90.0]))
        own = chain[tree.branch[chain] == number]
        points[own] += tremble * (waves @ np.array([[1, 0], [2, 0], [0, 1], [0, 2]]))[-len(own) :]
    points -= points[0]
    return Branched(
        Skeleton(points * 1000.0 / points[:, 1].max(), tree.skeleton.radii, tree.skeleton.parents), tree.branch
    )


@dataclass(frozen=True)
class Recovery:
    """Shares (0 to 1) of the limbs' length: of the true tree near the retrieved one, and the other way round."""

    recalled: float
    precise: float


def recovery(true: Branched, found: Branched) -> Recovery:
    """Measure how much of the limbs' length of two 3D trees lies within `WITHIN` units of the other tree."""
    return Recovery(_near(_places(true), _places(found, stem=True)), _near(_places(found), _places(true, stem=True)))


def crossed_planes(pair: Pair) -> Branched:
    """Join a front and a side without any depth: each stays in its plane through the stem."""
    front, side = (sketch.skeleton for sketch in pair)
    flat = [np.insert(front.points, 2, 0.0, axis=1), np.insert(side.points, 0, 0.0, axis=1)]
    later = np.where(side.parents < 0, 0, side.parents + len(front))
    branch = np.concatenate([pair[0].branch, pair[1].branch + pair[0].branch.max() + 1])
    return Branched(
        Skeleton(np.vstack(flat), np.concatenate([front.radii, side.radii]), np.append(front.parents, later)), branch
    )


def _places(tree: Branched, stem: bool = False) -> Floats:
    """Return places (m, 3) every 8 units along all limbs, and the stem if told."""
    chains = tree.chains()[0 if stem else 1 :]
    lines = [tree.skeleton.points[chain] for chain in chains if len(chain) > 1]
    return np.concatenate([place_at(line, np.arange(0, arc_lengths(line)[-1], SPACING)) for line in lines])


def _near(places: Floats, others: Floats) -> float:
    """Return the share of places (n, 3) within `WITHIN` units of the others (m, 3)."""
    from scipy.spatial import cKDTree

    return float((cKDTree(others).query(places)[0] <= WITHIN).mean())
