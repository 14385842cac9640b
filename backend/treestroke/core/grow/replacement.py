"""Growth by replacement: branch after branch takes the subtree that best fills the crown.

Tan, Fang, Xiao, Zhao and Quan 2008, sections 3.1 and 3.2, with these changes, each measured: a branch is replaced
once, so that limbs do not become bottle brushes; pruning is part of the evaluation, else the same pruned winner wins
again and again; a shoot that leaves the crown is clipped, and the crown bounds depth too; shoots that grow inward
go; subtrees on a stem are stretched toward the crown's edge.
"""

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.envelope import Envelope
from treestroke.core.grow.crown import crown_of, pixels_of, world_of
from treestroke.core.grow.evaluator import evaluator_for
from treestroke.core.grow.form import VisibleTree, curve_shoots
from treestroke.core.grow.growing import Growing, rules_for
from treestroke.core.grow.grown import Grown
from treestroke.core.grow.library import Subtree
from treestroke.core.grow.limb_ends import with_limbs_carried_on
from treestroke.core.grow.params import GrowthParams
from treestroke.core.grow.radii import pipe_radii
from treestroke.core.grow.stem import foot_of, with_leader
from treestroke.core.grow.twigs import with_twigs
from treestroke.core.progress import Report, silent
from treestroke.core.skeleton.skeleton import Skeleton

REACHED_PX = 10.0
"""An image attractor counts as reached within this distance of a branch, px of a crown 1,000 px wide."""


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
    into the mask and lie within the envelope, save where a stem or limb is carried on from below the foliage into it;
    visible joints stay where they are. Without iterations no limb is carried on and no twig grows.

    Raises
    ------
    ValueError
        The mask is empty or does not fit the envelope, or the library is empty.
    """
    if not library or not mask.any():
        raise ValueError(f"growth needs foliage and at least one subtree, got {mask.sum()} px and {len(library)}")
    camera = envelope.camera
    scale = camera.metres_per_pixel
    visible = Skeleton(pixels_of(skeleton.points, camera), skeleton.radii / scale, skeleton.parents)
    visible = with_leader(visible, mask, envelope, params.leader)
    crown = crown_of(mask, envelope, foot_of(visible, mask))
    visible = with_limbs_carried_on(visible, crown) if params.iterations else visible
    evaluator = evaluator_for(crown, library, rules_for(params, crown.unit))
    growth = Growing(visible, crown, library, params, evaluator)
    choices = growth.run(rng, report)
    form = curve_shoots(VisibleTree(visible, len(skeleton), growth.chains), growth.table(), crown, rng)
    form = with_twigs(form, crown, params.twigs if choices else 0, rng)
    radii = pipe_radii(form.points, form.parents, form.measured, params.tip_px * crown.unit)
    distances = growth.evaluator.image_distances()
    return Grown(
        Skeleton(world_of(form.points, camera), radii * scale, form.parents),
        form.born,
        np.array(choices, dtype=np.int64).reshape(-1, 3),
        float((distances <= REACHED_PX * crown.unit).mean()) if len(distances) else 0.0,
    )
