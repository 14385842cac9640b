"""Sprays of a leaf that is given as a picture."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from treestroke.core.paint.easel import Easel, inside
from treestroke.core.paint.leafage import LeafSeats, leaf_seats
from treestroke.core.paint.palette import Palette, lab_from_rgb, rgb_from_lab
from treestroke.core.paint.seasons import Recolour
from treestroke.core.paint.shoots import draw_shoots, heading
from treestroke.core.paint.species import Species
from treestroke.core.types import Floats, Picture

OPAQUE = 26
"""Alpha from which on a pixel of the picture is leaf."""
LIGHT_KEPT, HUE_KEPT = 0.35, 0.08
"""Share of the photo's differences in lightness and hue that the leaves take on; their colour stays the picture's."""
TINTS = 6
"""Lighter and darker copies of the picture in one spray."""
TINT_SCATTER = 3.0
"""Standard deviation of their lightness, CIE Lab."""
WIDEST = 0.6
"""Most of a spray's side that a leaf is wide."""
LONGEST = 360
"""Long side, px, to which a picture is reduced: more than its largest drawing has."""
RIM = 12
"""Points of the oval that stands for a leaf where leaves are kept apart."""
TIPPED = (0.65, 1.0)


@dataclass(frozen=True, eq=False)
class _Print:
    """A leaf ready to be pasted: copies (t, h, w, 4) of premultiplied colour, and the column of its stalk's foot."""

    copies: NDArray[np.float32]
    foot: float

    @property
    def size(self) -> tuple[int, int]:
        """Height and width, px."""
        return self.copies.shape[1], self.copies.shape[2]


def opaque_part(picture: Picture) -> Picture:
    """Crop a picture (h, w, 4), sRGB with straight alpha, to the box of what is not transparent.

    Raises
    ------
    ValueError
        It is no such picture, or all of it is transparent.
    """
    if picture.ndim != 3 or picture.shape[2] != 4 or picture.dtype != np.uint8:
        what = f"{picture.shape} {picture.dtype}"
        raise ValueError(f"a leaf's picture must be (h, w, 4) uint8, and so must a fruit's; got {what}")
    opaque = picture[..., 3] >= OPAQUE
    if not opaque.any():
        raise ValueError("a leaf's picture needs pixels that are not transparent, and so does a fruit's")
    rows, columns = np.flatnonzero(opaque.any(axis=1)), np.flatnonzero(opaque.any(axis=0))
    return picture[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def reduced(picture: Picture) -> Picture:
    """Shrink a large picture (h, w, 4), straight alpha, to LONGEST; what is transparent gives no colour."""
    scale = LONGEST / max(picture.shape[:2])
    if scale >= 1:
        return picture
    size = (max(2, round(scale * picture.shape[1])), max(2, round(scale * picture.shape[0])))
    colour = cv2.resize(
        cv2.multiply(picture[..., :3], cv2.merge([picture[..., 3]] * 3), scale=1 / 255),
        size,
        interpolation=cv2.INTER_AREA,
    )
    alpha = cv2.resize(picture[..., 3], size, interpolation=cv2.INTER_AREA)
    straight = colour.astype(np.float64) * 255 / np.maximum(alpha, 1)[..., None]
    return np.concatenate([np.clip(np.rint(straight), 0, 255).astype(np.uint8), alpha[..., None]], axis=2)


def picture_recolour(picture: Picture, palette: Palette) -> Recolour:
    """Tell how the photo's colours become those of a picture of a leaf: its own, with some of the photo's light."""
    mean = (palette.centres * palette.shares[:, None]).sum(axis=0)
    return Recolour(mean, _mean_lab(picture)[None], np.array([LIGHT_KEPT, HUE_KEPT, HUE_KEPT]))


def draw_pictured(picture: Picture, species: Species, side: int, members: Floats, rng: np.random.Generator) -> Picture:
    """Draw a forked twig and paste a leaf's picture along it; members (m, 3), CIE Lab, say how light it is.

    Returns
    -------
    (side, side, 4) uint8, sRGB with straight alpha; the clear part has the spray's mean colour.
    """
    height, width = picture.shape[:2]
    length = min(species.length, WIDEST * height / width)
    shoots = draw_shoots(rng, species.shoots, 0.78 - 0.6 * length, 0.5 - 0.6 * length)
    seats, easel = leaf_seats(shoots, species.seating, length, rng), Easel(side, members, 1, rng)
    leaf = _print(picture, round(length * easel.side), members, rng)
    tipped, mirrored = rng.uniform(*TIPPED, len(seats.size)), rng.choice([-1.0, 1.0], len(seats.size))
    rims = _rims(seats, tipped * width / height)
    easel.lines(shoots, easel.wood, 0.01)
    for index in np.flatnonzero(inside(rims)).tolist():
        rim = rims[index]
        core = 0.5 * (rim + rim.mean(axis=0))
        if easel.taken(easel.cells(rim)) <= 0.6 and easel.taken(easel.cells(core)) <= 0.7:
            _paste(easel, leaf, _placing(easel, leaf, seats, index, tipped[index] * mirrored[index]), index % TINTS)
            if easel.is_full():
                break
    return easel.tile()


def _mean_lab(picture: Picture) -> Floats:
    """Mean colour of the opaque part (3,), CIE Lab."""
    return np.asarray(lab_from_rgb(picture[picture[..., 3] >= OPAQUE][:, :3]).mean(axis=0))


def _print(picture: Picture, length: int, members: Floats, rng: np.random.Generator) -> _Print:
    """Shrink a picture to this many rows, without losing what is fine, and copy it in lighter and darker tints."""
    height, width = picture.shape[:2]
    size = (max(2, round(width * length / height)), max(2, length))
    alpha = picture[..., 3:].astype(np.float32) / 255
    shift = members[rng.integers(len(members), size=TINTS)] - _mean_lab(picture)
    shift[:, 0] += rng.normal(0, TINT_SCATTER, TINTS)
    filtering = cv2.INTER_AREA if length < height else cv2.INTER_LINEAR
    premultiplied = np.concatenate([alpha * picture[..., :3].astype(np.float32), alpha], axis=2)
    small = cv2.resize(premultiplied, size, interpolation=filtering).reshape(size[1], size[0], 4)
    colour = np.clip(small[..., :3] / np.maximum(small[..., 3:], 1e-3), 0, 255).astype(np.uint8)
    lab = lab_from_rgb(colour)
    copies = [np.concatenate([rgb_from_lab(lab + s) * small[..., 3:], small[..., 3:]], axis=2) for s in shift]
    lowest = np.flatnonzero(small[-max(1, length // 30) :, :, 3].sum(axis=0) > 0)
    return _Print(np.stack(copies).astype(np.float32), float(lowest.mean()) if lowest.size else size[0] / 2)


def _rims(seats: LeafSeats, breadth: Floats) -> Floats:
    """Ovals (p, RIM, 2) that stand for the leaves."""
    turn = np.linspace(0, 2 * np.pi, RIM, endpoint=False)
    across = 0.42 * np.sin(turn) * (seats.size * breadth)[:, None]
    ahead = (0.5 - 0.46 * np.cos(turn)) * seats.size[:, None]
    right, up = heading(seats.angle + np.pi / 2), heading(seats.angle)
    return np.asarray(seats.foot[:, None] + across[..., None] * right[:, None] + ahead[..., None] * up[:, None])


def _placing(easel: Easel, leaf: _Print, seats: LeafSeats, index: int, breadth: float) -> Floats:
    """Matrix (2, 3) from the picture's pixels to the canvas's: foot on the seat, upward along the seat's angle."""
    height, _ = leaf.size
    scale, angle = float(seats.size[index]) * easel.side / height, float(seats.angle[index])
    right, up = scale * breadth * heading(np.array(angle + np.pi / 2)), scale * heading(np.array(angle))
    turn = np.stack([right, -up], axis=1)
    foot = seats.foot[index] * easel.side - turn @ np.array([leaf.foot, height - 1.0])
    return np.concatenate([turn, foot[:, None]], axis=1)


def _paste(easel: Easel, leaf: _Print, placing: Floats, tint: int) -> None:
    """Lay one copy over the canvas."""
    height, width = leaf.size
    corners = np.array([[0, 0, 1], [width, 0, 1], [0, height, 1], [width, height, 1]]) @ placing.T
    left, top = np.maximum(np.floor(corners.min(axis=0)).astype(int) - 1, 0).tolist()
    right, bottom = np.minimum(np.ceil(corners.max(axis=0)).astype(int) + 2, easel.side).tolist()
    shifted = placing - np.array([[0.0, 0.0, left], [0.0, 0.0, top]])
    laid = cv2.warpAffine(leaf.copies[tint], shifted, (right - left, bottom - top), flags=cv2.INTER_LINEAR)
    window = easel.canvas[top:bottom, left:right]
    under = window.astype(np.float32)
    colour = laid[..., :3] + (1 - laid[..., 3:]) * under[..., :3]
    alpha = 255 * laid[..., 3:] + (1 - laid[..., 3:]) * under[..., 3:]
    window[:] = np.clip(np.rint(np.concatenate([colour, alpha], axis=2)), 0, 255).astype(np.uint8)
