"""The growing tree: candidates, choice and replacement, one iteration after another."""

import math

import numpy as np

from treestroke.core.grow.branches import Chain, split_chains
from treestroke.core.grow.form import BranchTable
from treestroke.core.grow.growth_space import GrowthSpace, in_mask
from treestroke.core.grow.library import Subtree
from treestroke.core.grow.params import GrowthParams
from treestroke.core.grow.placements import Choice, Evaluator, Rules, Shoot
from treestroke.core.progress import Report
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices

MOST_STRETCH = 6.0
"""Greatest factor by which subtrees on a stem are stretched."""
THINNING = 0.75
"""A shoot's radius over its parent branch's, for the order of candidates (Tan et al. 2008, section 3.2)."""
NARROW = 0.15
"""Low sections narrower than this share of the crown's greatest radius are a stem that the foliage mask includes."""
PATIENCE = 10.0
"""Times that a branch is a candidate without being chosen before it counts as one generation later."""


class Growing:
    """The growing tree: its branches as columns, filled up to ``count``, and the evaluator that measures them."""

    def __init__(
        self,
        visible: Skeleton,
        space: GrowthSpace,
        library: tuple[Subtree, ...],
        params: GrowthParams,
        evaluator: Evaluator,
    ) -> None:
        self.params, self.space, self.library = params, space, library
        self.foot, self.top = float(space.foot[1]), float(np.flatnonzero(space.mask.any(axis=1))[0])
        self.evaluator = evaluator
        self.on_limbs = np.array([[float(tree.replaces != "stem") for tree in library]])
        self.chains = _chains(visible, space, params)
        self.count = len(self.chains)
        room = self.count + params.iterations * max(len(subtree.parents) for subtree in library)
        self.bases, self.tips = np.zeros((2, room, 3))
        self.radius, self.fraction, self.passed_over = np.zeros((3, room))
        self.generation, self.parent, self.born = np.full((3, room), -1)
        self.open = np.zeros(room, dtype=bool)
        self._add_chains(visible)
        self._tell_evaluator(0)
        self.evaluator.add_attractors(space.grid(params.attractors))
        self.evaluator.add_attractors(space.depths)

    def run(self, rng: np.random.Generator, report: Report) -> list[tuple[int, int, int]]:
        """Replace branch after branch; list the (branch, subtree, angle) chosen."""
        choices = []
        for iteration in range(1, self.params.iterations + 1):
            choice = self._choose(iteration, rng)
            if choice.branch >= 0:
                choices.append((choice.branch, choice.subtree, choice.angle))
                self._replace(choice, iteration)
            report("grow", iteration / self.params.iterations)
        return choices

    def table(self) -> BranchTable:
        """Return the branches as arrays."""
        filled = slice(0, self.count)
        # Rounded, so that shoots that stand together share a joint.
        return BranchTable(
            self.parent[filled], np.round(self.fraction[filled], 6), self.tips[filled], self.born[filled]
        )

    def _add_chains(self, visible: Skeleton) -> None:
        """Fill the columns with the visible branches; a stem counts as thick up to its top, so that it comes first."""
        known = _known_radii(visible)
        for i, chain in enumerate(self.chains):
            self.bases[i], self.tips[i] = visible.points[chain.joints[[0, -1]]]
            self.radius[i], self.generation[i] = known[chain.joints].mean(), chain.generation
            self.radius[i] = known.max() if chain.generation == 1 else self.radius[i]
            middle = (self.bases[i] + self.tips[i]) / 2
            grows = in_mask(np.array([self.tips[i], middle]), self.space.mask).all()
            self.open[i] = grows and self._is_long(i) and not self._under_the_crown(float(middle[1]))
        self._close_stems()
        self.born[: self.count] = 0

    def _close_stems(self) -> None:
        """Let limbs leave the stems only where the habit lets them, unless none could then."""
        low, high = self.params.habit.leave
        stems = np.flatnonzero(self.open & (self.generation == 1))
        height = self._heights(stems)
        bare = (height < low) | (height > high)
        if not bare.all():
            self.open[stems[bare]] = False

    def _heights(self, branches: Indices | slice) -> Floats:
        """Return the heights (k,) of branches' middles in the crown: 0 where the stem enters it, 1 at its top."""
        middles = (self.bases[branches, 1] + self.tips[branches, 1]) / 2
        return np.asarray((self.foot - middles) / max(self.foot - self.top, 1.0))

    def _is_long(self, branch: int) -> bool:
        """Tell whether a branch is at least two samples long, so that it may be replaced."""
        chord = self.tips[branch] - self.bases[branch]
        return math.sqrt(float(chord @ chord)) >= 2 * self.params.spacing_px * self.space.unit

    def _under_the_crown(self, y: float) -> bool:
        """Tell whether a height (y, px) is below the crown's bulk, where its section is no wider than a stem."""
        radius = self.space.sections.radius_px
        narrow = radius[int(np.clip(y, 0, len(radius) - 1))] < NARROW * float(radius.max())
        return bool(narrow and y > int(np.argmax(radius)))

    def _choose(self, iteration: int, rng: np.random.Generator) -> Choice:
        """Find the best placement by this iteration's cost, or else by the other."""
        candidates = self._candidates(rng)
        orders = {"image": (False,), "space": (True,), "alternating": (iteration % 2 == 0, iteration % 2 == 1)}
        choice = Choice(-1, 0, 0, 0.0)
        for in_space in orders[self.params.mode]:
            if choice.branch < 0:
                choice = self.evaluator.best(candidates, in_space)
        return choice

    def _candidates(self, rng: np.random.Generator) -> Indices:
        """Walk the branches from thick to thin, taking each with a probability inverse to its generation."""
        left = np.flatnonzero(self.open[: self.count])
        left = left[np.argsort(-self.radius[left], kind="stable")]
        rank = self.generation[left] + self.passed_over[left] / PATIENCE
        chosen = np.zeros(0, dtype=np.int64)
        while len(left) and len(chosen) < self.params.candidates:
            takes = rng.random(len(left)) * rank < 1
            chosen = np.concatenate([chosen, left[takes]])
            left, rank = left[~takes], rank[~takes]
        chosen = np.sort(chosen[: self.params.candidates])
        self.passed_over[chosen] += 1
        return chosen

    def _replace(self, choice: Choice, iteration: int) -> None:
        """Add the shoots of a placement to a branch."""
        first = self.count
        self.open[choice.branch] = False
        for shoot in self.evaluator.place(choice):
            self._add(shoot, choice.branch if shoot.parent < 0 else first + shoot.parent, iteration)
        if self.count > first:
            self._tell_evaluator(first)

    def _add(self, shoot: Shoot, parent: int, iteration: int) -> None:
        """Fill the next row with a shoot."""
        i = self.count
        self.bases[i], self.tips[i] = shoot.base, shoot.tip
        self.parent[i], self.fraction[i], self.born[i] = parent, min(shoot.fraction, 1.0), iteration
        self.generation[i] = self.generation[parent] + 1
        self.radius[i] = self.radius[parent] * THINNING
        self.open[i] = self._is_long(i)
        self.count += 1

    def _tell_evaluator(self, first: int) -> None:
        """Pass the branches from ``first`` on to the evaluator."""
        new = slice(first, self.count)
        scales = np.repeat(self.on_limbs, self.count - first, axis=0)
        for stem in np.flatnonzero(self.generation[new] == 1).tolist():
            scales[stem] = self._stem_scales(first + stem)
        steering = self.params.habit.steering(self.generation[new], self._heights(new))
        self.evaluator.add_branches(self.bases[new], self.tips[new], scales, steering)

    def _stem_scales(self, branch: int) -> Floats:
        """Stretch each subtree (s,) on a stem so that its longest shoot would reach the crown's edge; 0 forbids it.

        Where the habit lets limbs rise far, they reach for a share of the height above them.
        """
        middle, chord = (self.bases[branch] + self.tips[branch]) / 2, self.tips[branch] - self.bases[branch]
        row = int(np.clip(middle[1], 0, len(self.space.mask) - 1))
        above = self.params.habit.stretch * (row - self.top)
        reach = max(float(self.space.sections.radius_px[row]), above) / max(math.sqrt(float(chord @ chord)), 1e-9)
        stretch = [min(max(reach / tree.longest, 1.0), MOST_STRETCH) for tree in self.library]
        return np.where([tree.replaces != "limb" for tree in self.library], stretch, 0.0)


def rules_for(params: GrowthParams, unit: float) -> Rules:
    """Scale the figures of a placement to the crown's pixels."""
    return Rules(
        params.spacing_px * unit, params.closeness_px * unit, params.keep_share, params.inward_cosine, params.angles
    )


def _chains(visible: Skeleton, space: GrowthSpace, params: GrowthParams) -> list[Chain]:
    """Split the visible tree into chains, px."""
    rows = np.flatnonzero(space.mask.any(axis=1))
    height = float(rows[-1] - rows[0] + 1)
    longest = params.stem_piece * height, params.limb_piece * height
    return split_chains(visible, in_mask(visible.points, space.mask), longest)


def _known_radii(visible: Skeleton) -> Floats:
    """Return the radii (n,), px, where joints of unknown radius have their parent's."""
    radii = visible.radii.copy()
    for joint, parent in enumerate(visible.parents.tolist()):
        if radii[joint] == 0 and parent >= 0:
            radii[joint] = radii[parent]
    return radii
