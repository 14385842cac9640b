"""Exposure and white balance of several photos of one tree, brought to one another."""

from collections.abc import Sequence

import cv2
import numpy as np

from treestroke.core.imaging.light import linear_light, srgb_light
from treestroke.core.types import Floats, Mask, Picture

NEIGHBOURS_RAD = np.deg2rad(22.0)
"""Standard deviation of the angle over which photos are neighbours: sunlight turns more slowly around a tree."""
LEAST_NEIGHBOURS = 1.2
"""Sum of the neighbours' weights below which a photo is left as it is."""
MOST_GAIN = 1.35
"""Greatest factor on a photo's light, and least over one: greater ones are no matter of exposure."""
TREND = 0.1
"""Ridge of the trend's slope: photos on one side only tell no trend."""
SAMPLES = 20_000
"""Most pixels of a photo by which its light is measured."""


def levelled(pictures: Sequence[Picture], trees: Sequence[Mask], azimuths_rad: Floats) -> list[Picture]:
    """Bring exposure and white balance of photos from all around a tree to one another.

    A photo is too bright by what its tree (h, w) is brighter than its neighbours' trend around the tree (n,), radians,
    lets expect, channel by channel: the sunny side stays brighter than the shady one. Deterministic.

    Source: gain compensation of panoramas (Brown and Lowe 2007, section 6), with a trend, since a tree's sides differ.
    """
    table = linear_light(np.arange(256.0))
    logs = np.stack([_log_light(picture, tree, table) for picture, tree in zip(pictures, trees, strict=True)])
    bound = np.log(MOST_GAIN)
    gains = np.exp(np.clip([_lacking(logs, azimuths_rad, photo) for photo in range(len(logs))], -bound, bound))
    return [_brightened(picture, gain, table) for picture, gain in zip(pictures, gains, strict=True)]


def _log_light(picture: Picture, tree: Mask, table: Floats) -> Floats:
    """Log of the mean linear light (3,) of a tree (h, w)."""
    place = np.flatnonzero(tree)
    pixels = picture.reshape(-1, 3)[place[:: len(place) // SAMPLES + 1]]
    return np.asarray(np.log(np.maximum(table[pixels].mean(axis=0), 1e-4)) if len(place) else np.zeros(3))


def _lacking(logs: Floats, azimuths_rad: Floats, photo: int) -> Floats:
    """How much log light (3,) a photo lacks against the trend of its neighbours (n, 3), by their azimuths (n,)."""
    away = (azimuths_rad - azimuths_rad[photo] + np.pi) % (2 * np.pi) - np.pi
    weight = np.exp(-0.5 * (away / NEIGHBOURS_RAD) ** 2)
    weight[photo] = 0.0
    if weight.sum() < LEAST_NEIGHBOURS:
        return np.zeros(3)
    design = np.stack([np.ones(len(away)), away / NEIGHBOURS_RAD], axis=1)
    normal = design.T @ (weight[:, None] * design) + np.diag([0.0, TREND])
    return np.asarray(np.linalg.solve(normal, design.T @ (weight[:, None] * logs))[0] - logs[photo])


def _brightened(picture: Picture, gain: Floats, table: Floats) -> Picture:
    """Multiply the linear light of a picture's channels by gains (3,)."""
    curves = np.stack([srgb_light(table * factor) for factor in gain], axis=1)
    return np.asarray(cv2.LUT(picture, curves[None]), dtype=np.uint8)
