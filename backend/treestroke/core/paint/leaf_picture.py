"""Sprays of a leaf that the user gives as a picture."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.paint.broad_leaves import LeafPoses, leaf_poses, shoot_room
from treestroke.core.paint.canvas import Canvas, fits_canvas
from treestroke.core.paint.cut_outs import mean_lab, resized_premultiplied
from treestroke.core.paint.palette import Palette, lab_from_rgb, rgb_from_lab
from treestroke.core.paint.seasons import Recolour
from treestroke.core.paint.shoots import draw_shoots, heading
from treestroke.core.paint.species import Species
from treestroke.core.types import Floats, Picture

LIGHT_KEPT, HUE_KEPT = 0.35, 0.08
"""Share of the photo's differences in lightness and hue that leaves adopt; their mean colour stays the picture's."""
TINTS = 6
"""Lighter and darker copies of the picture in one spray."""
TINT_SCATTER = 3.0
"""Standard deviation of the copies' lightness, CIE Lab."""
WIDEST = 0.6
"""Greatest width of a leaf, a share of the spray's side."""
OVAL_POINTS = 12
"""Points of the oval by which leaves are kept from hiding each other."""
BREADTH_SEEN = (0.65, 1.0)
"""Least and greatest apparent breadth of a leaf, relative to its own: leaves are tilted against the picture's plane."""


@dataclass(frozen=True, eq=False)
class _Stamp:
    """A leaf ready to be pasted.

    Attributes
    ----------
    copies
        (t, h, w, 4) tinted copies: sRGB, 0 to 255, times alpha; and alpha, 0 to 1.
    foot
        Column of the stalk's lower end, px.
    """

    copies: NDArray[np.float32]
    foot: float

    @property
    def size(self) -> tuple[int, int]:
        """Height and width, px."""
        return self.copies.shape[1], self.copies.shape[2]


def picture_recolour(picture: Picture, palette: Palette) -> Recolour:
    """Recolour a photo's foliage like a leaf's picture (h, w, 4), sRGB, keeping some of the photo's light and dark."""
    mean = (palette.centres * palette.shares[:, None]).sum(axis=0)
    return Recolour(mean, mean_lab(picture)[None], np.array([LIGHT_KEPT, HUE_KEPT, HUE_KEPT]))


def draw_pictured_leaves(
    picture: Picture, species: Species, side: int, colours: Floats, rng: np.random.Generator
) -> Picture:
    """Draw a forked twig and paste a leaf's picture (h, w, 4) along it, as light as colours (m, 3), CIE Lab.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha; the transparent part has the spray's mean colour.
    """
    height, width = picture.shape[:2]
    length = min(species.length, WIDEST * height / width)
    shoots = draw_shoots(rng, species.shoots, *shoot_room(length))
    poses, canvas = leaf_poses(shoots, species.arrangement, length, rng), Canvas(side, colours, 1, rng)
    stamp = _stamp(picture, round(length * canvas.side), colours, rng)
    breadth = rng.uniform(*BREADTH_SEEN, len(poses.size))
    mirrored = rng.choice([-1.0, 1.0], len(poses.size))
    ovals = _ovals(poses, breadth * width / height)
    canvas.lines(shoots, canvas.wood, 0.01)
    for index in np.flatnonzero(fits_canvas(ovals)).tolist():
        oval = ovals[index]
        core = 0.5 * (oval + oval.mean(axis=0))
        if canvas.painted_share(canvas.cells(oval)) <= 0.6 and canvas.painted_share(canvas.cells(core)) <= 0.7:
            placement = _placement(canvas, stamp, poses, index, breadth[index] * mirrored[index])
            _paste(canvas, stamp, placement, index % TINTS)
            if canvas.is_full():
                break
    return canvas.tile()


def _stamp(picture: Picture, length: int, colours: Floats, rng: np.random.Generator) -> _Stamp:
    """Resize a picture to ``length`` rows and copy it in tints drawn from colours (m, 3), CIE Lab."""
    height, width = picture.shape[:2]
    rows, columns = max(2, length), max(2, round(width * length / height))
    shift = colours[rng.integers(len(colours), size=TINTS)] - mean_lab(picture)
    shift[:, 0] += rng.normal(0, TINT_SCATTER, TINTS)
    small = resized_premultiplied(picture, columns, rows)
    colour = np.clip(small[..., :3] / np.maximum(small[..., 3:], 1e-3), 0, 255).astype(np.uint8)
    lab = lab_from_rgb(colour)
    copies = [np.concatenate([rgb_from_lab(lab + s) * small[..., 3:], small[..., 3:]], axis=2) for s in shift]
    lowest = np.flatnonzero(small[-max(1, length // 30) :, :, 3].sum(axis=0) > 0)
    return _Stamp(np.stack(copies).astype(np.float32), float(lowest.mean()) if lowest.size else columns / 2)


def _ovals(poses: LeafPoses, breadth: Floats) -> Floats:
    """Ovals (p, OVAL_POINTS, 2) about the leaves, shares of the side, with a breadth (p,) relative to their length."""
    turn = np.linspace(0, 2 * np.pi, OVAL_POINTS, endpoint=False)
    across = 0.42 * np.sin(turn) * (poses.size * breadth)[:, None]
    ahead = (0.5 - 0.46 * np.cos(turn)) * poses.size[:, None]
    right, up = heading(poses.angle + np.pi / 2), heading(poses.angle)
    return np.asarray(poses.foot[:, None] + across[..., None] * right[:, None] + ahead[..., None] * up[:, None])


def _placement(canvas: Canvas, stamp: _Stamp, poses: LeafPoses, index: int, breadth: float) -> Floats:
    """Affine matrix (2, 3) from the stamp's pixels to the canvas's: its foot on the pose's, turned by its angle.

    ``breadth`` scales across the leaf; a negative one mirrors it.
    """
    height, _ = stamp.size
    scale, angle = float(poses.size[index]) * canvas.side / height, float(poses.angle[index])
    right, up = scale * breadth * heading(np.array(angle + np.pi / 2)), scale * heading(np.array(angle))
    turn = np.stack([right, -up], axis=1)
    foot = poses.foot[index] * canvas.side - turn @ np.array([stamp.foot, height - 1.0])
    return np.concatenate([turn, foot[:, None]], axis=1)


def _paste(canvas: Canvas, stamp: _Stamp, placement: Floats, tint: int) -> None:
    """Blend one tinted copy over the canvas, by an affine matrix (2, 3) from its pixels to the canvas's."""
    height, width = stamp.size
    corners = np.array([[0, 0, 1], [width, 0, 1], [0, height, 1], [width, height, 1]]) @ placement.T
    left, top = np.maximum(np.floor(corners.min(axis=0)).astype(int) - 1, 0).tolist()
    right, bottom = np.minimum(np.ceil(corners.max(axis=0)).astype(int) + 2, canvas.side).tolist()
    shifted = placement - np.array([[0.0, 0.0, left], [0.0, 0.0, top]])
    warped = cv2.warpAffine(stamp.copies[tint], shifted, (right - left, bottom - top), flags=cv2.INTER_LINEAR)
    window = canvas.pixels[top:bottom, left:right]
    below = window.astype(np.float32)
    colour = warped[..., :3] + (1 - warped[..., 3:]) * below[..., :3]
    alpha = 255 * warped[..., 3:] + (1 - warped[..., 3:]) * below[..., 3:]
    window[:] = np.clip(np.rint(np.concatenate([colour, alpha], axis=2)), 0, 255).astype(np.uint8)
