"""Bark: generalized cylinders around the limbs of a skeleton."""

from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.frames import rotation_minimizing_normals
from treestroke.core.geometry.mesh import Hold, Mesh
from treestroke.core.mesh.chains import Chains, chains_of, subset, thinned
from treestroke.core.mesh.stations import Stations, stations_of
from treestroke.core.mesh.swelling import collar, flare, merged_normals, nearness_to_bearer
from treestroke.core.mesh.touching import missed_forks, without_hidden
from treestroke.core.mesh.tube_surface import Grid, smooth_normals, texture_coordinates
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.types import Indices

_LEAST_DETAIL = 0.003  # where every limb is a cone or two; less saves no more triangles
THINNEST = 1.2e-4  # radius of the thinnest twig, in tree heights: a third of a pixel in a 1500 px photo
_SIDES_PER_ROOT_HEIGHT = 105.0  # sides = 2.3 + this * sqrt(radius / height): 17 on a trunk, 4 on a twig
_MISSED = 3e-4  # of the height: how far a thin limb's axis may miss its joints, half a pixel in that photo
_BLUNT = 1.2e-3  # of the height: tips from this radius on are round
_COLLARED = 1e-3  # of the height: limbs from this radius on have a collar
_BACK = np.array([0.0, 0.0, -1.0])  # the texture's seam turns away from the camera


@dataclass(frozen=True)
class TubeParams:
    """How bark is built.

    Attributes
    ----------
    max_triangles
        Most triangles; detail is lowered until they suffice.
    max_sides
        Most sides of a tube.
    root_swelling
        Radius at the root over the trunk's radius above the flare.
    buttress
        Depth of the root flare's lobes over the trunk's radius.
    collar_swelling
        Widening of a limb where it leaves its bearer, over its radius.
    texture_repeats
        How often the texture goes around the thickest stem; thinner limbs have
        fewer in proportion, at least 1.
    texture_aspect
        Height of the texture over its width.
    """

    max_triangles: int = 95_000
    max_sides: int = 20
    root_swelling: float = 1.5
    buttress: float = 0.22
    collar_swelling: float = 0.5
    texture_repeats: int = 3
    texture_aspect: float = 2.0

    def __post_init__(self) -> None:
        if self.max_triangles < 100 or self.max_sides < 3 or self.texture_repeats < 1:
            raise ValueError(f"tubes need 100 triangles, 3 sides and 1 repeat at least, got {self}")
        if self.root_swelling < 1 or min(self.buttress, self.collar_swelling) < 0 or self.texture_aspect <= 0:
            raise ValueError(f"swellings must not shrink and the aspect must be positive, got {self}")


def tubes(skeleton: Skeleton, params: TubeParams = TubeParams()) -> Mesh:
    """Wrap a 3D skeleton (metres, world frame) in bark.

    Along each limb rings stand on rotation-minimizing frames, so a limb is one tube from where it leaves
    its bearer to its tip. The strongest child continues its parent's tube; others start on the bearer's
    axis, hidden inside it, and leave it with a collar that widens along the bearer. Stems swell to the
    root in lobes, stand level and are closed below; tips are closed. Texture repeats a whole number of
    times around and its scale along follows the radius, so texels stay square. Each vertex holds to the joints
    that its ring stands between.

    Raises
    ------
    ValueError
        The skeleton is not 3D, has no length, or has more limbs than the triangles suffice for.

    Notes
    -----
    Generalized cylinders after Bloomenthal, "Modeling the Mighty Maple", 1985; frames after Wang et al. 2008.
    Branch collars widen along the bearer, as branch bark ridges do (Shigo 1985).
    """
    if skeleton.points.shape[1] != 3:
        raise ValueError(f"tubes need a 3D skeleton, got {skeleton.points.shape[1]} coordinates")
    height = max(float(np.ptp(skeleton.points, axis=0).max()), 1e-6)
    chains = without_hidden(chains_of(skeleton, THINNEST * height))
    detail = 1.0
    while detail > _LEAST_DETAIL:
        rings = _rings(chains, height, detail)
        sides = _sides(chains, height, detail, params.max_sides)
        grid = Grid.of(rings, sides)
        if len(grid.triangles) <= params.max_triangles:
            return wrapping(grid, rings, chains, params)
        detail *= min(0.95, (params.max_triangles / len(grid.triangles)) ** 0.6)
    raise ValueError(f"{params.max_triangles} triangles do not suffice for {len(chains.bearer)} limbs")


def _rings(chains: Chains, height: float, detail: float) -> Stations:
    """Place rings at this much detail, and no less than hides where limbs start."""
    left = thinned(chains, np.maximum(0.08 * chains.radii, _MISSED * height) / detail**2)
    while True:
        rings = stations_of(subset(chains, left), detail, _BLUNT * height, _COLLARED * height / detail)
        missed = missed_forks(chains, left, rings)
        if not len(missed):
            return rings
        left = np.union1d(left, missed)


def _sides(chains: Chains, height: float, detail: float, most: int) -> Indices:
    """Choose the number of sides (k,) of each limb's tube."""
    mean = np.add.reduceat(chains.radii, chains.first) / np.bincount(chains.limb)
    reference = 0.5 * (mean + chains.radii[chains.first])
    sides = np.floor(2.3 + _SIDES_PER_ROOT_HEIGHT * detail * np.sqrt(reference / height))
    return np.clip(sides, 3, most).astype(np.int64)


def wrapping(grid: Grid, rings: Stations, chains: Chains, params: TubeParams) -> Mesh:
    """Place the grid's vertices on the rings along limbs, swollen where stems stand and limbs start."""
    seeds = np.broadcast_to(_BACK, (len(rings.first), 3))
    normal = rotation_minimizing_normals(rings.points, rings.tangents, rings.first, seeds)
    binormal = np.cross(rings.tangents, normal)
    angle, ring = grid.angle_rad[:, None], grid.ring
    outward = np.cos(angle) * normal[ring] + np.sin(angle) * binormal[ring]
    radius = rings.radii[ring][:, None]
    nearness = nearness_to_bearer(grid, rings, rings.points[ring] + radius * outward, chains)
    widening = flare(grid, rings, chains, params.root_swelling, params.buttress)
    widening += collar(rings.limb[ring], outward, nearness, chains, params.collar_swelling)
    positions = rings.points[ring] + radius * (1.0 + widening[:, None]) * outward
    normals = merged_normals(smooth_normals(grid, rings, positions), rings.limb[ring], positions, nearness, chains)
    uvs = texture_coordinates(grid, rings, positions, params.texture_repeats, params.texture_aspect)
    return Mesh(
        positions.astype(np.float32),
        normals.astype(np.float32),
        uvs.astype(np.float32),
        grid.triangles,
        hold=Hold(rings.joints[ring], rings.share[ring]),
    )
