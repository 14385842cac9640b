"""Bark: generalized cylinders around the limbs of a skeleton."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.mesh import Attachment, Mesh
from treestroke.core.geometry.vectors import rotation_minimizing_normals
from treestroke.core.mesh.collars import blended_normals, collar_widening, flare_widening, nearness_to_parent
from treestroke.core.mesh.hidden_limbs import uncovered_forks, without_hidden_limbs
from treestroke.core.mesh.limb_axes import LimbAxes, limb_axes, simplified, subset
from treestroke.core.mesh.rings import Rings, place_rings
from treestroke.core.mesh.tube_surface import TubeGrid, smooth_normals, texture_coordinates
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Floats, Indices

MIN_RADIUS = 1.2e-4
"""Radius of the thinnest twig, in tree heights: a third of a pixel in a 1500 px photo."""
_MIN_DETAIL = 0.003  # where every limb is a cone or two; less saves no more triangles
_SIDES_PER_ROOT_HEIGHT = 105.0  # sides = 2.3 + this * sqrt(radius / height): 17 on a trunk, 4 on a twig
_MAX_ERROR = 3e-4  # in tree heights: distance of a thin limb's axis from its joints, half a pixel in a 1500 px photo
_MAX_TRUNK_ERROR = 2e-3  # in tree heights: the same of the thickest
_BLUNT = 1.2e-3  # in tree heights: tips of at least this radius are round
_COLLARED = 1e-3  # in tree heights: limbs of at least this radius have a collar
_BACK = np.array([0.0, 0.0, -1.0])  # the texture's seam faces away from the camera


@dataclass(frozen=True)
class TubeParams:
    """Detail and shape of the tubes.

    Attributes
    ----------
    max_triangles
        Greatest number of triangles; detail is lowered until they suffice.
    max_sides
        Greatest number of sides of a tube.
    root_swelling
        Least radius at the root over the trunk's radius above its flare.
    buttress
        Depth of a root flare's lobes over what the flare adds to the trunk's radius.
    collar_swelling
        Widening of a limb where it leaves its parent, over its radius.
    texture_repeats
        Repeats of the texture around the thickest stem; thinner limbs have fewer in proportion, at least 1.
    texture_aspect
        Height of the texture over its width.
    """

    max_triangles: int = 95_000
    max_sides: int = 20
    root_swelling: float = 1.0
    buttress: float = 0.35
    collar_swelling: float = 0.5
    texture_repeats: int = 3
    texture_aspect: float = 2.0

    def __post_init__(self) -> None:
        if self.max_triangles < 100 or self.max_sides < 3 or self.texture_repeats < 1:
            raise ValueError(f"tubes need at least 100 triangles, 3 sides and 1 repeat, got {self}")
        if self.root_swelling < 1 or min(self.buttress, self.collar_swelling) < 0 or self.texture_aspect <= 0:
            raise ValueError(f"root_swelling must be >= 1, other swellings >= 0 and the aspect > 0, got {self}")


def tubes(skeleton: Skeleton, params: TubeParams = TubeParams()) -> Mesh:
    """Build the bark of a 3D skeleton (metres, world frame): one closed tube for each limb.

    Rings are oriented by rotation-minimizing frames. The strongest child continues its parent's tube; others start on
    the parent's axis, hidden inside it, and leave it with a collar that widens along the parent. A stem that widens to
    its root does so in lobes; all stand level on the ground and are closed below; tips are closed. The texture repeats
    a whole number of times around a limb, and its scale along it follows the radius, so texels stay square. Each vertex
    is attached to the two joints that its ring stands between.

    Raises
    ------
    ValueError
        The skeleton is not 3D, has no length, or has more limbs than the triangles suffice for.

    Notes
    -----
    Generalized cylinders after Bloomenthal, "Modeling the Mighty Maple", 1985; frames after Wang et al. 2008.
    Branch collars widen along the parent, as branch bark ridges do (Shigo 1985).
    """
    if skeleton.points.shape[1] != 3:
        raise ValueError(f"tubes need a 3D skeleton, got {skeleton.points.shape[1]} coordinates")
    height = max(float(np.ptp(skeleton.points, axis=0).max()), 1e-6)
    axes = without_hidden_limbs(limb_axes(skeleton, MIN_RADIUS * height))
    detail = 1.0
    while detail > _MIN_DETAIL:
        rings = _rings(axes, height, detail)
        sides = _sides(axes, height, detail, params.max_sides)
        grid = TubeGrid.of(rings, sides)
        if len(grid.triangles) <= params.max_triangles:
            return tube_mesh(grid, rings, axes, params)
        detail *= min(0.95, (params.max_triangles / len(grid.triangles)) ** 0.6)
    raise ValueError(f"{params.max_triangles} triangles do not suffice for {len(axes.parent_radius)} limbs")


def _rings(axes: LimbAxes, height: float, detail: float) -> Rings:
    """Place rings at this detail, and more where tubes would not cover the start of other limbs."""
    error = np.clip(0.08 * axes.radii, _MAX_ERROR * height, _MAX_TRUNK_ERROR * height)
    left = simplified(axes, error / detail**2)
    while True:
        rings = place_rings(subset(axes, left), detail, _BLUNT * height, _COLLARED * height / detail)
        uncovered = uncovered_forks(axes, left, rings)
        if not len(uncovered):
            return rings
        left = np.union1d(left, uncovered)


def _sides(axes: LimbAxes, height: float, detail: float, most: int) -> Indices:
    """Choose the number of sides (k,) of each limb's tube, by its mean and its first radius."""
    mean = np.add.reduceat(axes.radii, axes.first) / np.bincount(axes.limb)
    reference = 0.5 * (mean + axes.radii[axes.first])
    sides = np.floor(2.3 + _SIDES_PER_ROOT_HEIGHT * detail * np.sqrt(reference / height))
    return np.clip(sides, 3, most).astype(np.int64)


def tube_mesh(grid: TubeGrid, rings: Rings, axes: LimbAxes, params: TubeParams) -> Mesh:
    """Build the mesh of tubes over rings: a grid's vertices, with root flares and collars, and their attachment."""
    seeds = np.broadcast_to(_BACK, (len(rings.first), 3))
    normal = rotation_minimizing_normals(rings.points, rings.tangents, rings.first, seeds)
    binormal = np.cross(rings.tangents, normal)
    angle, ring = grid.angle_rad[:, None], grid.ring
    outward = np.cos(angle) * normal[ring] + np.sin(angle) * binormal[ring]
    radius = rings.radii[ring][:, None]
    nearness = nearness_to_parent(grid, rings, rings.points[ring] + radius * outward, axes)
    widening = flare_widening(grid, rings, axes, params.root_swelling, params.buttress)
    widening += collar_widening(rings.limb[ring], outward, nearness, axes, params.collar_swelling)
    positions = rings.points[ring] + radius * (1.0 + widening[:, None]) * outward
    positions[:, 1] = np.maximum(positions[:, 1], _ground(rings, axes)[ring])
    normals = blended_normals(smooth_normals(grid, rings, positions), rings.limb[ring], positions, nearness, axes)
    uvs = texture_coordinates(grid, rings, positions, params.texture_repeats, params.texture_aspect)
    return Mesh(
        positions.astype(np.float32),
        normals.astype(np.float32),
        uvs.astype(np.float32),
        grid.triangles,
        attachment=Attachment(rings.joints[ring], rings.share[ring]),
    )


def _ground(rings: Rings, axes: LimbAxes) -> Floats:
    """Height (r,), metres, under which no part of a ring may reach: the lowest root's in root flares and collars.

    Limbs whose axis goes below it are let be: they hang over a slope or a pot's edge.
    """
    lowest = axes.points[axes.first][axes.is_stem][:, 1].min(initial=np.inf)
    return np.where((rings.swelling > 0) & (rings.points[:, 1] >= lowest), lowest, -np.inf)
