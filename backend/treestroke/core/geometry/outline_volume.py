"""Crown volumes from the crown's outline: turned about its middle, or as deep as a second outline shows."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from treestroke.core.geometry.camera import Camera, OrthographicCamera
from treestroke.core.geometry.crown_volume import CrownVolume, Silhouette, shown_by_all
from treestroke.core.geometry.polyline import smoothed
from treestroke.core.types import Floats, Indices, Mask

SMOOTHED_SHARE = 0.02
"""Standard deviation, as a share of the crown's height, over which its outline is smoothed."""
FLAT = 0.02
"""Distance from the root's plane, as a share of the tree's height, at which wood and leaves may lie outside sections of
assumed depth, which come from smoothed outlines."""


@dataclass(frozen=True, eq=False)
class Sections:
    """The level sections of a crown volume at the rows of a front camera's picture, px of that picture.

    Attributes
    ----------
    middle_px, radius_px
        (h,) column of each section's centre and half its width; the width is 0 where the row holds no crown.
    near_px, deep_px
        (h,) how far each centre stands before the root's plane, Z = 0, and half its depth.
    """

    middle_px: Floats
    radius_px: Floats
    near_px: Floats
    deep_px: Floats


@dataclass(frozen=True, eq=False)
class TurnedOutline:
    """A crown's front outline, turned about its middle row by row: its sections are circles about Z = 0.

    Attributes
    ----------
    camera
        The front camera in whose picture the outline lies.
    middle_px
        (h,) column of each row's middle, px.
    radius_px
        (h,) half of each row's width, px; 0 where the row holds no crown.
    silhouettes
        The crown as it was drawn, which `shown` asks.
    """

    camera: OrthographicCamera
    middle_px: Floats
    radius_px: Floats
    silhouettes: tuple[Silhouette[Camera], ...]

    @property
    def sections(self) -> Sections:
        """The sections at the rows of the outline's own picture."""
        return Sections(self.middle_px, self.radius_px, np.zeros_like(self.radius_px), self.radius_px)

    @cached_property
    def bounds(self) -> Floats:
        """(2, 3) least and greatest corner of the box around the volume, metres; all 0 of an empty one."""
        rows = np.flatnonzero(self.radius_px > 0)
        if len(rows) == 0:
            return np.zeros((2, 3))
        sections = self.sections
        middle = self.camera.world_from_pixels(np.stack([sections.middle_px[rows], rows], axis=1))[:, 0]
        radius, near, deep = (
            self.camera.metres_from_pixels(column[rows])
            for column in (sections.radius_px, sections.near_px, sections.deep_px)
        )
        bottom, top = self.camera.heights_from_rows(np.array([rows[-1] + 1.0, rows[0]])).tolist()
        low = np.array([(middle - radius).min(), bottom, (near - deep).min()])
        return np.stack([low, np.array([(middle + radius).max(), top, (near + deep).max()])])

    @property
    def widest(self) -> float:
        """Half the width of the widest section, metres."""
        return float(self.camera.metres_from_pixels(self.radius_px.max()))

    @property
    def front_area(self) -> float:
        """Area of the outline, square metres."""
        return float(self.camera.metres_from_pixels(self.camera.metres_from_pixels(2 * self.radius_px.sum())))

    @property
    def cubic_metres(self) -> float:
        """Sum of the sections' areas times the height of a row, cubic metres."""
        half_width, half_depth = (self.camera.metres_from_pixels(px) for px in (self.radius_px, self.sections.deep_px))
        return float(np.pi * self.camera.metres_from_pixels((half_width * half_depth).sum()))

    @property
    def depth_seen(self) -> bool:
        """Whether a picture shows how deep the crown is: here it is assumed to be as deep as wide."""
        return False

    @property
    def shape(self) -> str:
        """What the sections are, in words that follow "the solid"."""
        return "whose level sections are circles as wide as the crown's front"

    def inside(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie in the sections and in all silhouettes: flags (n,)."""
        return np.asarray(self.shown(points_world) & (self.reach(points_world) <= 1))

    def shown(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie in all silhouettes: flags (n,)."""
        return shown_by_all(self.silhouettes, points_world)

    def admits(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie in the sections or near Z = 0: flags (n,).

        The outline is smoothed, so that single twigs reach beyond the sections.
        """
        near = np.abs(points_world[:, 2]) <= FLAT * float(self.bounds[1, 1])
        return np.asarray(near | (self.reach(points_world) <= 1.0))

    def reach(self, points_world: Floats) -> Floats:
        """Measure the distance of points (n, 3), metres, from their section's centre over its radius: (n,)."""
        x, row = self._across(points_world)
        z = self.camera.pixels_from_metres(points_world[:, 2])
        return np.asarray(np.hypot(x, z) / np.maximum(self.radius_px[row], 1e-9))

    def axis(self, heights_m: Floats) -> Floats:
        """Return the centres (n, 3), metres, of the sections at heights (n,), metres, in the middles of their rows."""
        row = self._rows(self.camera.rows_from_heights(heights_m))
        centres_px = np.stack([self.middle_px[row], row + 0.5], axis=1)
        near = self.camera.metres_from_pixels(self.sections.near_px[row])
        return self.camera.world_from_pixels(centres_px, -near)

    def half_width(self, heights_m: Floats) -> Floats:
        """Measure half the sections' width (n,), metres, at heights (n,), metres; 0 above and below the crown."""
        row = self._rows(self.camera.rows_from_heights(heights_m))
        return self.camera.metres_from_pixels(self.radius_px[row])

    def half_depth(self, points_world: Floats) -> Floats:
        """Measure half the depth (n,), metres, at the X and Y of points (n, 3), metres; 0 outside."""
        x, row = self._across(points_world)
        return self.camera.metres_from_pixels(np.sqrt(np.maximum(self.radius_px[row] ** 2 - x**2, 0.0)))

    def widened(self, factor: float) -> Self:
        """Return the volume whose sections have ``factor`` times the radius."""
        return replace(self, radius_px=factor * self.radius_px)

    def with_side(self, side: Silhouette[OrthographicCamera]) -> "TwoOutlines":
        """Return the volume that is as deep as the crown in a picture of the left side.

        Rows above and below that crown are as deep as its top and bottom rows.
        """
        seen = turned_outline(side)
        rows = np.flatnonzero(seen.radius_px > 0)
        row = np.clip(side.camera.rows_from_heights(self.camera.row_heights()) - 0.5, rows[0], rows[-1])
        middle, radius = (np.interp(row, rows, column[rows]) for column in (seen.middle_px, seen.radius_px))
        near = side.camera.world_from_pixels(np.stack([middle, row], axis=1))[:, 2]
        near_px, deep_px = (
            self.camera.pixels_from_metres(lengths) for lengths in (near, side.camera.metres_from_pixels(radius))
        )
        return TwoOutlines(self.camera, self.middle_px, self.radius_px, (*self.silhouettes, side), near_px, deep_px)

    def _across(self, points_world: Floats) -> tuple[Floats, Indices]:
        """Measure how far right of their section points (n, 3), metres, lie: (n,), px; and find its row (n,)."""
        points_px = self.camera.pixels_from_world(points_world)
        row = self._rows(points_px[:, 1])
        return points_px[:, 0] - self.middle_px[row], row

    def _rows(self, rows_px: Floats) -> Indices:
        return np.clip(np.floor(rows_px).astype(np.int64), 0, self.camera.height - 1)


@dataclass(frozen=True, eq=False)
class TwoOutlines(TurnedOutline):
    """A crown's outlines from the front and from the left: its sections are ellipses.

    Attributes
    ----------
    near_px, deep_px
        (h,) for each row of the front, px of the front: how far the section's centre stands before the root's plane,
        Z = 0, and half the section's depth.
    """

    near_px: Floats
    deep_px: Floats

    @property
    def sections(self) -> Sections:
        """The sections at the rows of the front's picture."""
        return Sections(self.middle_px, self.radius_px, self.near_px, self.deep_px)

    @property
    def depth_seen(self) -> bool:
        """Whether a picture shows how deep the crown is: the left side's does."""
        return True

    @property
    def shape(self) -> str:
        """What the sections are, in words that follow "the solid"."""
        return "whose level sections are ellipses as wide as the crown's front, as deep as its left side"

    def admits(self, points_world: Floats) -> Mask:
        """Tell which points (n, 3), metres, lie within the left side's outline: flags (n,).

        A limb may reach the edge of both outlines at once, where no ellipse reaches.
        """
        row = self._rows(self.camera.rows_from_heights(points_world[:, 1]))
        away_px = self.camera.pixels_from_metres(points_world[:, 2]) - self.near_px[row]
        return np.asarray(np.abs(away_px) <= self.deep_px[row])

    def reach(self, points_world: Floats) -> Floats:
        """Measure the distance of points (n, 3), metres, from their section's centre over that of the ellipse: (n,)."""
        x, row = self._across(points_world)
        z = self.camera.pixels_from_metres(points_world[:, 2])
        z = (z - self.near_px[row]) / np.maximum(self.deep_px[row], 1e-9)
        return np.asarray(np.hypot(x / np.maximum(self.radius_px[row], 1e-9), z))

    def half_depth(self, points_world: Floats) -> Floats:
        """Measure half the depth (n,), metres, at the X and Y of points (n, 3), metres; 0 outside."""
        x, row = self._across(points_world)
        half_px = np.sqrt(np.maximum(self.radius_px[row] ** 2 - x**2, 0.0))
        return self.camera.metres_from_pixels(half_px * self.deep_px[row] / np.maximum(self.radius_px[row], 1e-9))

    def widened(self, factor: float) -> Self:
        """Return the volume whose sections have ``factor`` times the width and depth."""
        return replace(self, radius_px=factor * self.radius_px, deep_px=factor * self.deep_px)


def turned_outline(crown: Silhouette[OrthographicCamera]) -> TurnedOutline:
    """Turn a crown's silhouette (h, w) about the middle of its rows.

    A row spans its first to last crown pixel; spans are smoothed over 2 % of the crown's height, so that one stray
    twig makes no disc. Rows above and below the crown have radius 0.

    Raises
    ------
    ValueError
        The mask is empty or not of the camera's size.
    """
    mask, camera = crown.mask, crown.camera
    if mask.shape != (camera.height, camera.width):
        raise ValueError(f"mask {mask.shape} does not fit the camera {camera}")
    rows = np.flatnonzero(mask.any(axis=1))
    if rows.size == 0:
        raise ValueError("an empty crown has no volume")
    top, bottom = int(rows[0]), int(rows[-1])
    left = np.interp(np.arange(top, bottom + 1), rows, mask.argmax(axis=1)[rows])
    right = np.interp(np.arange(top, bottom + 1), rows, mask.shape[1] - mask[:, ::-1].argmax(axis=1)[rows])
    sigma = SMOOTHED_SHARE * (bottom - top + 1)
    left, right = (smoothed(side, sigma) for side in (left, right))
    middle, radius = np.zeros(camera.height), np.zeros(camera.height)
    middle[:top], middle[bottom + 1 :] = (left[0] + right[0]) / 2, (left[-1] + right[-1]) / 2
    middle[top : bottom + 1], radius[top : bottom + 1] = (left + right) / 2, (right - left) / 2
    return TurnedOutline(camera, middle, radius, (crown,))


def half_widths_px(volume: CrownVolume, camera: Camera) -> Floats:
    """Return half a crown's width at each row of a camera's picture (h,), px: as stored, or sampled."""
    if isinstance(volume, TurnedOutline) and volume.camera == camera:
        return volume.radius_px
    middle = volume.bounds.mean(axis=0)[None]
    places_px = np.stack([np.full(camera.height, 0.5 * camera.width), np.arange(camera.height) + 0.5], axis=1)
    points = camera.world_from_pixels(places_px, np.repeat(camera.depth(middle), camera.height))
    return np.asarray(volume.half_width(points[:, 1]) / camera.pixel_size(points))


def sections_of(volume: CrownVolume, camera: OrthographicCamera) -> Sections:
    """Return the sections of a crown volume at the rows of a front camera's picture, px: as stored, or sampled."""
    if isinstance(volume, TurnedOutline) and volume.camera == camera:
        return volume.sections
    centres = volume.axis(camera.row_heights())
    near, deep = (camera.pixels_from_metres(lengths) for lengths in (centres[:, 2], volume.half_depth(centres)))
    return Sections(camera.pixels_from_world(centres)[:, 0], half_widths_px(volume, camera), near, deep)
