"""Light and dark of wood as a photo shows it: limbs in the sun and in shade, pale stems and dark twigs.

A bark texture is read off the trunk and is the same everywhere. On a bare tree, all of whose wood is seen, each place
has the lightness that the photo has there, as a factor of the texture's.
"""

from dataclasses import replace

import cv2
import numpy as np

from treestroke.core.appearance import View
from treestroke.core.geometry.mesh import Mesh, Surface
from treestroke.core.imaging.light import LUMINANCE, linear_light, srgb_light
from treestroke.core.imaging.sampling import sample_nearest
from treestroke.core.types import Floats

AROUND = 0.004
"""Distance over which lightness is averaged (standard deviation), as a share of the tree's height."""
RANGE = 3.0
"""Greatest factor by which wood is lighter or darker than most of it. (Twigs finer than a pixel take on the sky's
lightness: relative to the trunk's texture they would be too light.)"""
BRIGHTEST = 98.0
"""Percentile of the lightness that is the brightened texture's own: shades only darken."""
LIGHT = linear_light(np.arange(256.0)).astype(np.float32)
"""Linear light of sRGB bytes."""
LEAST = 0.01
"""Least share of wood around a place that tells its lightness."""


def lit_as_seen(bark: Surface, view: View) -> Surface:
    """Return bark with a shade for each vertex, by the lightness of the wood before or behind which a view shows it.

    The texture is brightened as much as the shades darken most of it. Where no wood is seen, it stays as it is.
    """
    light = _light_at(bark.mesh.positions.astype(np.float64), view)
    seen = light > 0
    if not seen.any():
        return bark
    texels = linear_light(bark.texture.astype(np.float64))
    factor = np.ones(len(light))
    factor[seen] = np.clip(light[seen] / np.median(light[seen]), 1 / RANGE, RANGE)
    top = float(np.percentile(factor, BRIGHTEST))
    texture = srgb_light(np.minimum(top * texels, 1.0))
    mesh = replace(bark.mesh, shades=np.minimum(factor / top, 1.0).astype(np.float32))
    return replace(bark, mesh=mesh, texture=texture)


def shaded_like(mesh: Mesh, bark: Mesh) -> Mesh:
    """Return a mesh of lower detail of the same skeleton with the shades of its bark, joint by joint."""
    if bark.shades is None or bark.attachment is None or mesh.attachment is None:
        return mesh
    joints, other = bark.attachment.joints[:, 1], mesh.attachment.joints[:, 1]
    count = int(max(joints.max(), other.max())) + 1
    total, vertices = np.bincount(joints, bark.shades, count), np.bincount(joints, minlength=count)
    shades = np.where(vertices > 0, total / np.maximum(vertices, 1), float(bark.shades.mean()))
    return replace(mesh, shades=shades[other].astype(np.float32))


def _light_at(points: Floats, view: View) -> Floats:
    """Return the mean luminance (n,) of the wood that a view shows around points (n, 3), metres; 0 where none is."""
    weight = (view.tree * np.where(view.foliage, view.opacity, 1.0)).astype(np.float32)
    rows = np.flatnonzero(weight.any(axis=1))
    if not len(rows):
        return np.zeros(len(points))
    spread = max(0.7, AROUND * float(rows[-1] - rows[0]))
    luminance = LIGHT[view.picture] @ LUMINANCE.astype(np.float32)
    amount, lit = (cv2.GaussianBlur(part, (0, 0), spread) for part in (weight, weight * luminance))
    light = np.where(amount > LEAST, lit / np.maximum(amount, LEAST), 0.0)
    return np.asarray(sample_nearest(light, view.camera.pixels_from_world(points)[:, :2], 0.0), dtype=np.float64)
