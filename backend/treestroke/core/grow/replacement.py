"""Growth by replacement: branch after branch takes the subtree that best fills the crown.

Tan, Fang, Xiao, Zhao and Quan 2008, sections 3.1 and 3.2, with these changes, each measured: a branch is replaced
once, so that limbs do not look like bottle brushes; pruning is part of the evaluation, else the same pruned winner wins
again and again; a shoot that leaves the crown is clipped, and the crown bounds depth too; shoots that grow inward
go; subtrees on a stem are stretched toward the crown's edge.
"""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette
from treestroke.core.geometry.outline_volume import sections_of
from treestroke.core.grow.evaluator import evaluator_for
from treestroke.core.grow.form import VisibleTree, curve_shoots
from treestroke.core.grow.growing import Growing, rules_for
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.growth_space import growth_space
from treestroke.core.grow.library import Subtree
from treestroke.core.grow.limb_ends import with_limbs_extended
from treestroke.core.grow.params import GrowthParams
from treestroke.core.grow.radii import pipe_radii
from treestroke.core.grow.stem import foot_of, with_leader
from treestroke.core.grow.twigs import with_twigs
from treestroke.core.progress import Report, silent
from treestroke.core.skeleton.skeleton import Skeleton

REACHED_PX = 10.0
"""An image attractor counts as reached within this distance of a branch, px of a crown 1,000 px wide."""


@dataclass(frozen=True, eq=False)
class CrownToFill:
    """What growth fills: a crown volume, and its foliage with holes closed as a front camera shows it."""

    volume: CrownVolume
    front: Silhouette[OrthographicCamera]


@dataclass(frozen=True, eq=False)
class Replacement:
    """How growth fills it: the subtrees that replace branches, one or more, and the figures."""

    library: tuple[Subtree, ...]
    params: GrowthParams


def grow(
    skeleton: Skeleton,
    crown: CrownToFill,
    method: Replacement,
    rng: np.random.Generator,
    report: Report = silent,
) -> Grown:
    """Fill the crown of a lifted tree (3D, metres, measured radii) with branches.

    New joints project into the front silhouette and lie within the volume, except where a stem or limb is extended from
    below the foliage into it; visible joints stay where they are. Without iterations no limb is extended and no twig
    grows. ``report("grow", fraction)`` is called with each iteration.

    Source: Tan et al. 2008, sections 3.1 and 3.2; the module's head says where we differ.

    Raises
    ------
    ValueError
        The silhouette is empty or does not fit its camera, or the library is empty.
    """
    params, mask = method.params, crown.front.mask
    if not method.library or not mask.any():
        raise ValueError(f"growth needs foliage and a subtree, got {mask.sum()} px and {len(method.library)}")
    camera = crown.front.camera
    visible = Skeleton(
        camera.picture_space_from_world(skeleton.points), camera.pixels_from_metres(skeleton.radii), skeleton.parents
    )
    visible = with_leader(visible, mask, sections_of(crown.volume, camera), params.leader)
    space = growth_space(crown.volume, crown.front, foot_of(visible, mask))
    visible = with_limbs_extended(visible, space) if params.iterations else visible
    evaluator = evaluator_for(space, method.library, rules_for(params, space.unit))
    growth = Growing(visible, space, method.library, params, evaluator)
    choices = growth.run(rng, report)
    form = curve_shoots(VisibleTree(visible, len(skeleton), growth.chains), growth.table(), space, rng, params.habit)
    form = with_twigs(form, space, params.twigs if choices else 0, rng)
    radii = pipe_radii(form.points, form.parents, form.measured, params.tip_px * space.unit)
    distances = growth.evaluator.image_distances()
    return Grown(
        Skeleton(camera.world_from_picture_space(form.points), camera.metres_from_pixels(radii), form.parents),
        form.born,
        np.array(choices, dtype=np.int64).reshape(-1, 3),
        float((distances <= REACHED_PX * space.unit).mean()) if len(distances) else 0.0,
    )
