"""Growth by replacement: branch after branch takes the subtree that best fills the crown.

Tan, Fang, Xiao, Zhao and Quan 2008, sections 3.1 and 3.2, with these changes, each measured: a branch is replaced
once, so that limbs do not become bottle brushes; pruning is part of the evaluation, else the same pruned winner wins
again and again; a shoot that leaves the crown is clipped, and the crown bounds depth too; shoots that grow inward
go; subtrees on a stem are stretched toward the crown's edge.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import Floats
from treestroke.core.geometry.envelope import Envelope
from treestroke.core.grow.branches import Chain, split_chains
from treestroke.core.grow.crown import Crown, crown_of, in_mask, pixels_of, world_of
from treestroke.core.grow.evaluator import Choice, Evaluator, Rules, Shoot, evaluator_for
from treestroke.core.grow.form import BranchTable, curved
from treestroke.core.grow.library import Kind, Subtree
from treestroke.core.grow.radii import pipe_radii
from treestroke.core.grow.stem import foot_of, with_leader
from treestroke.core.progress import Report, silent
from treestroke.core.skeleton.skeleton import Indices, Skeleton

MOST_STRETCH = 6.0
THINNING = 0.75
"""A shoot's radius over its bearer's, for the order of candidates (the paper's rule)."""
REACHED_PX = 10.0
NARROW = 0.15
"""Of the crown's greatest radius: a lower section narrower than this is a stem that the foliage mask took in."""
PATIENCE = 10.0
"""Times a branch may stand as a candidate in vain before it stands as if it were one generation later."""


@dataclass(frozen=True)
class GrowthParams:
    """How to grow; px are those of a crown 1,000 px wide.

    Attributes
    ----------
    iterations
        Replacements tried.
    attractors
        Image attractors, about.
    candidates
        Branches compared in an iteration.
    angles
        Turns of each subtree about its branch.
    mode
        Attractors in use: those of the image, those in space, or both in alternation.
    spacing_px
        Between the samples of a branch.
    closeness_px
        Least distance of a shoot's outer half from the rest of the tree.
    keep_share
        A shoot clipped at the crown's edge to less than this share of its length is dropped.
    inward_cosine
        Least cosine between a shoot and the way from the crown's foot to its middle.
    stem_piece, limb_piece
        Longest piece of a visible stem or limb that is one branch, as a share of the crown's height.
    leader
        Share of the crown's height to which the first stem is carried on where no visible limb reaches it.
    tip_px
        Radius of the thinnest twigs.
    """

    iterations: int = 300
    attractors: int = 2000
    candidates: int = 20
    angles: int = 12
    mode: Literal["alternating", "image", "space"] = "alternating"
    spacing_px: float = 6.0
    closeness_px: float = 10.0
    keep_share: float = 0.5
    inward_cosine: float = 0.0
    stem_piece: float = 0.2
    limb_piece: float = 0.2
    leader: float = 0.65
    tip_px: float = 0.9

    def __post_init__(self) -> None:
        if self.iterations < 0 or min(self.attractors, self.candidates, self.angles) < 1:
            raise ValueError(f"growth needs iterations >= 0 and attractors, candidates and angles >= 1, got {self}")
        if self.mode not in ("alternating", "image", "space"):
            raise ValueError(f"the mode is alternating, image or space, not {self.mode!r}")
        if min(self.spacing_px, self.closeness_px, self.tip_px, self.stem_piece, self.limb_piece) <= 0:
            raise ValueError(f"spacing, closeness, tip and pieces must be positive, got {self}")
        if not (0 < self.keep_share <= 1 and -1 <= self.inward_cosine <= 1 and 0 <= self.leader <= 1):
            raise ValueError(f"keep share, inward cosine or leader is out of range in {self}")


@dataclass(frozen=True, eq=False)
class Grown:
    """A grown tree.

    Attributes
    ----------
    skeleton
        The whole tree, 3D, metres, world frame, with radii by the pipe model.
    born
        (n,) iteration at which each joint appeared, from 1; 0 for those of the visible tree.
    choices
        (k, 3) the branch, subtree and angle of each replacement.
    attractors_reached
        Share of the image attractors within 10 px (of a crown 1,000 px wide) of a branch.
    """

    skeleton: Skeleton
    born: Indices
    choices: Indices
    attractors_reached: float


def growth_for(kind: Kind, iterations: int = 300) -> GrowthParams:
    """Fit the figures to what the twigs bear: a conifer has one leader and many whorls, a bare tree finer twigs."""
    if kind == "needles":
        return GrowthParams(iterations, stem_piece=0.07, leader=0.98, inward_cosine=-0.35)
    if kind == "bare":
        return GrowthParams(iterations, attractors=4000, closeness_px=6.0, tip_px=0.6, limb_piece=0.14)
    return GrowthParams(iterations)


def grow(
    skeleton: Skeleton,
    mask: NDArray[np.bool_],
    envelope: Envelope,
    library: tuple[Subtree, ...],
    params: GrowthParams,
    rng: np.random.Generator,
    report: Report = silent,
) -> Grown:
    """Fill the crown of a lifted tree (3D, metres, measured radii) with branches.

    ``mask`` (height, width) is the foliage with its holes closed, ``envelope`` how deep it is. New joints project
    into the mask and lie within the envelope; visible joints stay where they are.

    Raises
    ------
    ValueError
        The mask is empty or does not fit the envelope, or the library is empty.
    """
    if not library:
        raise ValueError("growth needs at least one subtree")
    camera = envelope.camera
    scale = camera.metres_per_pixel
    visible = Skeleton(pixels_of(skeleton.points, camera), skeleton.radii / scale, skeleton.parents)
    visible = with_leader(visible, mask, envelope, params.leader)
    crown = crown_of(mask, envelope, foot_of(visible, mask))
    growth = _Growth(visible, crown, library, params)
    choices = growth.run(rng, report)
    form = curved(visible, len(skeleton), growth.chains, growth.table(), crown, rng)
    radii = pipe_radii(form.points, form.parents, form.measured, params.tip_px * crown.unit)
    distances = growth.evaluator.image_distances()
    return Grown(
        Skeleton(world_of(form.points, camera), radii * scale, form.parents),
        form.born,
        np.array(choices, dtype=np.int64).reshape(-1, 3),
        float((distances <= REACHED_PX * crown.unit).mean()) if len(distances) else 0.0,
    )


class _Growth:
    """The growing tree: its branches as columns, filled up to ``count``, and the evaluator that measures them."""

    def __init__(self, visible: Skeleton, crown: Crown, library: tuple[Subtree, ...], params: GrowthParams) -> None:
        self.params, self.crown, self.library = params, crown, library
        self.evaluator: Evaluator = evaluator_for(crown, library, _rules(params, crown.unit))
        self.chains = _chains(visible, crown, params)
        self.count = len(self.chains)
        room = self.count + params.iterations * max(len(subtree.parents) for subtree in library)
        self.bases, self.tips = np.zeros((2, room, 3))
        self.radius, self.fraction, self.stood = np.zeros((3, room))
        self.generation, self.bearer, self.born = np.full((3, room), -1)
        self.open = np.zeros(room, dtype=bool)
        self._add_chains(visible)
        self._tell_evaluator(0)
        self.evaluator.add_attractors(crown.grid(params.attractors))
        self._turn_tips(0)

    def run(self, rng: np.random.Generator, report: Report) -> list[tuple[int, int, int]]:
        """Replace branch after branch; list what was chosen."""
        choices = []
        for iteration in range(1, self.params.iterations + 1):
            choice = self._choose(iteration, rng)
            if choice.branch >= 0:
                choices.append((choice.branch, choice.subtree, choice.angle))
                self._replace(choice, iteration)
            report("grow", iteration / self.params.iterations)
        return choices

    def table(self) -> BranchTable:
        """Give the branches as arrays."""
        own = slice(0, self.count)
        return BranchTable(self.bearer[own], self.fraction[own], self.tips[own], self.born[own])

    def _add_chains(self, visible: Skeleton) -> None:
        """Fill the columns with the visible branches."""
        known = _known_radii(visible)
        for i, chain in enumerate(self.chains):
            self.bases[i], self.tips[i] = visible.points[chain.joints[[0, -1]]]
            self.radius[i], self.generation[i] = known[chain.joints].mean(), chain.generation
            middle = (self.bases[i] + self.tips[i]) / 2
            grows = in_mask(np.array([self.tips[i], middle]), self.crown.mask).all()
            self.open[i] = grows and self._is_long(i) and not self._under_the_crown(float(middle[1]))
        self.born[: self.count] = 0

    def _is_long(self, branch: int) -> bool:
        """Tell whether a branch is some samples long, so that it may be replaced."""
        way = self.tips[branch] - self.bases[branch]
        return math.sqrt(float(way @ way)) >= 2 * self.params.spacing_px * self.crown.unit

    def _under_the_crown(self, y: float) -> bool:
        """Tell whether the crown is no wider at a height (y, px) than a stem might be, with its bulk above."""
        radius = self.crown.radius
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
        chosen = np.zeros(0, dtype=np.int64)
        while len(left) and len(chosen) < self.params.candidates:
            takes = rng.random(len(left)) * (self.generation[left] + self.stood[left] / PATIENCE) < 1
            chosen = np.concatenate([chosen, left[takes]])
            left = left[~takes]
        chosen = np.sort(chosen[: self.params.candidates])
        self.stood[chosen] += 1
        return chosen

    def _replace(self, choice: Choice, iteration: int) -> None:
        """Let a branch bear the shoots of a placement."""
        first = self.count
        self.open[choice.branch] = False
        for shoot in self.evaluator.place(choice):
            self._add(shoot, choice.branch if shoot.parent < 0 else first + shoot.parent, iteration)
        if self.count > first:
            self._tell_evaluator(first)
            self._turn_tips(first)

    def _add(self, shoot: Shoot, bearer: int, iteration: int) -> None:
        """Fill the next row with a shoot."""
        i = self.count
        self.bases[i], self.tips[i] = shoot.base, shoot.tip
        self.bearer[i], self.fraction[i], self.born[i] = bearer, min(shoot.fraction, 1.0), iteration
        self.generation[i] = self.generation[bearer] + 1
        self.radius[i] = self.radius[bearer] * THINNING
        self.open[i] = self._is_long(i)
        self.count += 1

    def _tell_evaluator(self, first: int) -> None:
        """Hand the branches from ``first`` on to the evaluator."""
        own = slice(first, self.count)
        scales = np.array([[tree.bearer != "stem" for tree in self.library]] * (self.count - first), dtype=np.float64)
        for stem in np.flatnonzero(self.generation[own] == 1).tolist():
            scales[stem] = self._stem_scales(first + stem)
        self.evaluator.add_branches(self.bases[own], self.tips[own], scales)

    def _stem_scales(self, branch: int) -> Floats:
        """Stretch each subtree (s,) on a stem so that its longest shoot would reach the crown's edge; 0 forbids it."""
        middle, way = (self.bases[branch] + self.tips[branch]) / 2, self.tips[branch] - self.bases[branch]
        row = int(np.clip(middle[1], 0, len(self.crown.radius) - 1))
        reach = float(self.crown.radius[row]) / max(math.sqrt(float(way @ way)), 1e-9)
        stretch = [min(max(reach / tree.longest, 1.0), MOST_STRETCH) for tree in self.library]
        return np.where([tree.bearer != "limb" for tree in self.library], stretch, 0.0)

    def _turn_tips(self, first: int) -> None:
        """Add the tips from ``first`` on, turned by a quarter, to the attractors in space."""
        self.evaluator.add_attractors(self.crown.turned(self.tips[first : self.count]))


def _rules(params: GrowthParams, unit: float) -> Rules:
    """Scale the figures of a placement to the photo."""
    return Rules(
        params.spacing_px * unit, params.closeness_px * unit, params.keep_share, params.inward_cosine, params.angles
    )


def _chains(visible: Skeleton, crown: Crown, params: GrowthParams) -> list[Chain]:
    """Split the visible tree into chains, px."""
    rows = np.flatnonzero(crown.mask.any(axis=1))
    height = float(rows[-1] - rows[0] + 1)
    longest = params.stem_piece * height, params.limb_piece * height
    return split_chains(visible, in_mask(visible.points, crown.mask), longest)


def _known_radii(visible: Skeleton) -> Floats:
    """Give joints (n,) of unknown radius their parent's."""
    radii = visible.radii.copy()
    for joint, parent in enumerate(visible.parents.tolist()):
        if radii[joint] == 0 and parent >= 0:
            radii[joint] = radii[parent]
    return radii
