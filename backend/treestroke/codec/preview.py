"""A picture of the finished tree: front view as the photo frames it, beside a three-quarter view."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.geometry.camera import OrthographicCamera
from treestroke.core.geometry.mesh import ALPHA_CUT, Surface
from treestroke.core.geometry.raster import Planes, pixel_centres, planes, visible_triangles
from treestroke.core.types import Floats, Indices

_VIEW_HEIGHT, _MAX_ASPECT = 620, 1.5
"""Height of a view, px, and its greatest width relative to that."""
_SUPERSAMPLING = 2
"""Rendered pixels a side that become one pixel of the picture."""
_YAW, _PITCH = np.radians(40.0), np.radians(11.0)
"""Angles, rad, by which the three-quarter view is turned."""
_MARGIN = 0.07
"""Margin around the tree, as a share of the view's height."""
_SUN = np.array([-0.50, 0.72, 0.48]) / np.linalg.norm([-0.50, 0.72, 0.48])
"""Direction to the sun, unit length, world."""
_SUN_MAP_PX = 300
"""Height, px, of the view from the sun."""
_SUN_REACH = 0.12
"""Depth in the crown, as a share of the sun view's height, at which sunlight has fallen to 1 / e."""
_SUNLIGHT = np.array([1.12, 1.05, 0.92], dtype=np.float32)
"""Colour of the sun's light, linear."""
_SKYLIGHT = np.array([0.50, 0.54, 0.60], dtype=np.float32)
"""Colour of the sky's light, linear."""
_SKY_TOP, _SKY_LOW = np.array([0.50, 0.64, 0.80]), np.array([0.86, 0.89, 0.90])
"""Colours of the sky at the top and at the horizon, linear."""
_GROUND_FAR, _GROUND_NEAR = np.array([0.62, 0.62, 0.52]), np.array([0.42, 0.42, 0.32])
"""Colours of the ground at the horizon and at the bottom, linear."""
_GAP_PX = 6
"""Gap between the two views."""


@dataclass(frozen=True, eq=False)
class _Scene:
    """All t triangles: values at their corners (t, 3, ...), and which triangles (t,) belong to leaves."""

    corners: Floats
    normals: Floats
    shades: Floats
    uvs: Floats
    is_leaf: NDArray[np.bool_]

    @property
    def texture_masks(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which triangles (t,) have the bark's texture, and which the leaf's."""
        return ~self.is_leaf, self.is_leaf


@dataclass(frozen=True, eq=False)
class _View:
    """An orthographic view: pixel = origin_px + (x, -y) px_per_m of the turned point.

    ``pitch``, rad, is the angle at which the ground is seen.
    """

    turn: Floats
    pitch: float
    px_per_m: float
    origin_px: tuple[float, float]
    height: int
    width: int

    def project(self, points: Floats) -> tuple[Floats, Floats]:
        """Project world points (..., 3), metres, to pixels (..., 2) and nearness to the viewer (...,), metres."""
        turned = (points.reshape(-1, 3) @ self.turn.T).reshape(points.shape)
        x = self.origin_px[0] + turned[..., 0] * self.px_per_m
        y = self.origin_px[1] - turned[..., 1] * self.px_per_m
        return np.stack([x, y], axis=-1), turned[..., 2]


@dataclass(frozen=True, eq=False)
class _Sunlight:
    """The scene as the sun sees it.

    Attributes
    ----------
    view
        The sun's view.
    nearness
        (h, w) nearness of the first surface to the sun, metres, blurred.
    cover
        (h, w) share of the pixel that shows a surface, blurred.
    """

    view: _View
    nearness: NDArray[np.float32]
    cover: NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class _Texture:
    """A texture in linear light: colours (h, w, 3), alpha (h, w), and the alpha below which texels are cut away."""

    colours: NDArray[np.float32]
    alpha: NDArray[np.float32]
    threshold: float = ALPHA_CUT

    def texels(self, uvs: Floats) -> Indices:
        """Flat texel indices (m,) at texture coordinates (2, m), repeated outside 0 to 1."""
        height, width = self.alpha.shape
        column = np.floor(uvs[0] * width).astype(np.int64) % width
        row = np.floor(uvs[1] * height).astype(np.int64) % height
        return np.asarray(row * width + column)


@dataclass(frozen=True, eq=False)
class _Drawing:
    """A scene in a view: the triangle that each pixel (h, w) shows, values at corners, and textures of fitting size."""

    shown: Indices
    nearness: Floats
    values: Planes
    textures: tuple[_Texture, _Texture]


def draw_preview(bark: Surface, leaf: Surface | None, camera: OrthographicCamera) -> NDArray[np.uint8]:
    """Draw a tree twice, side by side: as the photo frames it, and turned by 40 degrees from slightly above.

    The sun shines from the upper left, with soft shadows in the crown and on the ground, beside light from the sky.
    Textures with alpha are cut at `ALPHA_CUT`; vertex shades darken. Takes one core a second or two, and no GPU.

    Returns
    -------
    (h, w, 3) uint8 sRGB.
    """
    scene = _scene(bark, leaf)
    textures = (_texture(bark.texture), _texture((leaf or bark).texture))
    sun = _sunlight(scene, textures)
    light = _light(scene, sun)
    pictures = [_paint(_draw(scene, textures, view, light), scene, view, sun) for view in _views(scene, camera)]
    gap = np.full((_VIEW_HEIGHT, _GAP_PX, 3), 255, dtype=np.uint8)
    return np.hstack([pictures[0], gap, pictures[1]])


def _scene(bark: Surface, leaf: Surface | None) -> _Scene:
    """Gather the triangles of bark and leaves."""
    meshes = [bark.mesh] if leaf is None else [bark.mesh, leaf.mesh]
    shades = [np.ones(len(m.positions)) if m.shades is None else m.shades for m in meshes]
    return _Scene(
        corners=np.concatenate([m.positions[m.triangles] for m in meshes]).astype(np.float64),
        normals=np.concatenate([m.normals[m.triangles] for m in meshes]).astype(np.float64),
        shades=np.concatenate([s[m.triangles] for s, m in zip(shades, meshes, strict=True)]).astype(np.float64),
        uvs=np.concatenate([m.uvs[m.triangles] for m in meshes]).astype(np.float64),
        is_leaf=np.repeat([False, True][: len(meshes)], [len(m.triangles) for m in meshes]),
    )


def _views(scene: _Scene, camera: OrthographicCamera) -> tuple[_View, _View]:
    """Return the two views of the picture."""
    return _front(scene, camera), _three_quarter(scene)


def _front(scene: _Scene, camera: OrthographicCamera) -> _View:
    """Frame the tree as the photo does; a very wide or tall photo is cropped or extended about its root.

    A photo in which the tree would be too wide for the view is extended upward.
    """
    height = _VIEW_HEIGHT * _SUPERSAMPLING
    span_px = float(np.ptp(scene.corners[..., 0])) / camera.metres_per_pixel
    scale = min(height / camera.height, (1 - 2 * _MARGIN) * height * _MAX_ASPECT / span_px)
    width = int(np.clip(camera.width * scale, height / 2, height * _MAX_ASPECT))
    left = (camera.width * scale - width) * camera.root_px[0] / camera.width
    top = (camera.height * scale - height) * camera.root_px[1] / camera.height
    origin = (camera.root_px[0] * scale - left, camera.root_px[1] * scale - top)
    return _View(
        np.eye(3), float(_PITCH), scale / camera.metres_per_pixel, origin, height, width - width % _SUPERSAMPLING
    )


def _three_quarter(scene: _Scene) -> _View:
    """Frame the tree turned and seen from slightly above."""
    c, s = np.cos(_YAW), np.sin(_YAW)
    about = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    c, s = np.cos(_PITCH), np.sin(_PITCH)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]) @ about
    return _fitted(turn, float(_PITCH), scene, _VIEW_HEIGHT * _SUPERSAMPLING, _MARGIN)


def _fitted(turn: Floats, pitch: float, scene: _Scene, height: int, margin: float) -> _View:
    """Frame the whole scene in a view of the given height, px, no wider than allowed."""
    turned = scene.corners.reshape(-1, 3) @ turn.T
    low, high = (np.array([pick(axis) for axis in turned.T]) for pick in (np.min, np.max))
    span = np.maximum(high - low, 1e-6)
    inner = height * (1 - 2 * margin)
    px_per_m = min(inner / span[1], (height * _MAX_ASPECT) * (1 - 2 * margin) / span[0])
    width = int(np.clip(span[0] * px_per_m + 2 * margin * height, height / 2, height * _MAX_ASPECT))
    middle = (low + high) / 2
    origin = (width / 2 - middle[0] * px_per_m, height / 2 + middle[1] * px_per_m)
    return _View(turn, pitch, px_per_m, origin, height, width - width % _SUPERSAMPLING)


def _sunlight(scene: _Scene, textures: tuple[_Texture, _Texture]) -> _Sunlight:
    """Draw the scene as the sun sees it."""
    right = np.cross([0.0, 1.0, 0.0], _SUN)
    right /= np.linalg.norm(right)
    view = _fitted(np.stack([right, np.cross(_SUN, right), _SUN]), 0.0, scene, _SUN_MAP_PX, 0.05)
    drawing = _draw(scene, textures, view, np.zeros((len(scene.corners), 3, 0)))
    lit = drawing.shown >= 0
    first = np.where(lit, drawing.nearness[np.maximum(drawing.shown, 0)], 0.0).astype(np.float32)
    cover = cv2.GaussianBlur(lit.astype(np.float32), (0, 0), 1.5)
    nearness = cv2.GaussianBlur(first, (0, 0), 1.5) / np.maximum(cover, 1e-3)
    return _Sunlight(view, np.asarray(nearness, dtype=np.float32), np.asarray(cover, dtype=np.float32))


def _draw(scene: _Scene, textures: tuple[_Texture, _Texture], view: _View, light: Floats) -> _Drawing:
    """Find what each pixel of a view shows; ``light`` (t, 3, k) is interpolated along with the texture coordinates."""
    corners_px, nearness = view.project(scene.corners)
    values = planes(corners_px, np.concatenate([scene.uvs, light], axis=2))
    fitted = [
        _shrunk(texture, scene.uvs[w], corners_px[w]) for texture, w in zip(textures, scene.texture_masks, strict=True)
    ]
    coordinates = Planes(values.origin_px, values.start[:2], values.along_x[:2], values.along_y[:2])
    opaque = fitted[1].alpha.ravel() >= fitted[1].threshold

    def cut(triangle: Indices, x: Floats, y: Floats) -> NDArray[np.bool_]:
        kept = ~scene.is_leaf[triangle]
        leaf = np.flatnonzero(~kept)
        kept[leaf] = opaque[fitted[1].texels(coordinates.at(triangle[leaf], x[leaf], y[leaf]))]
        return kept

    middle = (nearness[:, 0] + nearness[:, 1] + nearness[:, 2]) / 3
    # Bark is closed, so its far side is never seen.
    middle[(_signed_area(corners_px) > 0.0) & ~scene.is_leaf] = -np.inf
    shown = visible_triangles(corners_px, middle, cut, view.height, view.width)
    return _Drawing(shown, middle, values, (fitted[0], fitted[1]))


def _texture(pixels: NDArray[np.uint8]) -> _Texture:
    """Convert a texture's pixels, sRGB, to linear light."""
    linear = ((np.arange(256) / 255.0) ** 2.2).astype(np.float32)
    alpha = pixels[:, :, 3] / np.float32(255.0) if pixels.shape[2] == 4 else np.ones(pixels.shape[:2], np.float32)
    return _Texture(linear[pixels[:, :, :3]], alpha.astype(np.float32))


def _shrunk(texture: _Texture, uvs: Floats, corners_px: Floats) -> _Texture:
    """Shrink a texture to about one texel per pixel, against aliasing, keeping the share of it that is not cut away."""
    height, width = texture.alpha.shape
    texels, pixels = (np.abs(_signed_area(c)).sum() for c in (uvs * (width, height), corners_px))
    shrink = int(2 ** np.clip(np.round(0.5 * np.log2((texels + 1e-9) / (pixels + 1e-9))), 0, 6))
    size = (max(4, width // shrink), max(4, height // shrink))
    weight = cv2.resize(texture.alpha + np.float32(1e-3), size, interpolation=cv2.INTER_AREA)
    weighted = texture.colours * (texture.alpha + np.float32(1e-3))[:, :, None]
    colours = cv2.resize(weighted, size, interpolation=cv2.INTER_AREA) / weight[:, :, None]
    # At least a tenth, so that nothing of a texture without any leaf is shown.
    threshold = max(0.1, float(np.quantile(weight, 1.0 - float((texture.alpha >= texture.threshold).mean()))))
    return _Texture(np.asarray(colours, dtype=np.float32), np.asarray(weight, dtype=np.float32), threshold)


def _signed_area(corners: Floats) -> Floats:
    """Area (t,) of triangles (t, 3, 2), positive where they turn from +x to +y."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray((first[:, 0] * second[:, 1] - second[:, 0] * first[:, 1]) / 2)


def _paint(drawing: _Drawing, scene: _Scene, view: _View, sun: _Sunlight) -> NDArray[np.uint8]:
    """Colour what a view shows, put it before sky and ground, and reduce it to the picture's size."""
    pixel = np.flatnonzero(drawing.shown >= 0)
    triangle = drawing.shown.ravel()[pixel]
    values = drawing.values.at(triangle, *pixel_centres(pixel, view.width))
    colours = np.empty((len(triangle), 3), dtype=np.float32)
    for texture, mask in zip(drawing.textures, scene.texture_masks, strict=True):
        textured = np.flatnonzero(mask[triangle])
        colours[textured] = texture.colours.reshape(-1, 3)[texture.texels(values[:2, textured])]
    direct, sky = np.clip(values[2:], 0.0, 1.0).astype(np.float32)
    layer = np.zeros((view.height * view.width, 4), dtype=np.float32)
    layer[pixel, :3] = colours * (direct[:, None] * _SUNLIGHT + sky[:, None] * _SKYLIGHT)
    layer[pixel, 3] = 1.0
    size = (view.width // _SUPERSAMPLING, view.height // _SUPERSAMPLING)
    small = cv2.resize(layer.reshape(view.height, view.width, 4), size, interpolation=cv2.INTER_AREA)
    picture = small[:, :, :3] + (1.0 - small[:, :, 3:]) * _surroundings(view, sun)
    return np.asarray(np.round(255.0 * np.clip(picture, 0.0, 1.0) ** (1 / 2.2)), dtype=np.uint8)


def _light(scene: _Scene, sun: _Sunlight) -> Floats:
    """Light (t, 3, 2) at the corners, 0 to 1: from the sun through what is in front of them, and from the sky above."""
    sun_px, nearness = sun.view.project(scene.corners)
    depth = np.maximum(_sample(sun.nearness, sun_px) - nearness, 0.0)
    height = sun.view.height / sun.view.px_per_m
    through = np.exp(-depth / (_SUN_REACH * height))
    facing = scene.normals @ _SUN
    wrap = np.where(scene.is_leaf, 0.7, 0.15)[:, None]
    direct = np.clip((facing + wrap) / (1.0 + wrap), 0.0, 1.0) * through
    sky = 0.70 + 0.30 * scene.normals[..., 1]
    return np.asarray(np.stack([direct, sky], axis=-1) * scene.shades[..., None])


def _sample(field: NDArray[np.float32], points_px: Floats) -> Floats:
    """Read a field (h, w) at points (..., 2), px, clamped to its border."""
    column = np.clip(points_px[..., 0].astype(np.int64), 0, field.shape[1] - 1)
    row = np.clip(points_px[..., 1].astype(np.int64), 0, field.shape[0] - 1)
    return field[row, column].astype(np.float64)


def _surroundings(view: _View, sun: _Sunlight) -> Floats:
    """Paint sky and ground (h, w, 3), linear light, with the tree's shadow on the ground."""
    height = view.height // _SUPERSAMPLING
    horizon = view.origin_px[1] / _SUPERSAMPLING - 0.13 * height
    row = np.arange(height) + 0.5
    above = np.clip((horizon - row) / max(horizon, 1.0), 0.0, 1.0)[:, None]
    below = np.clip((row - horizon) / max(height - horizon, 1.0), 0.0, 1.0)[:, None]
    sky = _SKY_LOW + (_SKY_TOP - _SKY_LOW) * above
    ground = _GROUND_FAR + (_GROUND_NEAR - _GROUND_FAR) * below**0.7
    is_ground = 1.0 / (1.0 + np.exp(-(row - horizon) / (0.012 * height)))[:, None]
    shadow = _ground_shadow(view, sun) * is_ground
    lit_ground = ground[:, None, :] * (1.0 - 0.62 * shadow)[:, :, None]
    return np.asarray((1 - is_ground)[:, :, None] * sky[:, None, :] + is_ground[:, :, None] * lit_ground)


def _ground_shadow(view: _View, sun: _Sunlight) -> Floats:
    """Share (h, w), 0 to 1, of the sun's light that the tree keeps from the ground."""
    column, row = np.arange(view.width // _SUPERSAMPLING) + 0.5, np.arange(view.height // _SUPERSAMPLING) + 0.5
    x, y = np.meshgrid(column * _SUPERSAMPLING, row * _SUPERSAMPLING)
    across = (x - view.origin_px[0]) / view.px_per_m
    towards = (y - view.origin_px[1]) / view.px_per_m / np.sin(view.pitch)
    # The turn's first row is the picture's right on the ground; its quarter turn points towards the viewer.
    right = view.turn[0]
    ground = np.stack(
        [across * right[0] - towards * right[2], np.zeros_like(x), across * right[2] + towards * right[0]], axis=-1
    )
    sun_px, _ = sun.view.project(ground)
    inside = (sun_px >= 0).all(axis=-1) & (sun_px[..., 0] < sun.view.width) & (sun_px[..., 1] < sun.view.height)
    shadow = np.where(inside, _sample(sun.cover, sun_px), 0.0)
    return np.asarray(cv2.GaussianBlur(shadow, (0, 0), 2.0))
