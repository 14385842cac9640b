"""What is learnt of how a tree branches: distributions of its bifurcations by order, and the shapes of its limbs."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.polyline import arc_lengths
from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.siblings.bifurcations import START, Bifurcations, Limb, bifurcations
from treestroke.core.siblings.dirichlet import Dirichlet, fit_dirichlet
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices, Mask

DEEPEST = 3
"""Orders that are learnt by themselves; finer limbs are like those of the last."""
ENOUGH = 6
"""Least number of bifurcations of an order; with fewer they are learnt together with those of the order before."""
PARTS = 3
"""Parts of a limb, from its base to its tip, on which limbs have distributions of their own."""
LEAST_RISE = 0.15
"""Least standard deviation of the rise: else few alike limbs would leave no choice of direction."""
MOST_RATIO = 0.95
"""Greatest radius of a limb at its base over that of the limb that it leaves."""


@dataclass(frozen=True, eq=False)
class LimbShape:
    """The shape of a limb of length 1, in a frame of its own.

    Attributes
    ----------
    points
        (m, 3) its joints: along the direction in which it leaves, up across that, and aside; the first is 0.
    radii
        (m,) its radii over that at its base.
    rise
        Sine of the angle to the ground at which it leaves.
    length
        Its length in the example, metres.
    """

    points: Floats
    radii: Floats
    rise: float
    length: float


@dataclass(frozen=True, eq=False)
class PartModel:
    """Limbs that leave one part of a limb: their share of all, lengths as in `Bifurcations`, and the mean rise."""

    share: float
    lengths: Dirichlet
    rise: float


@dataclass(frozen=True, eq=False)
class OrderModel:
    """Limbs of one order.

    Attributes
    ----------
    angles
        Their forks' three angles, as shares of the sum.
    angle_sum_rad
        Mean of that sum.
    parts
        The parts of a limb that they leave.
    per_metre
        How many leave a metre of limb.
    rise_spread
        Standard deviation of the sine of the angle to the ground at which they leave, in each part.
    radius_ratio
        Mean and standard deviation of the logarithm of the radius at their base over that of the limb that they leave.
    longest
        Greatest length over that of the limb that they leave.
    shapes
        Their shapes.
    """

    angles: Dirichlet
    angle_sum_rad: float
    parts: tuple[PartModel, ...]
    per_metre: float
    rise_spread: float
    radius_ratio: tuple[float, float]
    longest: float
    shapes: tuple[LimbShape, ...]


@dataclass(frozen=True, eq=False)
class BranchingModel:
    """What is learnt of a tree.

    Attributes
    ----------
    height
        Its height, metres.
    stems
        Its stems as they stand, the first at the origin.
    orders
        Its limbs by order, from those that leave a stem on.
    """

    height: float
    stems: tuple[Limb, ...]
    orders: tuple[OrderModel, ...]


def learn_branching(tree: Skeleton) -> BranchingModel:
    """Learn how a 3D tree branches, metres, whatever it was made from.

    Source: Li et al. 2011, sections 5.1 and 5.2. Its features are those of a binary tree's nodes. Ours keep limbs
    whole: the three lengths are those of whole limbs, which say at once where a limb leaves another and how long it is;
    they are learnt by parts of the limb, since reach falls toward its tip. Shapes, radii and the angle to the ground
    are learnt too.
    """
    found = bifurcations(tree)
    stems = tuple(limb for limb in found.limbs if limb.order == 0)
    orders, first = list[OrderModel](), 1
    for order in range(1, DEEPEST + 1):
        deeper = order == DEEPEST
        here = (found.order >= first) & ((found.order <= order) | deeper)
        if here.sum() >= ENOUGH or (order == 1 and here.any()):
            orders.append(_order_model(found, here))
            first = order + 1
    return BranchingModel(float(np.ptp(tree.points[:, 1])), stems, tuple(orders))


def _order_model(found: Bifurcations, here: Mask) -> OrderModel:
    lengths, angles, rise = found.lengths[here], found.angles_rad[here], found.rise[here]
    whole = np.maximum(lengths[:, 0] + lengths[:, 1], 1e-9)
    part = np.minimum(PARTS * lengths[:, 0] / whole, PARTS - 1).astype(np.int64)
    ratio = np.log(np.clip(found.radius_ratio[here], 0.02, MOST_RATIO))
    total = angles.sum(axis=1)
    parts = tuple(_part(lengths, rise, part == number) for number in range(PARTS))
    left = np.unique(found.limb[here])
    orders = np.unique(found.order[here]) - 1
    borne = sum(arc_lengths(limb.points)[-1] for limb in found.limbs if limb.order in orders)
    means = np.array([part.rise if part else 0.0 for part in parts])
    return OrderModel(
        fit_dirichlet(angles / np.maximum(total, 1e-9)[:, None]),
        float(total.mean()),
        tuple(part for part in parts if part),
        float(here.sum() / max(float(borne), 1e-9)),
        max(LEAST_RISE, float(np.sqrt(((rise - means[part]) ** 2).mean()))),
        (float(ratio.mean()), float(ratio.std())),
        float((lengths[:, 2] / whole).max()),
        tuple(_shape(found.limbs[index]) for index in left),
    )


def _part(lengths: Floats, rise: Floats, here: Mask) -> PartModel | None:
    if not here.any():
        return None
    sums = lengths[here].sum(axis=1, keepdims=True)
    return PartModel(float(here.mean()), fit_dirichlet(lengths[here] / sums), float(rise[here].mean()))


def _shape(limb: Limb) -> LimbShape:
    arc = arc_lengths(limb.points)
    length = max(float(arc[-1]), 1e-9)
    away = (limb.points - limb.points[0]) / length
    ahead = away[max(1, int(np.searchsorted(arc, START * length)))]
    axes = limb_frame(unit(ahead[None])[0])
    radii = limb.radii / max(float(limb.radii[0]), 1e-9)
    return LimbShape(away @ axes.T, radii, float(axes[0, 1]), length)


def limb_frame(ahead: Floats) -> Floats:
    """Return the axes (3, 3), rows, of a limb that leaves in a unit direction (3,): ahead, up across it, aside."""
    up = UP - float(UP @ ahead) * ahead
    if float(np.linalg.norm(up)) < 0.05:
        up = np.array([1.0, 0.0, 0.0]) - float(ahead[0]) * ahead
    up = up / np.linalg.norm(up)
    return np.stack([ahead, up, np.cross(ahead, up)])


def nearest_shapes(shapes: tuple[LimbShape, ...], rise: float, length: float) -> Indices:
    """Return the indices of shapes, those first that leave as steeply and are about as long."""
    apart = [abs(shape.rise - rise) + 0.3 * abs(np.log(shape.length / length)) for shape in shapes]
    return np.argsort(np.array(apart), kind="stable")
