"""Small crowns to grow in."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.crown_volume import Silhouette
from treestroke.core.geometry.outline_volume import Sections, TurnedOutline, sections_of, turned_outline
from treestroke.core.grow.growth_space import GrowthSpace, growth_space
from treestroke.core.grow.replacement import CrownToFill
from treestroke.core.skeleton.skeleton import Skeleton


class Case(NamedTuple):
    skeleton: Skeleton
    mask: NDArray[np.bool_]
    volume: TurnedOutline
    camera: OrthographicCamera

    @property
    def crown(self) -> CrownToFill:
        return CrownToFill(self.volume, Silhouette(self.mask, self.camera))

    @property
    def sections(self) -> Sections:
        return sections_of(self.volume, self.camera)

    @property
    def visible(self) -> Skeleton:
        """The skeleton in the picture, px."""
        radii = self.camera.pixels_from_metres(self.skeleton.radii)
        return Skeleton(self.camera.picture_space_from_world(self.skeleton.points), radii, self.skeleton.parents)

    def space(self, foot: tuple[float, float, float] = (160.0, 275.0, 0.0)) -> GrowthSpace:
        return growth_space(self.volume, self.crown.front, np.array(foot))


def trunk_case(top: float = 120.0) -> Case:
    """An elliptic crown of 280 by 240 px over a trunk of 0.2 m radius that ends at row ``top``; 0.02 m a pixel."""
    camera = OrthographicCamera(320, 480, 0.02, (160.0, 460.0))
    rows, columns = np.mgrid[0:480, 0:320] + 0.5
    mask = ((columns - 160) / 140) ** 2 + ((rows - 160) / 120) ** 2 <= 1
    y = np.arange(460.0, top - 1, -5)
    points = camera.world_from_pixels(np.column_stack([np.full(len(y), 160.0), y]))
    skeleton = Skeleton(points, np.linspace(0.2, 0.08, len(y)), np.arange(len(y)) - 1)
    return Case(skeleton, mask, turned_outline(Silhouette(mask, camera)), camera)


def limbed_case(depth_deg: float = 35.0) -> Case:
    """The same crown with four limbs, turned out of the image to both sides by ``depth_deg``."""
    case = trunk_case()
    points, radii, parents = (
        list(column) for column in (case.skeleton.points, case.skeleton.radii, case.skeleton.parents)
    )
    for i, (start, side) in enumerate(((38, 1), (42, -1), (48, 1), (54, -1))):
        out = np.radians(depth_deg) * (1 if i % 2 else -1) * (1 if i < 2 else -0.6)
        step = 0.1 * np.array([side * 0.8 * np.cos(out), 0.6, 0.8 * np.sin(out)])
        for k in range(16):
            parents.append(start if k == 0 else len(points) - 1)
            points.append(points[parents[-1]] + step)
            radii.append(0.07 - 0.003 * k)
    return Case(Skeleton(np.array(points), np.array(radii), np.array(parents)), *case[1:])
