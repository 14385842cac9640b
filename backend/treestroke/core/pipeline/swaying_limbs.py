"""Limbs that leaves hide, but whose sway shows where they are, join those that a frame shows."""

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from treestroke.core.film.hierarchy import sway_skeleton
from treestroke.core.film.tracks import Tracks
from treestroke.core.pipeline.evidence import PhotoEvidence
from treestroke.core.skeleton.skeleton import Skeleton
from treestroke.core.trace.tracing import Traced

SAME = 0.07
"""Distance over the tree's height up to which a joint of the limbs that sway is one of the traced limbs."""
FEWEST_LIMBS = 3
"""Limbs beside the trunk from which on those that a frame shows are enough: the motion of an oak and a pine was
measured better without further ones (docs/decisions/0019)."""
_THICKEST = 0.35  # radius of a limb that is not seen, over that of the trunk


def with_swaying_limbs(evidence: PhotoEvidence, tracks: Tracks) -> PhotoEvidence:
    """Return the evidence with limbs to the groups of tracks (px of the photo) that sway together.

    Where the frame shows `FEWEST_LIMBS` or more, the evidence is left as it is.
    """
    traced, working = evidence.traced, evidence.working
    if traced is None or _limb_count(traced) >= FEWEST_LIMBS:
        return evidence
    on_copy = replace(tracks, rest=(tracks.rest - working.frame.corner) * working.frame.scale)
    found = sway_skeleton(on_copy, traced.skeleton.points[0], evidence.height_px)
    return evidence if found is None else replace(evidence, traced=_joined(traced, found, evidence.height_px))


def _limb_count(traced: Traced) -> int:
    """Count what leaves the first stroke of a trace."""
    parents = traced.skeleton.parents
    leaves_trunk = (traced.stroke != 0) & (traced.stroke[np.maximum(parents, 0)] == 0) & (parents >= 0)
    return int(leaves_trunk.sum())


def _joined(traced: Traced, found: Skeleton, height_px: float) -> Traced:
    """Hang the joints that are far from all traced wood onto the nearest joint that is not."""
    seen = traced.skeleton
    away, nearest = cKDTree(seen.points).query(found.points)
    joint_of = np.where(away <= SAME * height_px, nearest, -1)
    joint_of[0] = 0
    points, radii, parents = [seen.points], [seen.radii], [seen.parents]
    count = len(seen)
    for joint in range(1, len(found)):
        if joint_of[joint] >= 0:
            continue
        parent = int(joint_of[found.parents[joint]])
        points.append(found.points[joint : joint + 1])
        thickness = min(_THICKEST * float(found.radii[joint]) * float(seen.radii[0]), 0.8 * _radius(radii, parent))
        radii.append(np.array([thickness]))
        parents.append(np.array([parent]))
        joint_of[joint] = count
        count += 1
    more = count - len(seen)
    return replace(
        traced,
        skeleton=Skeleton(np.concatenate(points), np.concatenate(radii), np.concatenate(parents)),
        stroke=np.append(traced.stroke, np.full(more, -1)),
        measured=np.append(traced.measured, np.zeros(more, dtype=bool)),
    )


def _radius(radii: list[np.ndarray], joint: int) -> float:
    """Return the radius of a joint of those that were joined so far."""
    return float(np.concatenate(radii)[joint])
