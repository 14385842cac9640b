"""What the twigs of a captured tree bear, by several of its photos."""

from collections.abc import Sequence

import numpy as np

from treestroke.core.capture import Shot, TreeMatte
from treestroke.core.errors import StrokesError
from treestroke.core.geometry.camera import PerspectiveCamera
from treestroke.core.geometry.crown_volume import CrownVolume
from treestroke.core.imaging.outline import rings_of_mask
from treestroke.core.pipeline.crowns import CLOSED_SHARE, closed
from treestroke.core.segment.foliage import segment_foliage
from treestroke.core.segment.kind import KindOdds, kind_odds
from treestroke.core.types import FOLIAGE_KINDS, Floats, Mask

ASKED = 2
"""Photos that are asked besides the front, a second or two of processor time each."""
BARE_BY_MATTES = 0.6
"""Probability that a tree is bare whose mattes show nothing but wood, where its outline and grain say otherwise: those
of so thin a plant are of what is seen between its branches."""


def odds_by_shots(front: KindOdds, shots: Sequence[Shot], mattes: Sequence[TreeMatte], crown: CrownVolume) -> KindOdds:
    """Return the probability of each kind of foliage by the front's and by what other shots show, in equal shares.

    A photo's cues are one sample each of the same crown, so the mean of their log odds is more often right than one.
    """
    trees = [matte.wood[matte.tree] for matte in mattes if matte.tree.any()]
    if trees and all((wood == 1).all() for wood in trees):
        return _bare(front)
    found = [front]
    for index in np.unique(np.linspace(0, len(shots), ASKED + 2)[1:-1].astype(np.int64)).tolist():
        shown = _odds(shots[index], mattes[index], crown)
        found += [] if shown is None else [shown]
    logs = [np.log(np.maximum([odds[kind] for kind in FOLIAGE_KINDS], 1e-9)) for odds in found]
    odds = np.exp(np.mean(logs, axis=0))
    return dict(zip(FOLIAGE_KINDS, (odds / odds.sum()).tolist(), strict=True))


def _bare(front: KindOdds) -> KindOdds:
    """Return the front's probabilities with that of a bare tree raised to `BARE_BY_MATTES`."""
    if front["bare"] >= BARE_BY_MATTES:
        return front
    share = (1 - BARE_BY_MATTES) / (1 - front["bare"])
    return {kind: BARE_BY_MATTES if kind == "bare" else share * value for kind, value in front.items()}


def _odds(shot: Shot, matte: TreeMatte, crown: CrownVolume) -> KindOdds | None:
    """Return what one shot shows; None where it does not show a crown."""
    crown_px, trunk_px = _outline(shot.camera, matte, crown), _trunk(shot.camera, crown)
    if crown_px is None:
        return None
    try:
        return kind_odds(segment_foliage(shot.picture, crown_px).cues, crown_px, trunk_px)
    except StrokesError:
        return None


def _outline(camera: PerspectiveCamera, matte: TreeMatte, crown: CrownVolume) -> Floats | None:
    """Return the longest outline (n, 2), px, of the tree above its crown's lowest level; None without one."""
    bottom = camera.pixels_from_world(crown.axis(crown.bounds[:1, 1]))[0, 1]
    leafy: Mask = matte.tree.copy()
    leafy[int(np.clip(bottom, 0, len(leafy))) :] = False
    rings = rings_of_mask(closed(leafy, CLOSED_SHARE["leaves"])) if leafy.any() else []
    return max(rings, key=len, default=None)


def _trunk(camera: PerspectiveCamera, crown: CrownVolume) -> Floats:
    """Return the trunk as a line (2, 2), px, from the root to the middle of the crown."""
    middle = crown.axis(np.array([crown.bounds[:, 1].mean()]))
    return camera.pixels_from_world(np.concatenate([np.zeros((1, 3)), middle]))
