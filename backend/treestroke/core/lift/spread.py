"""Lifts a traced tree to 3D: turns each limb out of the picture, away from the others.

Source: Tan et al. 2008, section 3.1, after Okabe, Owada and Igarashi 2005: from root to tips, greedily, each branch is
turned so that the distances among branches are as large as possible. Unbounded, this throws limbs far in front of
the crown, so slopes are limited and, where there is crown, depth stays inside the crown turned about its middle.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.skeleton.measure import edge_lengths
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.skeleton.traverse import accumulate_to_root, heaviest_children, limbs
from treestroke.core.types import Floats, Indices, Mask

UPRIGHT = 0.4
"""Share of the steepest slope that an upright limb may take: upright limbs lean little in depth too."""
SEEN = 0.3
"""Share of a limb's length, with all that it bears, that is seen among leaves if it lies on the viewer's side."""
AMID = 1.0
"""How much distance counts for a limb all of whose outer joints lie amid foliage, beside one that has none."""


@dataclass(frozen=True)
class LiftParams:
    """How far limbs may turn out of the picture.

    Attributes
    ----------
    steepest
        Greatest slope of a limb's depth against its length in the picture.
    slopes
        Slopes tried, evenly spaced from -steepest to steepest.
    inside
        Share of the crown's half depth that a limb may use.
    """

    steepest: float = 1.0
    slopes: int = 9
    inside: float = 0.8

    def __post_init__(self) -> None:
        if self.steepest < 0 or self.slopes < 1 or not 0 <= self.inside <= 1:
            raise ValueError(f"lifting needs a slope >= 0, a slope to try and a share of the depth, got {self}")


@dataclass(frozen=True, eq=False)
class FrontCrown:
    """A crown volume and the front camera in whose picture the tree was traced."""

    volume: CrownVolume
    camera: OrthographicCamera


@dataclass(frozen=True, eq=False)
class FrontTree:
    """A tree traced in a front view.

    Attributes
    ----------
    skeleton
        2D, px, n joints.
    stroke
        (n,) which stroke each joint follows: a limb goes on along its own stroke.
    before_leaves
        (n,) mask of the joints that are seen among leaves, and so lie before them.
    """

    skeleton: Skeleton
    stroke: Indices
    before_leaves: Mask


def lift(tree: FrontTree, crown: FrontCrown, rng: np.random.Generator, params: LiftParams = LiftParams()) -> Skeleton:
    """Lift a traced tree to the world (3D, metres), radii too.

    Each joint still projects onto its pixel. The first stem stays in the picture's plane; every other limb takes the
    slope that keeps its joints furthest from all limbs before it, heaviest limbs first among siblings; ``rng`` decides
    to which side when both are equal. A limb that is seen among leaves comes toward the viewer.

    Source: Tan et al. 2008, section 3.1; bounds by slope and by the crown, and the viewer's side, are ours.
    """
    skeleton, stroke = tree.skeleton, tree.stroke
    points, radii = crown.camera.world_from_pixels(skeleton.points), crown.camera.metres_from_pixels(skeleton.radii)
    flat = Skeleton(points, radii, skeleton.parents)
    weights = accumulate_to_root(flat, edge_lengths(flat))
    same = stroke == stroke[np.maximum(flat.parents, 0)]
    chains = limbs(flat, heaviest_children(flat, np.where(same, weights + weights.max(), weights)))
    is_seen = accumulate_to_root(flat, edge_lengths(flat) * tree.before_leaves) > SEEN * weights
    depth = np.zeros(len(flat))
    placed = [flat.points[chains[0]]]
    for chain in _by_order(chains[1:], weights):
        first = int(flat.parents[chain[0]] >= 0 or len(chain) > 1)
        toward = bool(is_seen[chain[min(first, len(chain) - 1)]])
        options = _options(flat.points[chain], float(depth[chain[0]]), toward, crown.volume, params)
        best = options[_furthest(options, placed, crown.volume, rng)]
        depth[chain[first:]] = best[first:, 2]
        placed.append(best)
    return Skeleton(np.column_stack([flat.points[:, :2], depth]), flat.radii, flat.parents)


def _by_order(chains: list[Indices], weights: Floats) -> list[Indices]:
    """Sort limbs so that each comes after its parent limb, otherwise the heaviest first."""
    owner = {int(joint): number for number, chain in enumerate(chains) for joint in chain[1:]}
    level = np.zeros(len(chains), dtype=np.int64)
    for number, chain in enumerate(chains):
        parent = owner.get(int(chain[0]), -1)
        level[number] = 0 if parent < 0 else level[parent] + 1
    order = sorted(range(len(chains)), key=lambda n: (level[n], -weights[chains[n][min(1, len(chains[n]) - 1)]], n))
    return [chains[n] for n in order]


def _options(points: Floats, start: float, toward: bool, volume: CrownVolume, params: LiftParams) -> Floats:
    """Return the limb's joints (slopes, n, 3), metres, at all slopes, or those ``toward`` the viewer, in the crown."""
    steps = np.linalg.norm(np.diff(points[:, :2], axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    furthest_back = 0.0 if toward else -params.steepest
    slopes = np.linspace(furthest_back, params.steepest, params.slopes) * _leaning(points)
    most = _bounds(points, abs(start), steps, volume, params)
    eased = along**2 / (along + 0.25 * along[-1] + 1e-9)
    depth = np.clip(start + slopes[:, None] * eased, -most, most)
    lifted = np.broadcast_to(points, (len(slopes), *points.shape)).copy()
    lifted[:, :, 2] = depth
    return lifted


def _bounds(points: Floats, start: float, steps: Floats, volume: CrownVolume, params: LiftParams) -> Floats:
    """Bound the depth of a limb's joints (n,), metres, by the crown, and under it by where the limb enters it.

    Else a stem would swing out under the crown and back into it. The bound itself is no steeper than a limb may be:
    otherwise a limb that enters the crown would jump aside.
    """
    open_air = volume.half_width(points[:, 1]) <= 0
    most = np.where(open_air, np.inf, np.maximum(params.inside * volume.half_depth(points), start)).tolist()
    rises = (params.steepest * steps).tolist()
    for i, rise in reversed(list(enumerate(np.where(open_air[:-1], 0.0, rises).tolist()))):
        most[i] = min(most[i], most[i + 1] + rise)
    most[0] = max(most[0], start)
    for i, rise in enumerate(rises):
        most[i + 1] = min(most[i + 1], most[i] + rise)
    return np.maximum(np.array(most, dtype=np.float64), start)


def _leaning(points: Floats) -> float:
    """Return the share of the steepest slope for a limb: small for upright leaders, 1 for level limbs."""
    chord = points[-1, :2] - points[0, :2]
    return float(UPRIGHT + (1 - UPRIGHT) * abs(chord[0]) / max(float(np.hypot(*chord)), 1e-9))


def _furthest(options: Floats, placed: list[Floats], volume: CrownVolume, rng: np.random.Generator) -> int:
    """Choose the option (k, n, 3) whose outer joints keep most distance from all that is placed, amid foliage.

    Ties are broken at random.
    """
    others = np.concatenate(placed)
    outer = options[:, options.shape[1] // 2 :]
    away = np.zeros((*outer.shape[:2], len(others)))
    for axis in range(3):
        away += (outer[:, :, None, axis] - others[:, axis]) ** 2
    leafy = volume.inside(outer.reshape(-1, 3)).reshape(outer.shape[:2]).mean(axis=1)
    gaps = np.sqrt(away.min(axis=-1)).mean(axis=-1) * (1 + AMID * leafy)
    best = np.flatnonzero(gaps >= gaps.max() * (1 - 1e-9))
    return int(best[rng.integers(len(best))])
