"""Looping movements of a tree in the wind: sums of whole harmonics of their length, so that they close smoothly.

How far and how fast wood swings follows its thickness; what turns is each bone about its head, so no wood is stretched.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from treestroke.core.geometry.vectors import UP, unit
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.sway.bones import rig_of
from treestroke.core.sway.stiffness import moving_branches, softness, swing, thickness
from treestroke.core.sway.wind import Clip, Rig, Wind
from treestroke.core.types import Floats, Indices

WIND = np.array([0.94, 0.0, 0.342])
"""Where the wind blows to, horizontal, unit length: to the photo's right, and a little towards the camera."""
FRONT_M_S = 6.0
"""How fast what the wind does travels through the crown."""
_LIFT = 0.35  # of the push: limbs that point with the wind, or against it, bob up and down
_TRUNK_HZ = 0.25  # of a tree of 10 m; a swing's time grows with the root of the size, as a pendulum's
_FLUTTER_HZ = 2.6
_SMALLEST_M = 1.0  # smaller trees swing no faster
_QUICK = 0.6  # power of the thickness at which the frequency falls
_THIN = 0.03  # thinner wood is no longer much faster
_TONES = (1.0, 0.45, 0.3)  # a bone's own frequency, one more swing a period (the two swell and fade), and a slow one
_ACROSS = 0.6  # of the swing along the wind
_GOLDEN = 0.6180339887498949
_KEYS = 12  # a period of the fastest tone


@dataclass(frozen=True)
class _Weather:
    """What a clip is like.

    Attributes
    ----------
    seconds
        Length of the loop.
    reach
        How far thin branches' ends swing, over the tree's height.
    flutter
        How far the middle of a fluttering spray turns aside, over the tree's height.
    lean
        Of the swing's greatest turn, how much bends with the wind while a gust holds; the rest swings.
    calm
        Of the swing, how much is left where no gust blows.
    """

    seconds: float
    reach: float
    flutter: float
    lean: float
    calm: float


WEATHERS = {
    "breeze": _Weather(seconds=8.0, reach=0.006, flutter=0.002, lean=0.0, calm=1.0),
    "gust": _Weather(seconds=7.0, reach=0.016, flutter=0.0035, lean=0.6, calm=0.25),
}


def wind_of(skeleton: Skeleton, names: Sequence[str], leaf_joints: Indices | None) -> Wind:
    """Make a tree (metres, world) move: its bones and a clip for each name, ``breeze`` or ``gust``.

    The root stands still. Thick wood turns little and slowly, thin wood far and fast; each bone in its own time.
    ``leaf_joints`` (m,) are those of `rig_of`.

    Raises
    ------
    ValueError
        A name is none of `WEATHERS`.
    """
    unknown = [name for name in names if name not in WEATHERS]
    if unknown:
        raise ValueError(f"a clip is one of {', '.join(WEATHERS)}, not {unknown[0]}")
    rig = rig_of(skeleton, leaf_joints)
    height = max(float(np.ptp(skeleton.points, axis=0).max()), 1e-6)
    return Wind(rig, tuple(_clip(rig, name, height) for name in names))


def _clip(rig: Rig, name: str, height: float) -> Clip:
    """Turn every bone but the root."""
    weather = WEATHERS[name]
    angles, swings = _angles(rig, weather, height), _swings(rig, weather, height)
    bones = tuple(np.flatnonzero(angles > 0).tolist())
    times = tuple(_times(int(swings[bone]), weather) for bone in bones)
    turns = tuple(
        _turns(rig, bone, at, int(swings[bone]), float(angles[bone]), weather)
        for bone, at in zip(bones, times, strict=True)
    )
    return Clip(name, bones, times, turns)


def _angles(rig: Rig, weather: _Weather, height: float) -> Floats:
    """Greatest turn (b,) of each bone, rad: branches' ends reach as far as the weather lets them, at the median."""
    soft, branch = softness(rig), moving_branches(rig)
    length = np.linalg.norm(rig.ends - rig.heads, axis=1)
    tips = branch & ~np.isin(np.arange(len(soft)), rig.parents[branch])
    reached = float(np.median(swing(rig, soft)[tips])) if tips.any() else 0.0
    turned = soft * weather.reach * height / max(reached, 1e-9)
    flutter = weather.flutter * height / np.maximum(length, 0.05 * height)
    flutter[0] = 0.0
    return np.where(branch, turned, flutter)


def _swings(rig: Rig, weather: _Weather, height: float) -> Indices:
    """Count each bone's swings in a loop (b,), at least one."""
    slow = np.sqrt(10.0 / max(height, _SMALLEST_M))
    wood = _TRUNK_HZ * ((thickness(rig) + _THIN) / (1.0 + _THIN)) ** -_QUICK
    leaf = _FLUTTER_HZ * (0.85 + 0.3 * _spread(np.arange(len(rig.names)), 1))
    hertz = slow * np.where(moving_branches(rig), wood, leaf)
    return np.asarray(np.maximum(np.rint(hertz * weather.seconds), 1), dtype=np.int64)


def _times(swings: int, weather: _Weather) -> Floats:
    """Give the times of the keys (k,), seconds, both ends with them."""
    return np.linspace(0.0, weather.seconds, _KEYS * (swings + 1) + 1)


def _turns(rig: Rig, bone: int, times: Floats, swings: int, angle: float, weather: _Weather) -> Floats:
    """Turn a bone, at most by ``angle``, rad: unit quaternions (k, 4), the last as the first."""
    direction = unit(rig.ends[bone] - rig.heads[bone], UP)
    push = unit(WIND + _LIFT * UP)
    along = unit(push - (push @ direction) * direction, WIND)
    # the wind reaches what stands further downwind later
    turn = times / weather.seconds - float(rig.heads[bone] @ WIND) / (FRONT_M_S * weather.seconds)
    gust = _gust(turn)
    blown = (weather.calm + (1.0 - weather.calm) * gust)[:, None]
    swung = np.cross(direction, along) * _tones(turn, swings, bone, 1)[:, None]
    swung -= along * _ACROSS * _tones(turn, swings, bone, 4)[:, None]
    leant = np.cross(direction, along) * gust[:, None]
    turned = weather.lean * leant + (1.0 - weather.lean) * blown * swung
    turned *= angle / max(float(np.linalg.norm(turned, axis=1).max()), 1e-12)
    turned[-1] = turned[0]
    return _quaternions(turned)


def _tones(turn: Floats, swings: int, bone: int, first: int) -> Floats:
    """Sum a bone's tones at parts of a loop (k,)."""
    counts = (swings, swings + 1, max(swings // 3, 1))
    phases = [_spread(np.array(bone), first + number) for number in range(len(counts))]
    parts = zip(_TONES, counts, phases, strict=True)
    total = sum(weight * np.sin(2.0 * np.pi * (count * turn + phase)) for weight, count, phase in parts)
    return np.asarray(total, dtype=np.float64)


def _gust(turn: Floats) -> Floats:
    """Strength of a gust, 0 to 1, at parts of a loop (k,): it rises, holds and takes longer to relax."""
    at = turn % 1.0
    up, down = np.clip((at - 0.08) / 0.22, 0.0, 1.0), np.clip((at - 0.48) / 0.44, 0.0, 1.0)
    return np.asarray(_smooth(up) * (1.0 - _smooth(down)))


def _smooth(share: Floats) -> Floats:
    """Go from 0 to 1 with neither jump nor kink in speed."""
    return share * share * share * (10.0 + share * (6.0 * share - 15.0))


def _spread(index: Indices, row: int) -> Floats:
    """Spread numbers evenly over 0 to 1, neighbours far apart and rows unlike: multiples of the golden ratio."""
    return np.asarray(index * _GOLDEN * row + 0.37 * row, dtype=np.float64) % 1.0


def _quaternions(turned: Floats) -> Floats:
    """Turn rotation vectors (k, 3), rad, into unit quaternions (k, 4), real part last."""
    angle = np.linalg.norm(turned, axis=1, keepdims=True)
    quaternions = np.concatenate([0.5 * turned * np.sinc(angle / (2.0 * np.pi)), np.cos(angle / 2.0)], axis=1)
    return np.asarray(quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True))
