"""The bark texture, from the trunk's pixels in a picture."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.appearance import StemPixels
from treestroke.core.geometry.polyline import smoothed
from treestroke.core.imaging.light import linear_light, srgb_light
from treestroke.core.imaging.quilting import QuiltParams, quilt
from treestroke.core.mesh.bark_pattern import BarkForm, bark_pattern
from treestroke.core.types import Floats, Picture

TEXTURE_SIZE = (512, 256)
"""Rows, columns; the width covers a third of the trunk's circumference."""
_PX_PER_RADIAN = TEXTURE_SIZE[1] / (2.0 * np.pi / 3.0)
_SEEN_RAD = 0.87  # angle read to either side of the trunk's front; beyond, pixels are squeezed and often not bark
_MOST_ROWS = 1024  # px, eight trunk radii
_DARK = 0.01  # linear light added before logarithms, so that black noise does not become contrast
_LIGHT = (0.022, 0.55)  # least and greatest mean, linear: a silhouette is lifted, glaring sun leaves room for detail
_WARM_GREY = np.array([1.08, 0.98, 0.9])
_SMOOTH = (70.0, 45.0)  # px along and across; slower changes are lighting, not bark
_OUTLIER = 3.5  # standard deviations from the trunk's colour, from which on a pixel is leaf, grass or sky
_COLOUR_KEPT = 0.5  # of the differences in hue: much of them is the camera's noise and light through leaves
_PATTERN = 0.22  # standard deviation of log light of the procedural pattern
_MILD = 0.3  # of that, for a known form on bark that the photo shows
_STRENGTH: dict[BarkForm | None, float] = {None: 1.0, "smooth": 0.4, "furrowed": 1.35, "plated": 1.25, "peeling": 0.8}
_CONTRAST = (0.16, 0.42)  # least and greatest standard deviation of log light in the texture


@dataclass(frozen=True)
class BarkParams:
    """Reading of bark from a photo.

    Attributes
    ----------
    smallest_radius_px
        Trunk stretches thinner than this show no bark; a radius of 0 means hidden.
    hidden_colour
        sRGB colour of bark where no trunk is visible.
    form
        The form of bark; None for furrows, which are added only where the photo shows too little.
    """

    smallest_radius_px: float = 2.5
    hidden_colour: tuple[int, int, int] = (104, 93, 82)
    form: BarkForm | None = None

    def __post_init__(self) -> None:
        if not self.smallest_radius_px > 0 or not all(0 <= c <= 255 for c in self.hidden_colour):
            raise ValueError(f"bark needs a positive least radius and an 8-bit colour, got {self}")


def bark_texture(
    picture: Picture,
    stem: StemPixels,
    params: BarkParams,
    rng: np.random.Generator,
    grain: Floats | None = None,
) -> NDArray[np.uint8]:
    """Make a bark texture (512, 256, 3), uint8 sRGB, that tiles in both directions, without the photo's lighting.

    The trunk's front is unrolled, cleaned of pixels that are not bark, freed of slow changes of light (its
    mean colour stays), and quilted. The fewer pixels the trunk has, the more of a procedural pattern is added
    to its colours; where no trunk is visible, the pattern stands alone, in ``hidden_colour``. A known form
    is always added a little.

    Source: the patches are joined after Kwatra et al. 2003 (`imaging.quilting`).

    Parameters
    ----------
    picture
        (h, w, 3) sRGB, freed of what shines through.
    stem
        The trunk's visible axis and radius in it, px.
    grain
        (512, 256) the procedural pattern, as `bark_pattern` draws it; None draws one of ``params.form``.
    """
    own = bark_pattern(TEXTURE_SIZE, rng, params.form or "furrowed") if grain is None else grain
    grain = _STRENGTH.get(params.form, 1.0) * own[..., None]
    found = _unrolled(picture, stem, params)
    hidden = linear_light(np.array(params.hidden_colour, dtype=np.float64))
    if found is None:
        return _painted(_PATTERN * grain, hidden)
    strip, pixels_per_pixel = found
    clean = _bark_like(strip)
    strip, clean = _clean_run(strip, clean)
    if not clean.any():
        return _painted(_PATTERN * grain, hidden)
    if len(strip) < _PX_PER_RADIAN or clean.mean() < 0.5:
        return _painted(_PATTERN * grain, _mean_colour(strip, clean))
    detail = _flattened(strip, clean)
    quilted = quilt(*_tall_enough(detail, clean), QuiltParams(TEXTURE_SIZE), rng)
    # an enlarged strip has no detail finer than a photo pixel: the pattern adds some
    added = np.clip((pixels_per_pixel - 2.0) / 8.0, 0.0 if params.form is None else _MILD, 1.0)
    return _painted(_evened(quilted) + added * _PATTERN * grain, _mean_colour(strip, clean))


def _unrolled(picture: Picture, stem: StemPixels, params: BarkParams) -> tuple[Floats, float] | None:
    """Unroll the trunk's front to a strip (h, w, 3) of linear light, top first, and say how much it was enlarged."""
    trunk_px, radii_px = stem.points_px, stem.radii_px
    step = np.linalg.norm(np.diff(trunk_px, axis=0), axis=1)
    arc = np.concatenate([[0.0], np.cumsum(step)])
    shown = radii_px >= params.smallest_radius_px
    if arc[-1] <= 0 or not shown.any():
        return None
    radius = float(np.median(radii_px[shown]))
    rows = int(min(arc[-1] / radius * _PX_PER_RADIAN, _MOST_ROWS))
    at = np.linspace(rows * radius / _PX_PER_RADIAN, 0.0, max(rows, 1))
    here = np.stack([np.interp(at, arc, trunk_px[:, k]) for k in range(2)], axis=1)
    way = np.gradient(here, axis=0) if rows > 1 else np.array([[0.0, 1.0]])
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9)
    right = np.stack([way[:, 1], -way[:, 0]], axis=1)
    columns = round(2 * _SEEN_RAD * _PX_PER_RADIAN)
    aside = np.sin(np.linspace(-_SEEN_RAD, _SEEN_RAD, columns))
    reach = np.interp(at, arc, np.where(shown, radii_px, 0.0))
    place = here[:, None, :] + aside[None, :, None] * (reach[:, None] * right)[:, None, :]
    # photo points name pixel corners, OpenCV pixel centres
    x, y = (place - 0.5).astype(np.float32).transpose(2, 0, 1)
    strip = cv2.remap(picture, x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    kept = reach >= params.smallest_radius_px
    if not kept.any():
        return None
    return linear_light(strip[kept].astype(np.float64)), _PX_PER_RADIAN / radius


def _bark_like(strip: Floats) -> NDArray[np.bool_]:
    """Mark the pixels (h, w) of a strip (h, w, 3) that have the colours of the lower half of its middle."""
    logs = _log(strip)
    core = logs[len(logs) // 2 :, logs.shape[1] // 3 : -logs.shape[1] // 3].reshape(-1, 3)
    middle = np.median(core, axis=0)
    spread = np.maximum(1.4826 * np.median(np.abs(core - middle), axis=0), 0.12)
    chroma = _opponent(logs - middle)
    chroma_spread = np.maximum(1.4826 * np.median(np.abs(_opponent(core - middle)), axis=0), 0.05)
    like = (np.abs(logs - middle) < _OUTLIER * spread).all(axis=2)
    return np.asarray(like & (np.abs(chroma) < _OUTLIER * chroma_spread).all(axis=2))


def _opponent(logs: Floats) -> Floats:
    """Log ratios (..., 2) of red to green and of blue to green."""
    return logs[..., (0, 2)] - logs[..., (1, 1)]


def _clean_run(strip: Floats, clean: NDArray[np.bool_]) -> tuple[Floats, NDArray[np.bool_]]:
    """Select the longest run of rows that are mostly bark."""
    share = smoothed(clean.mean(axis=1), 6.0)
    bounds = np.flatnonzero(np.diff(np.concatenate([[False], share > 0.6, [False]]).astype(np.int8)))
    if bounds.size == 0:
        return strip[:0], clean[:0]
    longest = int(np.argmax(bounds[1::2] - bounds[::2]))
    run = slice(int(bounds[2 * longest]), int(bounds[2 * longest + 1]))
    return strip[run], clean[run]


def _flattened(strip: Floats, clean: NDArray[np.bool_]) -> Floats:
    """Remove slow changes of light from a strip: log light (h, w, 3) of mean 0; 0 where there is no bark."""
    logs = _log(strip)
    inner = cv2.erode(clean.astype(np.float64), np.ones((7, 7)))
    weight: Floats = np.asarray(cv2.GaussianBlur(inner, (25, 25), 3.0, borderType=cv2.BORDER_REPLICATE), np.float64)
    slow = _slow(logs * weight[..., None]) / np.maximum(_slow(weight), 1e-3)[..., None]
    detail = (logs - slow) * weight[..., None]
    # cylinder shading that the smoothing leaves at the strip's sides
    detail -= detail.sum(axis=0) / np.maximum(weight.sum(axis=0), 1.0)[:, None]
    light = detail.mean(axis=2, keepdims=True)
    return np.asarray(light + _COLOUR_KEPT * (detail - light))


def _slow(values: Floats) -> Floats:
    """Blur values (h, w) or (h, w, c) widely, at an eighth of their resolution."""
    size = (max(values.shape[1] // 8, 1), max(values.shape[0] // 8, 1))
    small = cv2.resize(values, size, interpolation=cv2.INTER_AREA)
    along, across = _SMOOTH
    small = cv2.GaussianBlur(small, (0, 0), sigmaX=across / 8, sigmaY=along / 8, borderType=cv2.BORDER_REPLICATE)
    return np.asarray(cv2.resize(small, values.shape[1::-1], interpolation=cv2.INTER_LINEAR), dtype=np.float64)


def _tall_enough(detail: Floats, clean: NDArray[np.bool_]) -> tuple[Floats, NDArray[np.bool_]]:
    """Mirror a short strip upward until it has room for different patches."""
    while len(detail) < 1.5 * QuiltParams().patch[0]:
        detail, clean = np.concatenate([detail[::-1], detail]), np.concatenate([clean[::-1], clean])
    return detail, clean


def _evened(detail: Floats) -> Floats:
    """Scale detail (h, w, 3), log light, to a contrast that bark has."""
    spread = float(detail.mean(axis=2).std())
    return detail * float(np.clip(spread, *_CONTRAST) / max(spread, 0.5 * _CONTRAST[0]))


def _mean_colour(strip: Floats, clean: NDArray[np.bool_]) -> Floats:
    """Mean linear colour (3,) of a strip's bark, 0 to 1."""
    colour = np.exp(np.mean(_log(strip[clean]), axis=0)) - _DARK
    return np.asarray(np.maximum(colour, 0.0))


def _painted(detail: Floats, colour: Floats) -> NDArray[np.uint8]:
    """Multiply a mean colour (3,), linear, by detail (h, w, 1 or 3) in log light: sRGB (h, w, 3)."""
    light = float(colour @ (0.2126, 0.7152, 0.0722))
    colour = colour * min(1.0, _LIGHT[1] / max(light, 1e-9)) + max(_LIGHT[0] - light, 0.0) * _WARM_GREY
    factor = np.exp(detail)
    return srgb_light(colour * factor / factor.mean(axis=(0, 1)))


def _log(linear: Floats) -> Floats:
    """Return the logarithm of light, bounded below."""
    return np.log(linear + _DARK)
