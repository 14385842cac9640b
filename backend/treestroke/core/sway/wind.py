"""Looping animation of a tree in the wind: sums of whole harmonics of the loop's length, so that it closes smoothly.

Amplitude and frequency of a bone follow the thickness of its wood. Bones only turn about their heads, so no wood is
stretched.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.sway.bones import rig_of
from treestroke.core.sway.motion import Animation, Motion, Rig
from treestroke.core.sway.stiffness import fluttering, moving_branches, softness, swing_amplitudes, thickness
from treestroke.core.types import Floats, Indices

WIND = np.array([0.94, 0.0, 0.342])
"""Direction to which the wind blows, horizontal, unit length: to the photo's right, slightly towards the camera."""
FRONT_M_S = 6.0
"""Speed at which gusts travel through the crown, metres per second."""
_LIFT = 0.35  # upward part of the push: limbs that point with the wind, or against it, bob up and down
_TRUNK_HZ = 0.25  # of a tree of 10 m; the period grows with the square root of the size, as a pendulum's
_FLUTTER_HZ = 2.6
_SMALLEST_M = 1.0  # smaller trees swing no faster
_QUICK = 0.6  # exponent of the thickness by which the frequency falls
_THIN = 0.03  # of the greatest radius: thinner wood is hardly faster
_TONES = (1.0, 0.45, 0.3)  # weights: a bone's own frequency, one more swing a loop (the two beat), and a slow one
_ACROSS = 0.6  # amplitude across the wind, over that along it
_GOLDEN = 0.6180339887498949  # golden ratio: its multiples spread evenly over 0 to 1
_KEYS = 12  # keyframes in a period of the fastest tone


@dataclass(frozen=True)
class _Weather:
    """The character of an animation.

    Attributes
    ----------
    seconds
        Length of the loop.
    reach
        Amplitude of thin branches' ends, over the tree's height.
    flutter
        Sideways amplitude of the middle of a fluttering spray, over the tree's height.
    lean
        Share of the greatest turn that bends with the wind while a gust lasts, 0 to 1; the rest swings.
    calm
        Share of the swinging that remains between gusts, 0 to 1.
    """

    seconds: float
    reach: float
    flutter: float
    lean: float
    calm: float


@dataclass(frozen=True)
class _Swing:
    """The movement of one bone: its index, its count of swings in a loop, and its greatest turn, radians."""

    bone: int
    count: int
    angle_rad: float


WEATHERS = {
    "breeze": _Weather(seconds=8.0, reach=0.006, flutter=0.002, lean=0.0, calm=1.0),
    "gust": _Weather(seconds=7.0, reach=0.016, flutter=0.0035, lean=0.6, calm=0.25),
}


def wind_of(skeleton: Skeleton, names: Sequence[str], leaf_joints: Indices | None) -> Motion:
    """Animate a tree (metres, world): its rig, and an animation for each name, ``breeze`` or ``gust``.

    The root stands still. Thick wood turns little and slowly, thin wood far and fast, each bone with its own phase.
    ``leaf_joints`` (m,) is the index of the joint that each leaf hangs at, as in `rig_of`. Why sums of harmonics:
    docs/decisions/0012.

    Raises
    ------
    ValueError
        A name is not in `WEATHERS`.
    """
    rig = rig_of(skeleton, leaf_joints)
    return Motion(rig, blown(rig, names))


def blown(rig: Rig, names: Sequence[str]) -> tuple[Animation, ...]:
    """Return an animation of a rig for each name, as `wind_of`.

    Raises
    ------
    ValueError
        A name is not in `WEATHERS`.
    """
    unknown = [name for name in names if name not in WEATHERS]
    if unknown:
        raise ValueError(f"an animation is one of {', '.join(WEATHERS)}, not {unknown[0]}")
    return tuple(_animation(rig, name, rig.extent) for name in names)


def _animation(rig: Rig, name: str, height: float) -> Animation:
    """Animate every bone that moves."""
    weather = WEATHERS[name]
    angles, counts = _angles(rig, weather, height), _swing_counts(rig, weather, height)
    bones = tuple(np.flatnonzero(angles > 0).tolist())
    swings = [_Swing(bone, int(counts[bone]), float(angles[bone])) for bone in bones]
    times = tuple(_times(swing.count, weather) for swing in swings)
    rotations = tuple(_rotations(rig, weather, swing, at) for swing, at in zip(swings, times, strict=True))
    return Animation(name, bones, times, rotations)


def _angles(rig: Rig, weather: _Weather, height: float) -> Floats:
    """Greatest turn (b,) of each bone, radians: at the median, branches' tips reach the weather's amplitude."""
    soft, branch = softness(rig), moving_branches(rig)
    length = np.linalg.norm(rig.ends - rig.heads, axis=1)
    tips = branch & ~np.isin(np.arange(len(soft)), rig.parents[branch])
    reached = float(np.median(swing_amplitudes(rig, soft)[tips])) if tips.any() else 0.0
    turns = soft * weather.reach * height / max(reached, 1e-9)
    flutter = weather.flutter * height / np.maximum(length, 0.05 * height)
    return np.where(branch, turns, np.where(fluttering(rig), flutter, 0.0))


def _swing_counts(rig: Rig, weather: _Weather, height: float) -> Indices:
    """Count of each bone's swings in a loop (b,), at least one."""
    slow = np.sqrt(10.0 / max(height, _SMALLEST_M))
    wood = _TRUNK_HZ * ((thickness(rig) + _THIN) / (1.0 + _THIN)) ** -_QUICK
    leaf = _FLUTTER_HZ * (0.85 + 0.3 * _spread(np.arange(len(rig.names)), 1))
    hertz = slow * np.where(moving_branches(rig), wood, leaf)
    return np.asarray(np.maximum(np.rint(hertz * weather.seconds), 1), dtype=np.int64)


def _times(swings: int, weather: _Weather) -> Floats:
    """Return the times (k,) of keyframes, seconds, with both ends of the loop."""
    return np.linspace(0.0, weather.seconds, _KEYS * (swings + 1) + 1)


def _rotations(rig: Rig, weather: _Weather, swing: _Swing, times: Floats) -> Floats:
    """Return the unit quaternions (k, 4) of a bone at times (k,), seconds; the last equals the first."""
    head = rig.heads[swing.bone]
    direction = unit(rig.ends[swing.bone] - head, UP)
    push = unit(WIND + _LIFT * UP)
    along = unit(push - (push @ direction) * direction, WIND)
    # gusts reach bones further downwind later
    loop = times / weather.seconds - float(head @ WIND) / (FRONT_M_S * weather.seconds)
    gust = _gust(loop)
    strength = (weather.calm + (1.0 - weather.calm) * gust)[:, None]
    swung = np.cross(direction, along) * _tones(loop, swing, 1)[:, None]
    swung -= along * _ACROSS * _tones(loop, swing, 4)[:, None]
    leant = np.cross(direction, along) * gust[:, None]
    turned = weather.lean * leant + (1.0 - weather.lean) * strength * swung
    turned *= swing.angle_rad / max(float(np.linalg.norm(turned, axis=1).max()), 1e-12)
    turned[-1] = turned[0]
    return quaternions(turned)


def _tones(loop: Floats, swing: _Swing, first: int) -> Floats:
    """Sum the tones of a bone at shares of the loop (k,); ``first`` is the row of its first phase."""
    counts = (swing.count, swing.count + 1, max(swing.count // 3, 1))
    phases = [_spread(np.array(swing.bone), first + number) for number in range(len(counts))]
    parts = zip(_TONES, counts, phases, strict=True)
    total = sum(weight * np.sin(2.0 * np.pi * (count * loop + phase)) for weight, count, phase in parts)
    return np.asarray(total, dtype=np.float64)


def _gust(loop: Floats) -> Floats:
    """Strength of a gust (k,), 0 to 1, at shares of the loop: it rises, lasts, and relaxes more slowly."""
    at = loop % 1.0
    up, down = np.clip((at - 0.08) / 0.22, 0.0, 1.0), np.clip((at - 0.48) / 0.44, 0.0, 1.0)
    return np.asarray(_smooth(up) * (1.0 - _smooth(down)))


def _smooth(share: Floats) -> Floats:
    """Interpolate from 0 to 1 with continuous speed and acceleration (Perlin 2002)."""
    return share * share * share * (10.0 + share * (6.0 * share - 15.0))


def _spread(index: Indices, row: int) -> Floats:
    """Spread numbers over 0 to 1 by multiples of the golden ratio: neighbours far apart, each row differently."""
    return np.asarray(index * _GOLDEN * row + 0.37 * row, dtype=np.float64) % 1.0


def quaternions(turned: Floats) -> Floats:
    """Convert rotation vectors (k, 3), radians, to unit quaternions (k, 4), real part last."""
    angle = np.linalg.norm(turned, axis=1, keepdims=True)
    quaternions = np.concatenate([0.5 * turned * np.sinc(angle / (2.0 * np.pi)), np.cos(angle / 2.0)], axis=1)
    return np.asarray(quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True))
