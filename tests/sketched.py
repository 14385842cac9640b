"""Sketched pairs in sketch units: x right, y up, the root at the origin, a height of 1000; each drawn for itself."""

from collections.abc import Callable, Sequence

import numpy as np

from treestroke.core.skeleton.branched import Branched
from treestroke.core.skeleton.skeleton import Skeleton

Pair = tuple[Branched, Branched]
Curve = Callable[[float], tuple[float, float]]
Stroke = tuple[int, int, Sequence[tuple[float, float]]]
"""Parent branch, joint of that branch, and the further points."""


def sketched(stem: Sequence[tuple[float, float]], *strokes: Stroke, radii: Sequence[float] = ()) -> Branched:
    """Draw by hand: a stem from the root, then strokes; ``radii`` by branch, 0 where there is none."""
    points, parents, branch = [(0.0, 0.0), *stem], list(range(-1, len(stem))), [0] * (len(stem) + 1)
    chains = [list(range(len(points)))]
    for number, (parent, joint, line) in enumerate(strokes, start=1):
        first = len(points)
        points += line
        parents += [chains[parent][joint], *range(first, first + len(line) - 1)]
        branch += [number] * len(line)
        chains.append(list(range(first, first + len(line))))
    widths = np.array([radii[b] if b < len(radii) else 0.0 for b in branch])
    return Branched(Skeleton(np.array(points, dtype=np.float64), widths, np.array(parents)), np.array(branch))


def neat() -> Pair:
    """Draw a stem with two limbs on the front and two of the same heights on the side."""
    stem = [(0.0, 300.0), (0.0, 500.0), (0.0, 1000.0)]
    front = sketched(stem, (0, 1, [(250.0, 600.0)]), (0, 2, [(-200.0, 800.0)]))
    side = sketched(stem, (0, 1, [(-150.0, 450.0), (-180.0, 600.0)]), (0, 2, [(250.0, 800.0)]))
    return front, side


class Pen:
    """Draws strokes with a trembling hand, point by point."""

    def __init__(self, seed: int, tremble: float = 1.0, spacing: float = 8.0) -> None:
        self.rng = np.random.default_rng(seed)
        self.tremble, self.spacing = tremble, spacing
        self.points, self.parents, self.branch, self.radii = [np.zeros(2)], [-1], [0], [0.0]
        self.chains: list[list[int]] = [[0]]

    def stroke(
        self,
        parent: int,
        share: float,
        curve: Curve,
        length: float,
        radius: float = 0.0,
    ) -> int:
        """Draw a branch from a share of its parent along ``curve`` (t from 0 to 1 -> offset); parent -1: the stem."""
        joint = 0 if parent < 0 else self.chains[parent][round(share * (len(self.chains[parent]) - 1))]
        number = 0 if parent < 0 else len(self.chains)
        if parent >= 0:
            self.chains.append([])
        start, phase = self.points[joint], self.rng.uniform(0, 2 * np.pi, 4)
        steps = max(int(length / self.spacing), 3)
        for t in np.arange(1, steps + 1) / steps:
            waves = np.sin(phase + t * length / np.array([35.0, 60.0, 45.0, 90.0]))
            shake = self.tremble * min(1.0, 4 * t) * np.array([waves[0] + 2 * waves[1], waves[2] + 2 * waves[3]])
            self.points.append(start + np.array(curve(float(t))) + shake)
            self.parents.append(self.chains[number][-1] if self.chains[number] else joint)
            self.branch.append(number)
            self.radii.append(radius * (1 - 0.7 * t))
            self.chains[number].append(len(self.points) - 1)
        return number

    def drawn(self) -> Branched:
        """Scale what was drawn to a height of 1000."""
        points = np.array(self.points)
        scale = 1000.0 / points[:, 1].max()
        return Branched(
            Skeleton(points * scale, np.array(self.radii) * scale, np.array(self.parents)), np.array(self.branch)
        )


def broadleaf(limbs: int, seed: int, twigs: int = 2, radius: float = 0.0) -> Branched:
    """Draw a stem with rising limbs that droop at their tips, each with sub-limbs."""
    pen = Pen(seed, tremble=2.0)
    rng = pen.rng
    sway = rng.uniform(-40, 40)
    pen.stroke(-1, 0.0, lambda t: (sway * np.sin(3 * t), 1000 * t), 1000, radius)
    for i in range(limbs):
        share = 0.25 + 0.6 * (i + rng.uniform(0.0, 0.8)) / limbs
        out = (1 if (i + seed) % 2 else -1) * rng.uniform(180, 380) * (1.2 - 0.7 * share)
        rise, droop = abs(out) * rng.uniform(0.35, 1.1), rng.uniform(0, 60)
        limb = pen.stroke(0, share, _arch(out, rise, droop), abs(out) + rise, 0.5 * radius)
        for _ in range(twigs):
            aside = np.sign(out) * rng.uniform(30, 120)
            up = rng.uniform(-60, 140) * (1.05 - share)
            pen.stroke(limb, rng.uniform(0.3, 0.8), _arch(aside, up, 15), abs(aside) + abs(up), 0.25 * radius)
    return pen.drawn()


def _arch(out: float, rise: float, droop: float) -> Curve:
    return lambda t: (out * t, rise * np.sin(0.5 * np.pi * t) - droop * t**3)


def _bough(out: float, tilt: float, lift: float) -> Curve:
    return lambda t: (out * t, abs(out) * tilt * t + lift * t**3)


def _willow(out: float, rise: float, hang: float) -> Curve:
    return lambda t: (out * np.sin(0.5 * np.pi * t), 2.2 * rise * np.sin(np.pi * t) - hang * t**2)


def _cordon(out: float) -> Curve:
    return lambda t: (out * t, 30 * np.sin(2 * t))


def _shoot(aside: float, up: float) -> Curve:
    return lambda t: (aside * t * t, up * t)


def pine(limbs: int, seed: int) -> Branched:
    """Draw a straight stem with many near-level limbs, shorter toward the top."""
    pen = Pen(seed, tremble=1.0)
    rng = pen.rng
    pen.stroke(-1, 0.0, lambda t: (0.0, 1000 * t), 1000)
    for i in range(limbs):
        share = 0.15 + 0.8 * (i + rng.uniform(0, 0.6)) / limbs
        out = (1 if i % 2 else -1) * (60 + 260 * (1 - share)) * rng.uniform(0.8, 1.2)
        tilt, lift = rng.uniform(-0.35, 0.1), rng.uniform(0, 30)
        pen.stroke(0, share, _bough(out, tilt, lift), abs(out))
    return pen.drawn()


def weeping(limbs: int, seed: int) -> Branched:
    """Draw limbs that rise, arch over and hang below their bud, some below the root."""
    pen = Pen(seed, tremble=1.5)
    rng = pen.rng
    pen.stroke(-1, 0.0, lambda t: (20 * np.sin(4 * t), 900 * t), 900)
    for i in range(limbs):
        share = 0.45 + 0.5 * (i + rng.uniform(0, 0.8)) / limbs
        out = (1 if i % 2 else -1) * rng.uniform(120, 330)
        rise, hang = rng.uniform(60, 140), rng.uniform(350, 950 * share)
        pen.stroke(0, share, _willow(out, rise, hang), hang + rise)
    return pen.drawn()


def vine(side: bool, seed: int) -> Branched:
    """Draw a short stem, a long level cordon to either side (short ones on the side view), and upright shoots."""
    pen = Pen(seed, tremble=2.0)
    rng = pen.rng
    pen.stroke(-1, 0.0, lambda t: (15 * np.sin(5 * t), 520 * t), 520)
    for sign in (-1, 1):
        out = sign * (rng.uniform(60, 110) if side else rng.uniform(600, 800))
        arm = pen.stroke(0, 0.97, _cordon(out), abs(out))
        for k in range(2 if side else 6):
            aside, up = rng.uniform(-60, 60), rng.uniform(300, 500)
            pen.stroke(arm, (k + 0.8) / (2 if side else 6), _shoot(aside, up), up)
    return pen.drawn()


def tuning_pairs() -> dict[str, Pair]:
    """Draw the pairs that the costs of retrieval were tuned on, by name."""
    return {
        "neat": neat(),
        "broad 9/6": (broadleaf(9, 1), broadleaf(6, 2)),
        "broad 7/7": (broadleaf(7, 3), broadleaf(7, 4)),
        "broad 5/11": (broadleaf(5, 5, twigs=3), broadleaf(11, 6, twigs=1)),
        "brush 8/7": (broadleaf(8, 7, radius=16.0), broadleaf(7, 8, radius=14.0)),
        "pine 24/18": (pine(24, 9), pine(18, 10)),
        "weeping 9/7": (weeping(9, 11), weeping(7, 12)),
        "vine": (vine(False, 13), vine(True, 14)),
        "same": (broadleaf(8, 15), broadleaf(8, 15)),
        "broad 30/30": (broadleaf(10, 16), broadleaf(10, 17)),
    }


def held_out_pairs(seed: int) -> dict[str, Pair]:
    """Draw pairs of the same kinds that nothing was tuned on, by name; take seeds from 100 on."""
    return {
        f"broad 9/6, {seed}": (broadleaf(9, seed), broadleaf(6, seed + 1)),
        f"broad 7/7, {seed}": (broadleaf(7, seed + 2), broadleaf(7, seed + 3)),
        f"broad 5/11, {seed}": (broadleaf(5, seed + 4, twigs=3), broadleaf(11, seed + 5, twigs=1)),
        f"brush 8/7, {seed}": (broadleaf(8, seed + 6, radius=16.0), broadleaf(7, seed + 7, radius=14.0)),
        f"pine 24/18, {seed}": (pine(24, seed + 8), pine(18, seed + 9)),
        f"weeping 9/7, {seed}": (weeping(9, seed + 10), weeping(7, seed + 11)),
        f"vine, {seed}": (vine(False, seed + 12), vine(True, seed + 13)),
    }
