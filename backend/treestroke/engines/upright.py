"""Which way is up, and how large the world is: from how photos are held and the ground that they show."""

import numpy as np

from treestroke.core.types import Floats, Mask

_ROLL_RAD, _SLOPE_RAD, _PITCH_RAD = np.radians(3.0), np.radians(4.0), np.radians(25.0)
"""How far a photo's right axis is from level, the ground from level, and the photos' mean up axis from up."""
_STEEPEST = 0.6
"""Mean of the sines of the photos' pitch from which on their up axes do not tell up from down."""
_SEEN_FROM_ABOVE = 0.6
"""Share of the points in one plane, faced by the photos, from which on that plane is the ground seen from above."""
_LEAST_SPREAD = 0.03
"""Second least mean square of the right axes along a direction, below which they do not tell which way is up."""
_GROUND_SHARE = 0.08
"""Least share of the points that a ground holds."""
_THICKNESS = 0.01
"""Half the thickness of a plane over the distance of the points from the photos."""
_TRIALS = 500


def up_direction(turns: Floats, centres: Floats, points: Floats) -> Floats:
    """Return the unit direction (3,) that is up, in the frame of the cameras.

    Parameters
    ----------
    turns
        (n, 3, 3) upright cameras' rotations from the world; x right, y down, z forward.
    centres
        (n, 3) where they are.
    points
        (k, 3) points that they see.

    Notes
    -----
    Photos are held level, so all right axes are square to up; with the ground, where the points show one, and, weakly,
    with the photos' own up axes: the direction of least squares, each weighted by how far it usually is off.
    """
    right, ahead = turns[:, 0], turns[:, 2]
    spread = np.linalg.eigvalsh(right.T @ right / len(right))[1]
    plane = _plane(points, centres, ahead.mean(axis=0), np.cos(np.radians(35)))
    if spread < _LEAST_SPREAD and plane is not None and plane[1] > _SEEN_FROM_ABOVE:
        return plane[0]
    level = _level(turns, None)
    ground = _plane(points, centres, -level, np.cos(np.radians(15)))
    return level if ground is None or ground[1] < _GROUND_SHARE else _level(turns, ground[0])


def _level(turns: Floats, ground: Floats | None) -> Floats:
    """Return the direction (3,) most square to the right axes and nearest to the ground's normal (3,), if there is."""
    right, raised = turns[:, 0], -turns[:, 1].mean(axis=0)
    weights = np.ones(len(right))
    for _ in range(10):
        misfit = (right * (weights / _ROLL_RAD**2)[:, None]).T @ right
        sine = float(np.linalg.norm(raised))
        steep = sine < _STEEPEST
        if not steep:
            misfit += _away_from(raised / sine) / _PITCH_RAD**2
        if ground is not None:
            misfit += _away_from(ground) / _SLOPE_RAD**2
        up = np.linalg.eigh(misfit)[1][:, 0]
        # Cauchy's weights: a photo that was not turned upright does not tip the others.
        weights = 1 / (1 + (right @ up / (2 * _ROLL_RAD)) ** 2)
    toward = turns[:, 2].mean(axis=0)
    sign = -(toward @ up) if abs(raised @ up) < _STEEPEST / 2 else raised @ up
    return np.asarray(up if sign > 0 else -up)


def _away_from(direction: Floats) -> Floats:
    """Return the quadratic form (3, 3) of the squared sine of the angle from a unit direction."""
    return np.eye(3) - np.outer(direction, direction)


def _plane(points: Floats, centres: Floats, facing: Floats, least_cosine: float) -> tuple[Floats, float] | None:
    """Return the normal, toward the cameras, of the plane with most points, and its share of them.

    Its normal is within an angle, given by its cosine, of the direction against ``facing`` (3,), and all cameras are on
    its upper side. None if there is none.
    """
    if len(points) < 3:
        return None
    against = -facing / max(float(np.linalg.norm(facing)), 1e-9)
    middle = np.median(points, axis=0)
    thickness = _THICKNESS * float(np.median(np.linalg.norm(centres - middle, axis=1)))
    rng = np.random.default_rng(0)
    sample = points[rng.choice(len(points), min(len(points), 3000), replace=False)]
    best: tuple[Floats, float] | None = None
    on_best: Mask = np.zeros(len(points), bool)
    for _ in range(_TRIALS):
        a, b, c = sample[rng.choice(len(sample), 3, replace=False)]
        normal = np.cross(b - a, c - a)
        length = float(np.linalg.norm(normal))
        if length < 1e-12:
            continue
        normal = normal / length * (1.0 if normal @ against > 0 else -1.0)
        if normal @ against < least_cosine or ((centres - a) @ normal).min() < 2 * thickness:
            continue
        share = float((np.abs((sample - a) @ normal) < thickness).mean())
        if best is None or share > best[1]:
            best, on_best = (normal, share), np.abs((points - a) @ normal) < thickness
    if best is None:
        return None
    on = points[on_best] - points[on_best].mean(axis=0)
    normal = np.linalg.eigh(on.T @ on)[1][:, 0]
    return np.asarray(normal if normal @ against > 0 else -normal), best[1]


def upright_turn(up: Floats) -> Floats:
    """Return a rotation (3, 3) that takes the unit direction ``up`` (3,) to +Y."""
    other = np.eye(3)[np.argmin(np.abs(up))]
    x = np.cross(up, other)
    x /= np.linalg.norm(x)
    return np.array([x, up, np.cross(x, up)])


def unit_scale(centres: Floats, points: Floats) -> tuple[Floats, float]:
    """Return the middle (3,) of the points and the median distance of the cameras from it."""
    middle = np.median(points, axis=0)
    return middle, float(np.median(np.linalg.norm(centres - middle, axis=1)))
