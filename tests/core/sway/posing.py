"""Forward kinematics and skinning as a viewer does them, apart from the code under test."""

import numpy as np
from scipy.spatial.transform import Rotation

from treestroke.core.sway.motion import Animation, Rig, Skin


def turns_at(rig: Rig, animation: Animation, seconds: float) -> np.ndarray:
    """Interpolate each bone's turn (b, 3, 3)."""
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (len(rig.names), 1))
    for bone, times, keys in zip(animation.bones, animation.times, animation.rotations, strict=True):
        turns[bone] = [np.interp(seconds, times, keys[:, k]) for k in range(4)]
    return Rotation.from_quat(turns).as_matrix()


def posed(rig: Rig, animation: Animation, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Turn all bones in the world: (b, 3, 3) and their heads (b, 3)."""
    local = turns_at(rig, animation, seconds)
    world, heads = local.copy(), rig.heads.copy()
    for bone, parent in enumerate(rig.parents.tolist()):
        if parent >= 0:
            world[bone] = world[parent] @ local[bone]
            heads[bone] = heads[parent] + world[parent] @ (rig.heads[bone] - rig.heads[parent])
    return world, heads


def moved(rig: Rig, animation: Animation, seconds: float, skin: Skin, positions: np.ndarray) -> np.ndarray:
    """Bring vertices (v, 3) where their bones take them."""
    world, heads = posed(rig, animation, seconds)
    weights = skin.weights / 255.0
    out = np.zeros(positions.shape)
    for k in range(4):
        bone = skin.bones[:, k]
        turned = np.einsum("vij,vj->vi", world[bone], positions - rig.heads[bone])
        out += weights[:, k, None] * (turned + heads[bone])
    return out


def branches(rig: Rig) -> np.ndarray:
    """Indices of the branch bones."""
    return np.array([bone for bone, name in enumerate(rig.names) if name.startswith("branch")])


def widest_turns(animation: Animation) -> dict[int, float]:
    """Greatest angle of each bone over a animation, rad."""
    angles = [2.0 * np.arctan2(np.linalg.norm(keys[:, :3], axis=1), keys[:, 3]).max() for keys in animation.rotations]
    return dict(zip(animation.bones, angles, strict=True))
